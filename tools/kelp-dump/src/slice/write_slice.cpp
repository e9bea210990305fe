// SPDX-License-Identifier: MIT
#include "slice/write_slice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include <fmt/format.h>

#include "extract/extract.h"
#include "kelp/common/console.h"
#include "kelp/common/dense_index.h"
#include "kelp/common/error.h"
#include "kelp/common/png.h"
#include "kelp/fields/fields.h"
#include "pack/level_voxels.h"
#include "text/checks.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 27;
constexpr Rgba kNothing{0, 0, 0, 0}, kSolid{205, 92, 40, 255};

// Which voxel is at a pixel of the layer, at one pixel a voxel.
class Layer {
 public:
  Layer(const glm::ivec3& size, char axis, int at) : size_(size), axis_(axis), at_(at) {}

  glm::ivec2 pixels() const {
    return axis_ == 'y'   ? glm::ivec2(size_.x, size_.z)
           : axis_ == 'z' ? glm::ivec2(size_.x, size_.y)
                          : glm::ivec2(size_.z, size_.y);
  }
  glm::ivec3 voxel(int column, int row) const {
    if (axis_ == 'y') return {column, at_, row};
    const int y = size_.y - 1 - row;
    return axis_ == 'z' ? glm::ivec3(column, y, at_) : glm::ivec3(at_, y, column);
  }
  bool alongX() const { return axis_ != 'x'; }

 private:
  glm::ivec3 size_;
  char axis_;
  int at_;
};

Rgba gray(int value) {
  const auto g = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
  return {g, g, g, 255};
}

using Pixel = std::function<Rgba(const glm::ivec3& voxel)>;

Pixel occupancyOf(const LevelVoxels& level) {
  return [&level](const glm::ivec3& v) {
    return !level.solid(v) ? gray(255) : level.attribute(v) ? gray(40) : gray(150);
  };
}

Pixel normalsOf(const LevelVoxels& level) {
  return [&level](const glm::ivec3& v) {
    const std::optional<std::uint32_t> attribute = level.attribute(v);
    if (!attribute) return level.solid(v) ? gray(128) : kNothing;
    const glm::vec3 n = decodeNormal(attributeNormal(*attribute)) * 127.5f + 127.5f;
    return Rgba{static_cast<std::uint8_t>(std::lround(n.x)), static_cast<std::uint8_t>(std::lround(n.y)),
                static_cast<std::uint8_t>(std::lround(n.z)), 255};
  };
}

// Colors are found row by row if the layer has rows along x, else voxel by voxel.
Pixel colorsOf(const LevelVoxels& level, const Pack& pack, bool rows) {
  return [&level, rows, palette = pack.palette(),
          row = std::vector<std::int16_t>(rows ? static_cast<std::size_t>(level.size().x) : 1),
          last = glm::ivec2(-1)](const glm::ivec3& v) mutable {
    const int from = rows ? 0 : v.x;
    if (last != glm::ivec2(v.y, v.z)) level.paletteRow(v.y, v.z, from, row);
    last = {v.y, v.z};
    const std::int16_t entry = row[static_cast<std::size_t>(v.x - from)];
    return entry == LevelVoxels::kEmpty ? kNothing : displayColor(palette[static_cast<std::size_t>(entry)]);
  };
}

// Exact distances between closed cubes. They are computed: a pack only holds those of bricks.
Pixel clearanceOf(const LevelVoxels& level, PackFile& file, std::uint32_t part) {
  const glm::ivec3 size = level.size();
  const std::size_t voxels = denseCount(size);
  requireMemory(12 * std::uint64_t{voxels},
                fmt::format("{}: part {}: the clearance of {} voxels", file.path(), part, sizeText(size)),
                "take a coarser --level, or a larger machine");
  fields::Occupancy occupancy{size, std::vector<std::uint8_t>(voxels)};
  level.eachSolid([&](const glm::ivec3& v) { occupancy.solid[occupancy.index(v)] = 1; });
  const int threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 64u));
  return [&level, size, squared = fields::squaredClearance(occupancy, threads)](const glm::ivec3& v) {
    if (level.solid(v)) return kSolid;
    const std::size_t at = denseIndex(size, v);
    return squared[at] == fields::kNoFeature
               ? gray(255)
               : gray(static_cast<int>(std::min(4 * std::sqrt(static_cast<double>(squared[at])), 255.0)));
  };
}

