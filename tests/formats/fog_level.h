// SPDX-License-Identifier: MIT
// Levels of fog made from dense samples as section 6 of formats/SPEC.md has them, written from it alone.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "kelp/formats/raw_pack.h"

namespace kelp::test {

// The code of a sample of a level.
using FogField = std::function<std::uint8_t(const glm::ivec3& sample)>;

// Cells of empty bricks promise nothing, which is never false. Without `heat` the level has none.
inline RawLevel fogLevel(const glm::ivec3& size, float extinction, const FogField& density,
                         const FogField& heat = {}) {
  const glm::ivec3 grid = (glm::max(size - 1, glm::ivec3(1)) + 7) / 8;
  struct Brick {
    std::size_t cell = 0;
    std::vector<std::uint8_t> density, heat;
  };
  std::map<std::uint64_t, Brick> stored;  // by Morton code
  RawLevel level;
  level.extinction = extinction;
  for (int z = 0; z < grid.z; ++z) {
    for (int y = 0; y < grid.y; ++y) {
      for (int x = 0; x < grid.x; ++x) {
        Brick brick;
        brick.cell = level.cells.size();
        level.cells.push_back(0);
        bool clear = true;
        for (int i = 0; i < 729; ++i) {
          const glm::ivec3 sample = 8 * glm::ivec3(x, y, z) + glm::ivec3(i % 9, i / 9 % 9, i / 81);
          const bool inside = sample.x < size.x && sample.y < size.y && sample.z < size.z;
          brick.density.push_back(inside ? density(sample) : std::uint8_t{0});
          brick.heat.push_back(inside && heat ? heat(sample) : std::uint8_t{0});
          clear = clear && brick.density.back() == 0 && brick.heat.back() == 0;
        }
        if (clear) continue;
        std::uint64_t morton = 0;
        for (int bit = 0; bit < 13; ++bit)
          morton |= static_cast<std::uint64_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2)
                    << (3 * bit);
        stored[morton] = std::move(brick);
      }
    }
  }
  std::uint32_t slot = 0;
  for (const auto& [morton, brick] : stored) {
    level.cells[brick.cell] = 0x80000000u | slot++;
    level.density.insert(level.density.end(), brick.density.begin(), brick.density.end());
    if (heat) level.heat.insert(level.heat.end(), brick.heat.begin(), brick.heat.end());
  }
  return level;
}

}  // namespace kelp::test
