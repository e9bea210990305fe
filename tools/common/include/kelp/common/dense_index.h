// SPDX-License-Identifier: MIT
// Where a voxel is in a dense array: x runs fastest, then y, then z.
#pragma once

#include <cstddef>

#include <glm/vec3.hpp>

namespace kelp {

// The index of voxel (x, y, z) in an array of size.x * size.y * size.z values. Computed in std::size_t, so
// large volumes do not overflow. The voxel must be inside: nothing is checked.
constexpr std::size_t denseIndex(const glm::ivec3& size, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(size.x) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z));
}
constexpr std::size_t denseIndex(const glm::ivec3& size, const glm::ivec3& voxel) {
  return denseIndex(size, voxel.x, voxel.y, voxel.z);
}

// The inverse: the voxel at an index. size.x and size.y must be positive.
constexpr glm::ivec3 voxelAt(const glm::ivec3& size, std::size_t index) {
  const auto x = static_cast<std::size_t>(size.x), y = static_cast<std::size_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
}

// The number of values in such an array.
constexpr std::size_t denseCount(const glm::ivec3& size) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
         static_cast<std::size_t>(size.z);
}

}  // namespace kelp
