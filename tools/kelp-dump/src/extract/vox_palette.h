// SPDX-License-Identifier: MIT
// A pack's palette for MagicaVoxel: 255 colors that voxels can have, materials by type, and the order in
// which the palette is shown.
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
  std::array<std::uint8_t, 256> index_of{};  // of each palette entry that is used: 1 to 255
  // In the order of the RGBA chunk: indices 1 to 255, then the one that no voxel can have.
  std::array<std::array<std::uint8_t, 4>, 256> rgba{};
  // Color index and MATL attributes of every material that is not plain.
  std::vector<std::pair<int, VoxAttributes>> materials;
  // IMAP: the color index at each place. None: 1, 2, 3, ...
  std::optional<std::array<std::uint8_t, 256>> order;
  std::vector<std::string> notes;  // what was lost
};

// Entry e becomes index e + 1 and stays at its place. `used`: which entries voxels have. If all 256 are used,
// the two that look most alike become one.
VoxPalette voxPalette(std::span<const Material> palette, const std::array<bool, 256>& used);

}  // namespace kelp::dump
