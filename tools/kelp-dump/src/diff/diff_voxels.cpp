// SPDX-License-Identifier: MIT
// Compares two levels of solid parts brick by brick. Both files have bricks in Morton order, so neither level
// is held in memory.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "kelp/common/dense_index.h"
#include "kelp/formats/level.h"

#include "diff/diff.h"
#include "pack/brick_reader.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// In degrees. 0 if both codes decode to the same normal.
double angleBetween(std::uint32_t a, std::uint32_t b) {
  const glm::dvec3 u(decodeNormal(a)), v(decodeNormal(b));
  return u == v ? 0.0 : glm::degrees(std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)));
}

class LevelDiff {
 public:
  LevelDiff(const PaletteDistances& palette, const Tolerance& tolerance)
      : palette_(palette), tolerance_(tolerance) {}

  Places only_a, only_b, bare_a, bare_b, color, normal;
  glm::ivec3 first_solid{0}, first_surface{0};

  // a, b: null if the level does not store the brick; it is then wholly inside or empty.
  void compare(const glm::ivec3& low, const BrickReader* a, const BrickReader* b, bool inside_a,
               bool inside_b) {
    if (a && b && identical_ && std::ranges::equal(a->codes(), b->codes()) &&
        std::ranges::equal(a->attributes(), b->attributes()))
      return;
    const std::span<const std::uint8_t> codes_a = a ? a->codes() : uniform(inside_a),
                                        codes_b = b ? b->codes() : uniform(inside_b);
    const std::span<const std::uint32_t> attributes_a =
                                             a ? a->attributes() : std::span<const std::uint32_t>(),
                                         attributes_b =
                                             b ? b->attributes() : std::span<const std::uint32_t>();
    std::size_t next_a = 0, next_b = 0;
    for (int i = 0; i < kBrickVoxels; ++i) {
      const std::uint8_t code_a = codes_a[static_cast<std::size_t>(i)],
                         code_b = codes_b[static_cast<std::size_t>(i)];
      const bool surface_a = isSurfaceCode(code_a), surface_b = isSurfaceCode(code_b);
      const std::uint32_t attribute_a = surface_a ? attributes_a[next_a++] : 0,
                          attribute_b = surface_b ? attributes_b[next_b++] : 0;
      const glm::ivec3 at = low + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
      if (isSolidCode(code_a) != isSolidCode(code_b)) {
        if (only_a.count + only_b.count == 0) first_solid = at;
        (isSolidCode(code_a) ? only_a : only_b).add(at);
      } else if (surface_a != surface_b) {
        if (bare_a.count + bare_b.count == 0) first_surface = at;
        (surface_a ? bare_b : bare_a).add(at);
      } else if (surface_a) {
        compareAttributes(at, attribute_a, attribute_b);
      }
    }
  }
  // Compares the bricks that neither level stores, where one is wholly inside and the other empty.
  void compareInside(const LevelGrid& a, const LevelGrid& b) {
    for (std::size_t c = 0; c < a.cells.size(); ++c) {
      const bool inside_a = a.isInside(a.cells[c]), inside_b = b.isInside(b.cells[c]);
      const bool stored_a = (a.cells[c] & kCellSolid) && !inside_a,
                 stored_b = (b.cells[c] & kCellSolid) && !inside_b;
      if (inside_a != inside_b && !stored_a && !stored_b)
        compare(voxelAt(a.grid, c) * kBrickSide, nullptr, nullptr, inside_a, inside_b);
    }
  }
  // True if equal palette indices mean equal colors.
  void setIdentical(bool identical) { identical_ = identical; }

 private:
  static std::span<const std::uint8_t> uniform(bool inside) {
    static constexpr std::array<std::uint8_t, kBrickVoxels> kEmptyBrick{};
    static constexpr auto kInsideBrick = [] {
      std::array<std::uint8_t, kBrickVoxels> codes{};
      codes.fill(kInnerCode);
      return codes;
    }();
    return inside ? kInsideBrick : kEmptyBrick;
  }

  void compareAttributes(const glm::ivec3& at, std::uint32_t a, std::uint32_t b) {
    if (const float apart = palette_.apart[attributePalette(a)][attributePalette(b)]; apart > 0)
      color.add(at, static_cast<double>(apart));
    if (attributeNormal(a) == attributeNormal(b)) return;
    if (const double degrees = angleBetween(attributeNormal(a), attributeNormal(b));
        !tolerance_.allows(degrees, 180))
      normal.add(at, degrees);
  }

  const PaletteDistances& palette_;
  const Tolerance& tolerance_;
  bool identical_ = true;
};

std::string atText(const glm::ivec3& at) { return fmt::format("first at ({}, {}, {})", at.x, at.y, at.z); }

}  // namespace

void diffVoxels(PackFile& file_a, PackFile& file_b, int part_a, int part_b, int level,
                const PaletteDistances& palette, const Tolerance& tolerance, std::vector<Difference>& out) {
  BrickReader a(file_a, part_a, level), b(file_b, part_b, level);
  LevelDiff found(palette, tolerance);
  bool identical = true;
  for (std::size_t i = 0; i < std::min(file_a.pack().palette().size(), file_b.pack().palette().size()); ++i)
    identical = identical && palette.apart[i][i] == 0;
  found.setIdentical(identical);
  forEachBrick(a, b, [&](const glm::ivec3& low, const BrickReader* its_a, const BrickReader* its_b) {
    const std::size_t cell = denseIndex(a.grid().grid, low / kBrickSide);
    found.compare(low, its_a, its_b, a.grid().isInside(a.grid().cells[cell]),
                  b.grid().isInside(b.grid().cells[cell]));
  });
  found.compareInside(a.grid(), b.grid());
  const bool agree = found.only_a.count + found.only_b.count == 0;

  const std::string name(file_a.pack().parts()[static_cast<std::size_t>(part_a)].name);
  const auto add = [&](const char* kind, std::uint64_t count, const glm::ivec3& first,
                       const std::string& text) -> Difference& {
    Difference difference{kind, fmt::format("level {}: {}, {}", level, text, atText(first))};
    difference.name = name;
    difference.level = level;
    difference.count = count;
    difference.first = first;
    return out.emplace_back(difference);
  };
  if (!agree) {
    Difference& d = add("occupancy", found.only_a.count + found.only_b.count, found.first_solid,
                        fmt::format("{} solid in A alone, {} in B alone", plural(found.only_a.count, "voxel"),
                                    countText(found.only_b.count)));
    d.only_a = found.only_a.count;
    d.only_b = found.only_b.count;
  }
  if (const std::uint64_t count = found.bare_a.count + found.bare_b.count; count > 0) {
    Difference& d =
        add("surface", count, found.first_surface,
            fmt::format("{} with color and normal in A alone, {} in B alone",
                        plural(found.bare_b.count, "solid voxel"), countText(found.bare_a.count)));
    d.only_a = found.bare_b.count;
    d.only_b = found.bare_a.count;
  }
  if (found.color.count > 0)
    add("colour", found.color.count, found.color.first,
        fmt::format("{} of another color (by up to {:.2g})", plural(found.color.count, "voxel"),
                    found.color.largest))
        .largest = found.color.largest;
  if (found.normal.count > 0)
    add("normal", found.normal.count, found.normal.first,
        fmt::format("{} with another normal (by up to {:.3g} degrees)", plural(found.normal.count, "voxel"),
                    found.normal.largest))
        .largest = found.normal.largest;
}

}  // namespace kelp::dump
