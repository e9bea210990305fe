// SPDX-License-Identifier: MIT
// Level-0 voxels of a part, decoded into dense arrays: a volume as the paper stores it.
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/runtime/asset.h"

namespace kelp::render {

// 24 bits of an attribute that encodeNormal never returns: the voxel has no normal.
inline constexpr std::uint32_t kNoNormal = 0xffffff;

// Arrays are dense: x fastest, then y, then z.
struct DenseVolume {
  glm::ivec3 size{0};
  std::vector<std::uint8_t> solid;  // 0 or 1
  // Palette index | normal << 8 (kelp/formats/brick.h). An inner voxel has none of its own: it gets that of
  // the nearest surface voxel among its 26 neighbors, because a march with steps may pass the surface; else
  // entry 0 and kNoNormal.
  std::vector<std::uint32_t> attributes;
};

// `part` must be solid and wholly loaded.
DenseVolume decodeDense(const runtime::Asset& asset, int part);

// Distance from each voxel's center to the center of the nearest solid voxel, in voxels, as half floats,
// rounded down; 0 in solid voxels. `threads` as in kelp::fields.
std::vector<std::uint16_t> distanceField(const DenseVolume& volume, int threads);

}  // namespace kelp::render
