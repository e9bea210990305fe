// SPDX-License-Identifier: MIT
// Levels compared as files hold them. A file has no empty boxes: the reader makes them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "kelp/formats/brick.h"
#include "kelp/formats/raw_pack.h"

namespace kelp::test {

// The level's cells and codes, with the boxes of empty bricks and empty voxels set to 0.
inline std::pair<std::vector<std::uint32_t>, std::vector<std::uint8_t>> withoutBoxes(const RawLevel& level) {
  std::pair out(level.cells, level.codes);
  for (std::uint32_t& cell : out.first) cell &= cell & kCellSolid ? ~0u : ~0xffffffu;
  for (std::uint8_t& code : out.second) code = isSolidCode(code) ? code : std::uint8_t{0};
  return out;
}

}  // namespace kelp::test
