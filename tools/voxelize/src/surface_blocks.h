// SPDX-License-Identifier: MIT
// The voxels of the surface, block by block: what is nearest to one of a block is near to all of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace kelp::bake {

class SurfaceBlocks {
 public:
  // `surface`: dense indices, ascending.
  SurfaceBlocks(const std::vector<std::uint64_t>& surface, const glm::ivec3& size, int threads);

  std::size_t count() const { return blocks_.size(); }
  // Calls visit(place in `surface`) for the voxels of a block, in their order.
  template <class Visit>
  void forEach(std::size_t block, const Visit& visit) const {
    const Block& its = blocks_[block];
    for (std::size_t i = its.begin; i < its.end; ++i) visit(its.layer + places_[i]);
  }

 private:
  struct Block {
    std::size_t layer, begin, end;  // where the voxels of its layer begin; its own are [begin, end)
  };
  std::vector<Block> sortLayer(const std::vector<std::uint64_t>& surface, const glm::ivec3& size,
                               std::size_t begin, std::size_t end);

  std::vector<std::uint32_t> places_;  // from the layer's first voxel on
  std::vector<Block> blocks_;
};

}  // namespace kelp::bake
