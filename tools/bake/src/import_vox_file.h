// SPDX-License-Identifier: MIT
// What a MagicaVoxel file says, as it stands: chunks into plain data, every size and every number checked. What it means is import_vox_scene's and
// import_vox_palette's.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "import_voxels.h"

namespace kelp::bake {

struct VoxModel {
  glm::ivec3 size{0};                    // 1 to 256 a side
  std::span<const std::uint8_t> voxels;  // x, y, z and colour index of each, inside `size`; index 0: nothing; of several in one place the last counts
};

struct VoxMove {
  std::int64_t frame = 0;
  VoxelTurn turn{1};
  VoxelPoint shift{0};
};

struct VoxNode {
  enum class Kind : std::uint8_t { kTransform, kGroup, kShape };
  Kind kind = Kind::kGroup;
  std::string_view name;
  bool hidden = false;
  bool loop = false;                                         // its keys repeat
  std::int32_t layer = -1;                                   // of a transform
  std::vector<std::int32_t> children;                        // one of a transform
  std::vector<VoxMove> moves;                                // of a transform: at least one
  std::vector<std::pair<std::int64_t, std::int32_t>> models; // of a shape: frames and what it is from then on; at least one
};

struct VoxLayer {
  std::string_view name;
  bool hidden = false;
};

struct VoxMaterial {
  enum class Type : std::uint8_t { kDiffuse, kMetal, kGlass, kEmit, kBlend, kMedia };
  Type type = Type::kDiffuse;
  std::optional<float> weight, metal, rough, emit, flux, transparency;  // finite
  bool plastic = false;
};

struct VoxFile {
  int version = 0;  // 150, 200
  std::vector<VoxModel> models;
  std::map<std::int32_t, VoxNode> nodes;
  std::map<std::int32_t, VoxLayer> layers;
  std::optional<std::array<std::array<std::uint8_t, 4>, 256>> colors;  // of indices 1 to 255, and one more
  std::array<VoxMaterial, 256> materials;                             // by colour index
  std::optional<std::array<std::uint8_t, 256>> index_map;             // the colour index at each place of the palette as it is shown
  std::optional<std::pair<std::int64_t, std::int64_t>> frames;        // that the animation plays, first and last
  std::vector<std::string> notices;
};

// Views into `bytes`. BakeError kInvalid and kUnsupported (another version). Safe for hostile input: nothing is allocated that is not there in the file.
VoxFile readVoxFile(const InputFiles& files, std::span<const std::uint8_t> bytes);

}  // namespace kelp::bake
