// SPDX-License-Identifier: MIT
#include "surface_blocks.h"

#include <algorithm>
#include <utility>

#include <glm/vec2.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr int kBlock = 8;

}  // namespace

SurfaceBlocks::SurfaceBlocks(const std::vector<std::uint64_t>& surface, const glm::ivec3& size, int threads)
    : places_(surface.size()) {
  const std::size_t layers = static_cast<std::size_t>((size.z + kBlock - 1) / kBlock);
  const std::uint64_t voxels = denseIndex(size, 0, 0, kBlock);  // of a layer
  std::vector<std::vector<Block>> found(layers);
  parallelRanges(layers, 1, threads, [&](std::size_t layer, std::size_t) {
    const auto at = [&](std::size_t its) {
      return static_cast<std::size_t>(std::lower_bound(surface.begin(), surface.end(), its * voxels) -
                                      surface.begin());
    };
    found[layer] = sortLayer(surface, size, at(layer), at(layer + 1));
  });
  for (const std::vector<Block>& its : found) blocks_.insert(blocks_.end(), its.begin(), its.end());
}

// By counting.
std::vector<SurfaceBlocks::Block> SurfaceBlocks::sortLayer(const std::vector<std::uint64_t>& surface,
                                                           const glm::ivec3& size, std::size_t begin,
                                                           std::size_t end) {
  const glm::ivec2 grid = (glm::ivec2(size) + kBlock - 1) / kBlock;
  const auto blockOf = [&](std::uint64_t index) {
    const glm::ivec3 voxel = voxelAt(size, index);
    return static_cast<std::size_t>(voxel.x / kBlock + voxel.y / kBlock * grid.x);
  };
  std::vector<std::size_t> next(static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y), 0);
  for (std::size_t i = begin; i < end; ++i) ++next[blockOf(surface[i])];
  std::vector<Block> blocks;
  std::size_t first = begin;
  for (std::size_t& its : next) {
    if (its > 0) blocks.push_back({begin, first, first + its});
    first += std::exchange(its, first);
  }
  for (std::size_t i = begin; i < end; ++i)
    places_[next[blockOf(surface[i])]++] = static_cast<std::uint32_t>(i - begin);
  return blocks;
}

}  // namespace kelp::bake