// Fog's codes in a dense array: a sample may be in up to eight bricks.
Pixel fogOf(const LevelVoxels& level, const Layer& layer, bool heat) {
  const glm::ivec3 low = glm::min(layer.voxel(0, 0), layer.voxel(layer.pixels().x - 1, layer.pixels().y - 1));
  const glm::ivec3 high =
      glm::max(layer.voxel(0, 0), layer.voxel(layer.pixels().x - 1, layer.pixels().y - 1));
  const glm::ivec3 extent = high - low + 1;
  const auto index = [low, extent](const glm::ivec3& v) { return denseIndex(extent, v - low); };
  std::vector<std::uint8_t> codes(denseCount(extent));
  level.eachSample([&](const glm::ivec3& v, std::uint8_t density_code, std::uint8_t heat_code) {
    if (glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThanEqual(v, high)))
      codes[index(v)] = heat ? heat_code : density_code;
  });
  return [codes = std::move(codes), index](const glm::ivec3& v) { return gray(codes[index(v)]); };
}

Pixel pixelOf(const std::string& what, const LevelVoxels& level, const Layer& layer, PackFile& file,
              std::uint32_t part) {
  const bool for_fog = what == "density" || what == "heat",
             for_solids = what == "occupancy" || what == "clearance" || what == "normals" || what == "colour";
  if (!for_fog && !for_solids)
    throw ToolError(
        Exit::kUsage,
        fmt::format("--what {}: expected occupancy, clearance, normals or colour; of fog, density or heat",
                    nameText(what, 40)));
  const std::string of =
      fmt::format("{}: part {} '{}'", file.path(), part, nameText(file.pack().parts()[part].name, 40));
  if (for_fog && !level.fog())
    throw ToolError(
        Exit::kUsage,
        fmt::format("{} is not fog: it has no {}; choose occupancy, clearance, normals or colour", of, what));
  if (for_solids && level.fog())
    throw ToolError(Exit::kUsage, fmt::format("{} is fog: it has no {}; choose density{}", of, what,
                                              level.hot() ? " or heat" : ""));
  if (what == "heat" && !level.hot()) throw ToolError(Exit::kUsage, of + " has no heat; choose density");
  if (for_fog) return fogOf(level, layer, what == "heat");
  if (what == "clearance") return clearanceOf(level, file, part);
  return what == "occupancy" ? occupancyOf(level)
         : what == "normals" ? normalsOf(level)
                             : colorsOf(level, file.pack(), layer.alongX());
}

// RGBA, each voxel `scale` pixels wide and high.
std::vector<std::uint8_t> imageOf(const Layer& layer, const Pixel& pixel, int scale) {
  const glm::ivec2 voxels = layer.pixels();
  const std::size_t width = 4 * static_cast<std::size_t>(voxels.x) * static_cast<std::size_t>(scale);
  std::vector<std::uint8_t> image;
  image.reserve(width * static_cast<std::size_t>(voxels.y) * static_cast<std::size_t>(scale));
  for (int row = 0; row < voxels.y; ++row) {
    const auto begin = static_cast<std::ptrdiff_t>(image.size());
    for (int column = 0; column < voxels.x; ++column) {
      const Rgba color = pixel(layer.voxel(column, row));
      for (int i = 0; i < scale; ++i) image.insert(image.end(), {color.r, color.g, color.b, color.a});
    }
    for (int i = 1; i < scale; ++i)
      image.insert(image.end(), image.begin() + begin,
                   image.begin() + begin + static_cast<std::ptrdiff_t>(width));
  }
  return image;
}

}  // namespace

void checkSlices() {}

void writeSlice(PackFile& file, std::uint32_t part, const SliceOptions& options, const std::string& output) {
  const glm::ivec3 size = levelSize(file.pack().parts()[part].size, options.level);
  const int along = size[options.axis - 'x'], at = options.at.value_or(along / 2);
  if (at < 0 || at >= along)
    throw ToolError(Exit::kUsage,
                    fmt::format("{}: --at {}: there are layers 0 to {} across {}; choose one of them",
                                file.path(), at, along - 1, options.axis));
  const Layer layer(size, options.axis, at);
  const glm::ivec2 pixels = layer.pixels() * options.scale;
  if (static_cast<std::int64_t>(pixels.x) * pixels.y > kMostPixels)
    throw ToolError(Exit::kUsage,
                    fmt::format("--scale {}: makes {} x {} pixels, too many for a picture; give a "
                                "smaller --scale",
                                options.scale, pixels.x, pixels.y));
  const LevelVoxels level(file, part, options.level);
  const Pixel pixel = pixelOf(options.what.empty() ? level.fog() ? "density" : "occupancy" : options.what,
                              level, layer, file, part);
  writePng(OutputFile::orStandardOutput(console::pathOf(output)), pixels, 4,
           imageOf(layer, pixel, options.scale));
}

}  // namespace kelp::dump
