// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "kelp/common/dense_index.h"
#include "kelp/formats/brick.h"

namespace kelp::test {

// The voxels of the next coarser level that cover a surface voxel of one of `size`; ascending.
inline std::vector<std::uint64_t> surfaceAbove(std::span<const std::uint64_t> surface,
                                               const glm::ivec3& size) {
  std::set<std::uint64_t> above;
  for (const std::uint64_t i : surface)
    above.insert(denseIndex(levelSize(size, 1), kelp::voxelAt(size, i) / 2));
  return {above.begin(), above.end()};
}

}  // namespace kelp::test
