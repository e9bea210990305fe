// SPDX-License-Identifier: MIT
// A pack's palette as MagicaVoxel's: 255 colours that voxels can have, materials by type, and the order in which the palette is shown.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kelp/formats/model.h"

namespace kelp::dump {

using VoxAttributes = std::vector<std::pair<std::string, std::string>>;

struct VoxPalette {
  std::array<std::uint8_t, 256> index_of{};             // of each palette entry that is used: 1 to 255
  std::array<std::array<std::uint8_t, 4>, 256> rgba{};  // as the RGBA chunk has it: of indices 1 to 255, then of the one that no voxel can have
  std::vector<std::pair<int, VoxAttributes>> materials; // colour index and MATL attributes, of all that are not plain
  std::optional<std::array<std::uint8_t, 256>> order;   // IMAP: the colour index at each place; none: 1, 2, 3, ...
  std::vector<std::string> notes;                       // what was lost
};

// Entry e becomes index e + 1 and stays at its place. `used`: which entries voxels have; if all 256 of them, the two that look most alike become one.
VoxPalette voxPalette(std::span<const Material> palette, const std::array<bool, 256>& used);

}  // namespace kelp::dump
