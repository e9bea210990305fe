// SPDX-License-Identifier: MIT
// Layers of voxels as pictures: one for each y, x to the right and z down. Solid voxels in their colours, empty ones transparent; fog's codes as grey.
#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "extract.h"
#include "output_file.h"
#include "png_file.h"

namespace kelp::dump {
namespace {

constexpr const char* kHeat = "_heat";

// A part's name as a file's: nothing that a shell or a file system would mind, and no two alike; nor with kHeat, if it is hot.
std::string fileName(std::string_view name, std::uint32_t index, bool hot, std::set<std::string>& taken) {
  std::string safe;
  for (const char c : name.substr(0, 100)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') || byte == '-' || byte == '_' || (byte == '.' && !safe.empty());
    safe += plain ? c : '_';
  }
  if (safe.empty()) safe = "part";
  while (taken.contains(safe) || (hot && taken.contains(safe + kHeat))) safe += fmt::format("_{}", index);  // also where another part is called so
  taken.insert(safe);
  if (hot) taken.insert(safe + kHeat);
  return safe;
}

void writePicture(const std::filesystem::path& path, const glm::ivec2& size, int channels, std::span<const std::uint8_t> pixels) {
  OutputFile out(path.string());
  out.write(encodePng(size, channels, pixels));
  out.commit();
}

void writeSolid(const ExtractRequest& request, const LevelVoxels& level, const std::filesystem::path& stem) {
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
        const Rgba color = entry == LevelVoxels::kEmpty ? Rgba{} : colors[std::min(static_cast<std::size_t>(entry), colors.size() - 1)];
        pixels.insert(pixels.end(), {color.r, color.g, color.b, color.a});
      }
    }
    writePicture(fmt::format("{}_y{:04}.png", stem.string(), y), {size.x, size.z}, 4, pixels);
  }
}

void writeFog(const LevelVoxels& level, const std::filesystem::path& stem) {
  const glm::ivec3 size = level.size();
  std::vector<std::uint8_t> density(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.z)), heat(level.hot() ? density.size() : 0);
  for (int y = 0; y < size.y; ++y) {
    level.fogLayer(y, density, heat);
    writePicture(fmt::format("{}_y{:04}.png", stem.string(), y), {size.x, size.z}, 1, density);
    if (level.hot()) writePicture(fmt::format("{}{}_y{:04}.png", stem.string(), kHeat, y), {size.x, size.z}, 1, heat);
  }
}

}  // namespace

void extractSlices(const ExtractRequest& request) {
  const std::filesystem::path folder = request.output;
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored))
    throw DumpError(kIo, fmt::format("{}: is no folder and can not be made one{}; name a folder for the pictures", request.output, problem ? ": " + problem.message() : ""));
  std::set<std::string> taken;
  for (const std::uint32_t part : request.parts) {
    const LevelVoxels level = request.read(part);
    const std::filesystem::path stem = folder / fileName(request.part(part).name, part, level.hot(), taken);
    if (level.fog()) writeFog(level, stem);
    else writeSolid(request, level, stem);
  }
}

constinit const Writer kSlicesWriter{.name = "slices", .needs = "libpng", .write = extractSlices};

}  // namespace kelp::dump
