// SPDX-License-Identifier: MIT
// Packs whose parts have cages.
#pragma once

#include <utility>
#include <vector>

#include "kelp/fields/cages.h"
#include "support/test_pack.h"

namespace kelp::test {

// `pack` with a cage around each of its solid parts. cell: side of the finest cages' cells.
inline RawPack caged(RawPack pack, int cell) {
  for (RawPart& part : pack.parts) {
    part.cell = cell;
    part.cages = fields::buildCages(part.levels[0], part.size, static_cast<int>(part.levels.size()), cell);
  }
  return pack;
}
inline RawPack cagedPackOf(const fields::Occupancy& volume, int cell, std::vector<Knot> knots = {}) {
  return caged(packOf(volume, std::move(knots)), cell);
}

}  // namespace kelp::test
