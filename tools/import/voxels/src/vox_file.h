// SPDX-License-Identifier: MIT
// The content of a MagicaVoxel file as plain data, with every size and number checked; and what vox_scene.cpp
// and vox_palette.cpp read from it: the placed models and the palette.
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

#include "kelp/import/voxels/indexed_voxels.h"

namespace kelp::bake {

struct VoxModel {
  glm::ivec3 size{0};  // 0 to 256 a side
  // x, y, z and color index of each, inside `size`; index 0: nothing; if several are in one place, the last
  // counts
  std::span<const std::uint8_t> voxels;
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
  bool loop = false;                   // its keys repeat
  std::int32_t layer = -1;             // transforms only
  std::vector<std::int32_t> children;  // transforms have one
  std::vector<VoxMove> moves;          // transforms only: at least one
  // shapes only: pairs of a frame and the model from then on; at least one
  std::vector<std::pair<std::int64_t, std::int32_t>> models;
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
  std::vector<std::vector<std::uint8_t>> unpacked;  // voxels of models that the file has packed
  std::map<std::int32_t, VoxNode> nodes;
  std::map<std::int32_t, VoxLayer> layers;
  std::optional<std::array<std::array<std::uint8_t, 4>, 256>> colors;  // of indices 1 to 255, and one unused
  std::array<VoxMaterial, 256> materials;                              // by color index
  // the color index at each place of the palette as MagicaVoxel shows it
  std::optional<std::array<std::uint8_t, 256>> index_map;
  // the first and last frame that the animation plays
  std::optional<std::pair<std::int64_t, std::int64_t>> frames;
  std::vector<std::string> notices;
};

// The result holds views into `bytes`. ToolError kInvalid for damaged files, kUnsupported for another
// version, kRuntime if packed models have more than `max_memory` bytes. Safe for hostile input: memory is
// bounded by the file's bytes and by that.
VoxFile readVoxFile(const InputFiles& files, std::span<const std::uint8_t> bytes, std::uint64_t max_memory);

// The voxels, as VoxModel has them, of a model that Teardown packed: an index for each, x fastest, then y, by
// zlib. ToolError kInvalid if that is not what `packed` holds, kUnsupported where there is no zlib.
std::vector<std::uint8_t> unpackVoxels(const InputFiles& files, const std::string& place,
                                       std::span<const std::uint8_t> packed, const glm::ivec3& size);

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
  std::array<std::uint8_t, 256> entry_of{};  // for each color index
  std::vector<std::string> notices;
};
// `used`: whether a voxel has this color index.
VoxPalette readVoxPalette(const VoxFile& file, const std::array<bool, 256>& used);

}  // namespace kelp::bake
