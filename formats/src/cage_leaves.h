// SPDX-License-Identifier: MIT
// Which cells of a cage are in which leaf of the tree over them: near ones, by where they are at rest.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/formats/cage.h"

namespace kelp {

// slots: kLeafCells for each of cageLeaves(); what is left is kCageOutside. cells: memory for one number
// each.
void fillLeaves(const Cage& cage, std::span<std::uint32_t> cells, std::span<std::uint32_t> slots);

}  // namespace kelp
