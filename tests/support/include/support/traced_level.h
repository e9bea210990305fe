// SPDX-License-Identifier: MIT
// A level as packs are written from, for trace.glsl compiled as C++. Include from .cpp files only.
#pragma once

#include <array>

#include "kelp/formats/raw_pack.h"
#include "trace_cpp.h"

namespace kelp::test {

// The level must outlive what is answered.
inline trace::Level tracedLevel(const RawLevel& level, const glm::ivec3& size) {
  trace::Level out;
  out.cells = level.cells.data();
  out.grid = brickGrid(size);
  out.brick = [](const void* user, std::uint32_t cell) -> const std::uint8_t* {
    static constexpr auto kInside = [] {
      std::array<std::uint8_t, kBrickVoxels> codes{};
      codes.fill(kInnerCode);
      return codes;
    }();
    return cell == kCellInside ? kInside.data()
                               : static_cast<const RawLevel*>(user)->codes.data() +
                                     std::size_t{cell & kCellSlotMask} * kBrickVoxels;
  };
  out.user = &level;
  return out;
}

}  // namespace kelp::test
