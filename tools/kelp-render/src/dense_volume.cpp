// SPDX-License-Identifier: MIT
#include "dense_volume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/gtc/packing.hpp>

#include "kelp/common/pack_error.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/raw_level.h"

namespace kelp::render {
namespace {

constexpr std::uint32_t kNoAttribute = kNoNormal << 8;

std::size_t indexOf(const DenseVolume& volume, const glm::ivec3& v) {
  return static_cast<std::size_t>(v.x) +
         static_cast<std::size_t>(volume.size.x) *
             (static_cast<std::size_t>(v.y) +
              static_cast<std::size_t>(volume.size.y) * static_cast<std::size_t>(v.z));
}

// Calls visit(voxel) for all voxels of the brick that are in the volume.
template <class Visit>
void forVoxels(const DenseVolume& volume, const glm::ivec3& brick, Visit&& visit) {
  const glm::ivec3 low = kBrickSide * brick, high = glm::min(low + kBrickSide, volume.size);
  for (int z = low.z; z < high.z; ++z) {
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) visit(glm::ivec3(x, y, z));
    }
  }
}

// The 26 neighbors, nearest first.
std::array<glm::ivec3, 26> neighbors() {
  std::array<glm::ivec3, 26> all;
  std::size_t count = 0;
  for (int far = 1; far <= 3; ++far) {
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 offset(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      if (offset.x * offset.x + offset.y * offset.y + offset.z * offset.z == far) all[count++] = offset;
    }
  }
  return all;
}

// Gives inner voxels beside surface voxels the attribute of the nearest one.
void spreadInwards(DenseVolume& volume, const std::vector<glm::ivec3>& surface) {
  for (const glm::ivec3& offset : neighbors()) {
    for (const glm::ivec3& voxel : surface) {
      const glm::ivec3 at = voxel + offset;
      if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= volume.size.x || at.y >= volume.size.y ||
          at.z >= volume.size.z)
        continue;
      const std::size_t inner = indexOf(volume, at);
      if (volume.solid[inner] && volume.attributes[inner] == kNoAttribute)
        volume.attributes[inner] = volume.attributes[indexOf(volume, voxel)];
    }
  }
}

// All of level 0. The pack was read before, so errors are those of a file that changed meanwhile.
RawLevel readFinest(const Pack& pack, int part) {
  Result<RawLevel> level = readRawLevel(pack, part, 0);
  if (!level)
    throw ToolError(exitOf(level.error().code),
                    std::string("a page cannot be read: ") + level.error().detail);
  return *std::move(level);
}

}  // namespace

DenseVolume decodeDense(const runtime::Asset& asset, int part) {
  const RawLevel level = readFinest(asset.pack(), part);
  DenseVolume volume;
  volume.size = asset.pack().parts()[static_cast<std::size_t>(part)].size;
  const std::size_t voxels = static_cast<std::size_t>(volume.size.x) *
                             static_cast<std::size_t>(volume.size.y) *
                             static_cast<std::size_t>(volume.size.z);
  volume.solid.resize(voxels);
  volume.attributes.resize(voxels);
  std::vector<glm::ivec3> surface, bricks(level.codes.size() / kBrickVoxels);  // by slot
  const glm::ivec3 grid = brickGrid(volume.size);
  std::size_t cell_index = 0;
  glm::ivec3 brick;
  for (brick.z = 0; brick.z < grid.z; ++brick.z) {
    for (brick.y = 0; brick.y < grid.y; ++brick.y) {
      for (brick.x = 0; brick.x < grid.x; ++brick.x) {
        const std::uint32_t cell = level.cells[cell_index++];
        if (isStoredCell(cell)) bricks[cell & kCellSlotMask] = brick;
        if (cell != kCellInside) continue;
        forVoxels(volume, brick, [&](const glm::ivec3& voxel) {
          volume.solid[indexOf(volume, voxel)] = 1;
          volume.attributes[indexOf(volume, voxel)] = kNoAttribute;
        });
      }
    }
  }
  const std::uint8_t* code = level.codes.data();
  const std::uint32_t* attribute = level.attributes.data();
  for (const glm::ivec3& stored : bricks) {
    for (int i = 0; i < kBrickVoxels; ++i, ++code) {
      if (!isSolidCode(*code)) continue;
      const glm::ivec3 voxel = kBrickSide * stored + glm::ivec3(i & 7, i >> 3 & 7, i >> 6);
      volume.solid[indexOf(volume, voxel)] = 1;
      volume.attributes[indexOf(volume, voxel)] = isSurfaceCode(*code) ? *attribute++ : kNoAttribute;
      if (isSurfaceCode(*code)) surface.push_back(voxel);
    }
  }
  spreadInwards(volume, surface);
  return volume;
}

std::vector<std::uint16_t> distanceField(const DenseVolume& volume, int threads) {
  std::vector<std::uint32_t> squared(volume.solid.size());
  fields::squaredDistance(volume.solid, volume.size, squared, threads);
  std::vector<std::uint16_t> distances(squared.size());
  std::transform(squared.begin(), squared.end(), distances.begin(), [](std::uint32_t d2) {
    const float distance = std::sqrt(static_cast<float>(d2));
    std::uint16_t half = glm::packHalf1x16(std::min(distance, 65504.0f));
    if (glm::unpackHalf1x16(half) > distance) --half;
    return half;
  });
  return distances;
}

}  // namespace kelp::render
