// SPDX-License-Identifier: MIT
// The placed models and the palette of a MagicaVoxel file.
#pragma once

#include "vox_file.h"

namespace kelp::bake {

struct VoxInstance {
  std::size_t model = 0;
  VoxelTurn turn{1};    // about the model's pivot: the corner at half its size, rounded down
  VoxelPoint shift{0};  // the place of the pivot
  std::string name;     // of its node
};

struct VoxScene {
  std::vector<VoxInstance> instances;  // if several have a voxel in one place, the last one's is seen
  std::vector<std::string> notices;
};

// Everything that is visible at a frame; without one, at the first key of everything. In a file without
// nodes, `frame` is the number of the model, which stands on the ground. ToolError kInvalid for nodes that
// are missing or below themselves, kUsage for a frame that does not exist.
VoxScene arrangeVox(const InputFiles& files, const VoxFile& file, std::optional<int> frame);

struct VoxPalette {
  std::vector<Material> entries;             // 256, in MagicaVoxel's order
  std::array<std::uint8_t, 256> entry_of{};  // for each colour index
  std::vector<std::string> notices;
};
// `used`: whether a voxel has this colour index.
VoxPalette readVoxPalette(const VoxFile& file, const std::array<bool, 256>& used);

}  // namespace kelp::bake
