// SPDX-License-Identifier: MIT
// Format: https://www.patrickmin.com/binvox/binvox.html. Lines of text, then runs of a value and a count. A
// value is 0, or 1 for solid (version 2: 1 to 255).
#include <algorithm>
#include <cmath>

#include "kelp/common/dense_index.h"
#include "kelp/common/error.h"
#include "kelp/import/core/files_used.h"
#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/outer_rig.h"
#include "kelp/import/core/source_model.h"
#include "kelp/import/core/text_reader.h"
#include "kelp/import/voxels/import_voxels.h"
#include "kelp/import/voxels/indexed_voxels.h"

namespace kelp::bake {
namespace {

struct Binvox {
  glm::ivec3 size{0};       // x, y, z
  glm::dvec3 translate{0};  // where the first voxel's corner is
  double scale = 1;         // the length of the longest side
  std::span<const std::uint8_t> runs;
};

[[noreturn]] void damaged(const InputFiles& files, const std::string& place, const std::string& what) {
  refuse(Exit::kInvalid, files.input(), place, what + "; write the file again");
}

Binvox readHeader(const InputFiles& files, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMostHeader = 4096;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kMostHeader));
  const char* begin = text.data();
  if (!text.starts_with("#binvox"))
    refuse(Exit::kInvalid, files.input(), "",
           bytes.empty()
               ? "is empty; write the file again"
               : "does not look like binvox (its first line is not #binvox); check the file's type");
  Binvox out;
  for (int number = 1;; ++number) {
    const std::size_t end = text.find('\n');
    const std::string place = "line " + std::to_string(number);
    if (end == text.npos) damaged(files, place, "does not end in a header that closes with a line 'data'");
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::string_view word = nextWord(line);
    const auto numbers = [&](auto parse, int count) {
      glm::dvec3 values(0);
      for (int i = 0; i < count; ++i) {
        const auto value = parse(nextWord(line));
        if (!value || !std::isfinite(static_cast<double>(*value)))
          damaged(files, place, "'" + oneLine(word, 20) + "' has no " + std::to_string(count) + " numbers");
        values[i] = static_cast<double>(*value);
      }
      return values;
    };
    if (word == "dim") {
      const glm::dvec3 dim = numbers(parseInteger, 3);  // depth, height, width: x, z, y
      if (!(std::min({dim.x, dim.y, dim.z}) >= 1 && std::max({dim.x, dim.y, dim.z}) <= 65536))
        damaged(files, place, "the sizes are not between 1 and 65536");
      out.size = glm::ivec3(dim.x, dim.z, dim.y);
    } else if (word == "translate") {
      out.translate = numbers(parseFloat, 3);
    } else if (word == "scale") {
      out.scale = numbers(parseFloat, 1).x;
      if (!(out.scale > 0)) damaged(files, place, "the scale is not above 0");
    } else if (word == "data") {
      break;
    }
  }
  if (out.size.x == 0) damaged(files, "header", "has no line 'dim'");
  out.runs = bytes.subspan(static_cast<std::size_t>(text.data() - begin));
  return out;
}

// Calls with the place and length of each solid run along y. The order is y fastest, then z, then x.
template <class Visit>
void visitRuns(const InputFiles& files, const Binvox& box, const Visit& visit) {
  const auto height = static_cast<std::uint64_t>(box.size.y), depth = static_cast<std::uint64_t>(box.size.z);
  const std::uint64_t voxels = height * depth * static_cast<std::uint64_t>(box.size.x);
  std::uint64_t at = 0;
  for (std::size_t i = 0; i + 1 < box.runs.size() && at < voxels; i += 2) {
    const std::uint64_t end = at + box.runs[i + 1];
    if (end > voxels) damaged(files, "run " + std::to_string(i / 2), "goes beyond the volume");
    while (at < end) {
      const std::uint64_t until = std::min(end, (at / height + 1) * height);
      if (box.runs[i] != 0)
        visit(glm::ivec3(at / (height * depth), at % height, at / height % depth),
              static_cast<int>(until - at));
      at = until;
    }
  }
  if (at < voxels)
    damaged(files, "",
            "ends after " + std::to_string(at) + " of its " + std::to_string(voxels) +
                " voxels; it is truncated");
}

}  // namespace

SourceModel importBinvox(const std::filesystem::path& path, const ImportSettings& settings, FilesUsed* used) {
  const InputFiles files(path, used);
  if (settings.resolution_given)
    refuse(Exit::kUsage, path, "--resolution " + std::to_string(settings.resolution),
           "voxels of binvox files are kept as they are; leave the option out (--voxel-size says how large a "
           "voxel is)");
  SourceModel out;
  out.format = "binvox";
  out.materials.push_back({});
  out.outer = findOuterRig(files, settings);
  const std::vector<std::uint8_t> bytes = files.readInput();
  const Binvox box = readHeader(files, bytes);
  SourcePart& part = out.parts.emplace_back();
  part.name = stemOf(files);
  giveRig(part, out.outer, settings);

  const VoxelTurn to_rig = turnOf(part.rig.axis.value_or(Axis::kPlusY));
  VoxelBox bounds;
  visitRuns(files, box, [&](const glm::ivec3& first, int length) {
    bounds.add(turned(to_rig, VoxelPoint(first)));
    bounds.add(turned(to_rig, VoxelPoint(first) + VoxelPoint(0, length - 1, 0)));
  });
  if (bounds.empty())
    refuse(Exit::kUnsupported, path, "",
           "has no solid voxel; there is nothing to bake: write a volume that has some");
  VolumeMemory memory(files, settings);
  memory.add(part, bounds.size());
  const double own = box.scale / std::max({box.size.x, box.size.y, box.size.z}),
               edge = settings.voxel_size.value_or(own);
  IndexedVoxels voxels = emptyVoxels(bounds, to_rig, edge, box.translate * (edge / own));
  visitRuns(files, box, [&](const glm::ivec3& first, int length) {
    for (int y = 0; y < length; ++y) {
      const glm::ivec3 at(turned(to_rig, VoxelPoint(first.x, first.y + y, first.z)) - bounds.low);
      voxels.index[denseIndex(voxels.size, at)] = 1;
    }
  });
  VoxelPaint paint;
  paint.normals = VoxelNormals::kSmooth;
  paint.material[1] = kUnpainted;
  part.grid = paintVoxels(std::move(voxels), paint, memory, settings.threads);
  return out;
}

}  // namespace kelp::bake
