// SPDX-License-Identifier: MIT
// Layers of voxels as pictures: one for each y, x to the right, z down. Solid voxels have their colours,
// empty ones are transparent. Fog's codes are grey.
#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/png.h"

namespace kelp::dump {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeat = "_heat";

fs::path pictureName(const fs::path& stem, const char* kind, int y) {
  return fs::path(stem) += fmt::format("{}_y{:04}.png", kind, y);
}

void writeSolid(const ExtractRequest& request, const LevelVoxels& level, const fs::path& stem) {
  const std::span<const Material> palette = request.file.pack().palette();
  std::vector<Rgba> colors;
  for (const Material& material : palette) colors.push_back(displayColor(material));
  const glm::ivec3 size = level.size();
  std::vector<std::int16_t> row(static_cast<std::size_t>(size.x));
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < size.y; ++y) {
    pixels.clear();
    for (int z = 0; z < size.z; ++z) {
      level.paletteRow(y, z, 0, row);
      for (const std::int16_t entry : row) {
        const Rgba color = entry == LevelVoxels::kEmpty
                               ? Rgba{}
                               : colors[std::min(static_cast<std::size_t>(entry), colors.size() - 1)];
        pixels.insert(pixels.end(), {color.r, color.g, color.b, color.a});
      }
    }
    writePng(OutputFile(pictureName(stem, "", y)), {size.x, size.z}, 4, pixels);
  }
}

void writeFog(const LevelVoxels& level, const fs::path& stem) {
  const glm::ivec3 size = level.size();
  std::vector<std::uint8_t> density(denseCount({size.x, 1, size.z})), heat(level.hot() ? density.size() : 0);
  for (int y = 0; y < size.y; ++y) {
    level.fogLayer(y, density, heat);
    writePng(OutputFile(pictureName(stem, "", y)), {size.x, size.z}, 1, density);
    if (level.hot()) writePng(OutputFile(pictureName(stem, kHeat, y)), {size.x, size.z}, 1, heat);
  }
}

}  // namespace

void extractSlices(const ExtractRequest& request) {
  const fs::path folder = makeFolder(request.output, "pictures");
  std::set<std::string> taken;
  for (const std::uint32_t part : request.parts) {
    const LevelVoxels level = request.read(part);
    const fs::path stem =
        folder / partFileName(request.part(part).name, part, level.hot() ? kHeat : nullptr, taken);
    if (level.fog())
      writeFog(level, stem);
    else
      writeSolid(request, level, stem);
  }
}

constinit const Writer kSlicesWriter{.write = extractSlices};

}  // namespace kelp::dump
