// SPDX-License-Identifier: MIT
// Checks of arguments that every entry point makes.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"

namespace kelp::fields {

// Voxels of a volume. Throws std::invalid_argument for sides that are not in 1 .. kMaxSide.
inline std::size_t checkedVolume(const glm::ivec3& size) {
  for (const int side : {size.x, size.y, size.z}) {
    if (side < 1 || side > kMaxSide) {
      throw std::invalid_argument("a volume's sides must be 1 to " + std::to_string(kMaxSide) +
                                  " voxels, not " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                                  " x " + std::to_string(size.z));
    }
  }
  return denseCount(size);
}

inline std::size_t checkedVolume(std::size_t values, const glm::ivec3& size) {
  const std::size_t volume = checkedVolume(size);
  if (values != volume) {
    throw std::invalid_argument("a volume of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                                " x " + std::to_string(size.z) + " voxels comes with " +
                                std::to_string(values) + " values instead of " + std::to_string(volume));
  }
  return volume;
}

}  // namespace kelp::fields
