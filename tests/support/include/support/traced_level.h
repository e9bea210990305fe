// SPDX-License-Identifier: MIT
// A level as packs are written from, for trace.glsl compiled as C++. Include from .cpp files only.
#pragma once

#include "kelp/formats/raw_pack.h"
#include "trace_cpp.h"

namespace kelp::test {

// The level must outlive what is answered.
inline trace::Level tracedLevel(const RawLevel& level, const glm::ivec3& size) {
  trace::Level out;
  out.cells = level.cells.data();
  out.grid = brickGrid(size);
  out.brick = [](const void* user, std::uint32_t cell) -> const std::uint8_t* {
    return static_cast<const RawLevel*>(user)->codes.data() +
           std::size_t{cell & kCellSlotMask} * kBrickVoxels;
  };
  out.user = &level;
  return out;
}

}  // namespace kelp::test
