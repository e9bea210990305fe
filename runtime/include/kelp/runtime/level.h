// SPDX-License-Identifier: MIT
// The words of a level in memory, for renderers and tools. A game needs none of this.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/distance.h"
#include "kelp/formats/page.h"

namespace kelp::runtime {

// One level of one part, of voxels (or fog) or of distances. Immutable; valid as long as the asset.
struct Level {
  glm::ivec3 size{0};                    // voxels of this level
  glm::ivec3 grid{0};                    // bricks
  std::span<const std::uint32_t> cells;  // one a brick, x fastest, then y, then z (kelp/formats/page.h)
  std::span<const PageInfo> pages;       // they hold the stored bricks
  // Of distances (kelp/formats/distance.h):
  DistanceBand band;
  std::span<const std::uint32_t> first_slots;  // of each page
  std::span<const std::uint8_t> codes;         // 512 a slot
};

}  // namespace kelp::runtime
