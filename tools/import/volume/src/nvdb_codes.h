// SPDX-License-Identifier: MIT
// Values of NanoVDB's types. Layout: nanovdb/NanoVDB.h (LeafData, LeafFnBase).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "sparse_grid.h"

namespace kelp::bake {

GridKind nanoKind(std::uint32_t type);  // kOther for types that kelp does not read
std::string nanoTypeName(std::uint32_t type);
int nanoComponents(std::uint32_t type);
bool nanoIsWide(std::uint32_t type);  // floats do not hold its values exactly

// Component `i` of the value that begins at bytes; of masks, the state.
double nanoValue(std::span<const std::uint8_t> bytes, std::size_t i, std::uint32_t type, bool active);

// The numbers of a leaf.
struct NanoCodes {
  std::uint64_t offset = 0, bytes = 0;  // from the leaf's beginning
  int bits = 0;                         // a number; 0: they are values, and not codes between two of them
};
// `head`: the leaf's first 16 bytes; `table`: where its type has values.
NanoCodes nanoCodes(std::uint32_t type, const std::uint8_t* head, std::uint64_t table);
// `scale`: what code 0 is and what each adds to it, two floats; of codes.
double nanoLeafValue(std::span<const std::uint8_t> values, std::span<const std::uint8_t> scale,
                     const NanoCodes& codes, std::size_t i, std::uint32_t type, bool active);

}  // namespace kelp::bake
