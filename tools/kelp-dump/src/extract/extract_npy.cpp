// SPDX-License-Identifier: MIT
// Dense arrays for NumPy: occupancy, signed distance and its gradient. The format: "numpy.lib.format" 1.0 of
// NumPy's reference.
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/output_file.h"
#include "pack/level_distances.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

// An array of `type` with the axes z, y, x, and one of `components` if there are several, written slice by
// slice.
class NpyFile {
 public:
  NpyFile(const fs::path& path, const char* type, const glm::ivec3& size, int components) : file_(path) {
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}, {}{}), }}", type, size.z,
                    size.y, size.x, components > 1 ? fmt::format(", {}", components) : "");
    constexpr std::size_t kPreamble = 10, kUnit = 64;  // the header ends at a multiple of 64, with a newline
    header.resize((kPreamble + header.size() + 1 + kUnit - 1) / kUnit * kUnit - kPreamble, ' ');
    header.back() = '\n';
    const std::array<unsigned char, kPreamble> preamble = {0x93,
                                                           'N',
                                                           'U',
                                                           'M',
                                                           'P',
                                                           'Y',
                                                           1,
                                                           0,
                                                           static_cast<unsigned char>(header.size() & 0xff),
                                                           static_cast<unsigned char>(header.size() >> 8)};
    file_.write(std::as_bytes(std::span(preamble)));
    file_.write(std::as_bytes(std::span(header)));
  }
  template <class T>
  void write(const std::vector<T>& slice) {
    file_.write(std::as_bytes(std::span(slice)));
  }
  void finish() { file_.commit(); }

 private:
  OutputFile file_;
};

// value(voxel, out) appends the components of a voxel.
template <class T, class Value>
void writeArray(const fs::path& path, const char* type, const glm::ivec3& size, int components,
                const Value& value) {
  NpyFile file(path, type, size, components);
  std::vector<T> slice;
  glm::ivec3 v;
  for (v.z = 0; v.z < size.z; ++v.z) {
    slice.clear();
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) value(v, slice);
    file.write(slice);
  }
  file.finish();
}

fs::path fileOf(const fs::path& stem, const char* kind) {
  return fs::path(stem) += fmt::format(".{}.npy", kind);
}

}  // namespace

void extractNpy(const ExtractRequest& request) {
  const std::vector<std::uint32_t> parts = solidParts(request, "--npy");
  const fs::path folder = makeFolder(request.output, "arrays");
  if (!request.file.pack().hasDistances())
    note(request,
         "the pack has no distances, so only occupancies are written; kelp-bake without --no-distance "
         "makes them");
  std::set<std::string> taken;
  for (const std::uint32_t part : parts) {
    const fs::path stem = folder / partFileName(request.part(part).name, part, taken);
    const int levels = request.part(part).levels;
    const int level = std::min(
        request.level, std::max(levels, request.file.pack().distanceLevels(static_cast<int>(part))) - 1);
    const auto writeOccupancy = [&](const glm::ivec3& size, const auto& solid) {
      writeArray<std::uint8_t>(
          fileOf(stem, "occupancy"), "|u1", size, 1,
          [&](const glm::ivec3& v, std::vector<std::uint8_t>& out) { out.push_back(solid(v) ? 1 : 0); });
    };
    if (level < levels) {
      const LevelVoxels voxels = request.read(part);
      writeOccupancy(voxels.size(), [&](const glm::ivec3& v) { return voxels.solid(v); });
    }
    if (!request.file.pack().hasDistances()) continue;
    const LevelDistances distances(request.file, part, level);
    // Levels of distances go on beyond those of the voxels. Their signs say what is solid.
    if (level >= levels)
      writeOccupancy(distances.size(), [&](const glm::ivec3& v) { return isInside(distances.code(v)); });
    writeArray<float>(fileOf(stem, "distance"), "<f4", distances.size(), 1,
                      [&](const glm::ivec3& v, std::vector<float>& out) {
                        out.push_back(signedDistanceOf(distances.code(v)));
                      });
    writeArray<float>(fileOf(stem, "gradient"), "<f4", distances.size(), 3,
                      [&](const glm::ivec3& v, std::vector<float>& out) {
                        const glm::vec3 gradient = distances.gradient(v);
                        out.insert(out.end(), {gradient.x, gradient.y, gradient.z});
                      });
  }
}

constinit const Writer kNpyWriter{.write = extractNpy};

}  // namespace kelp::dump
