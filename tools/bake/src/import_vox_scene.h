// SPDX-License-Identifier: MIT
// Where the models of a MagicaVoxel file stand, and what its colours are made of.
#pragma once

#include "import_vox_file.h"

namespace kelp::bake {

struct VoxInstance {
  std::size_t model = 0;
  VoxelTurn turn{1};     // about the model's pivot, the corner at half its size, rounded down
  VoxelPoint shift{0};   // where the pivot stands
  std::string name;    // of its node
};

struct VoxScene {
  std::vector<VoxInstance> instances;  // where several have a voxel in one place, the last one's is seen
  std::vector<std::string> notices;
};

// All that is visible at a frame; without one, at the first key of everything that moves. A file without nodes is its model of that number, standing on the
// ground. BakeError kInvalid for nodes that are missing or below themselves, kUsage for a frame that there is none of.
VoxScene arrangeVox(const InputFiles& files, const VoxFile& file, std::optional<int> frame);

struct VoxPalette {
  std::vector<Material> entries;               // 256, in the order in which MagicaVoxel shows them
  std::array<std::uint8_t, 256> entry_of{};    // of each colour index
  std::vector<std::string> notices;
};
// `used`: the colour indices that voxels have.
VoxPalette readVoxPalette(const VoxFile& file, const std::array<bool, 256>& used);

}  // namespace kelp::bake
