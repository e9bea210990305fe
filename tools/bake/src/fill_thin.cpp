// SPDX-License-Identifier: MIT
#include "fill_thin.h"

#include <cmath>

#include "parallel.h"

namespace kelp::bake {
namespace {

constexpr std::uint32_t kCentreBit = 1u << 13;
constexpr double kHalfDiagonal = 0.8660254037844387;
constexpr std::size_t kGrain = 4096;

// For each of the 27 cells the cells that touch it.
struct Touching {
  std::uint32_t mask[27] = {};

  Touching() {
    for (int a = 0; a < 27; ++a) {
      for (int b = 0; b < 27; ++b) {
        if (std::abs(a % 3 - b % 3) <= 1 && std::abs(a / 3 % 3 - b / 3 % 3) <= 1 && std::abs(a / 9 - b / 9) <= 1) mask[a] |= 1u << b;
      }
    }
  }
};

// Whether the cells of `mask` (without the centre) hang together.
bool connected(std::uint32_t mask) {
  static const Touching touching;
  std::uint32_t reached = mask & (0u - mask);
  std::uint32_t frontier = reached;
  while (frontier != 0) {
    std::uint32_t grown = 0;
    for (int cell = 0; cell < 27; ++cell) {
      if (frontier & (1u << cell)) grown |= touching.mask[cell];
    }
    frontier = grown & mask & ~reached;
    reached |= frontier;
  }
  return reached == mask;
}

glm::ivec3 voxelAt(std::uint64_t index, const glm::ivec3& size) {
  const std::uint64_t x = static_cast<std::uint64_t>(size.x), y = static_cast<std::uint64_t>(size.y);
  return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y))};
}

}  // namespace

std::uint32_t neighbourMask(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size, const glm::ivec3& voxel) {
  std::uint32_t mask = 0;
  int bit = 0;
  for (int z = voxel.z - 1; z <= voxel.z + 1; ++z) {
    for (int y = voxel.y - 1; y <= voxel.y + 1; ++y) {
      if (y < 0 || z < 0 || y >= size.y || z >= size.z) {
        bit += 3;
        continue;
      }
      const std::size_t row = static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z));
      for (int x = voxel.x - 1; x <= voxel.x + 1; ++x, ++bit) {
        if (x >= 0 && x < size.x && voxels[row + static_cast<std::size_t>(x)] != kEmpty) mask |= 1u << bit;
      }
    }
  }
  return mask;
}

void keepThinParts(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                   std::vector<std::uint8_t>& voxels) {
  constexpr std::uint8_t kLost = 3;  // kept by the first pass; the second looks for its neighbours
  std::vector<std::uint8_t> chosen(touched.size(), 0);
  const auto sweep = [&](const auto& wanted) {
    parallelRanges(touched.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        chosen[i] = 0;
        if (voxels[touched[i]] != kEmpty) continue;
        const glm::ivec3 voxel = voxelAt(touched[i], size);
        const std::uint32_t mask = neighbourMask(voxels, size, voxel) & ~kCentreBit;
        chosen[i] = wanted(voxel, mask) ? 1 : 0;
      }
    });
  };
  // The nearest triangle, if its nearest point lies in the voxel.
  const auto passing = [&](const glm::ivec3& voxel) {
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    Nearest nearest = bvh.nearest(centre, kHalfDiagonal);
    const glm::dvec3 away = glm::abs(nearest.point - centre);
    if (std::max({away.x, away.y, away.z}) > 0.5) nearest.triangle = kCap;
    return nearest.triangle;
  };
  const auto keep = [&](std::uint8_t value) {
    for (std::size_t i = 0; i < touched.size(); ++i) {
      if (chosen[i]) voxels[touched[i]] = value;
    }
  };

  sweep([&](const glm::ivec3& voxel, std::uint32_t mask) { return mask == 0 && passing(voxel) != kCap; });
  keep(kLost);
  sweep([&](const glm::ivec3& voxel, std::uint32_t mask) {
    if (mask == 0 || connected(mask)) return false;
    const std::uint32_t triangle = passing(voxel);
    if (triangle == kCap) return false;
    if (mesh.components[mesh.triangles[triangle].component].thin) return true;
    for (int z = std::max(0, voxel.z - 1); z <= std::min(size.z - 1, voxel.z + 1); ++z) {
      for (int y = std::max(0, voxel.y - 1); y <= std::min(size.y - 1, voxel.y + 1); ++y) {
        for (int x = std::max(0, voxel.x - 1); x <= std::min(size.x - 1, voxel.x + 1); ++x) {
          const std::size_t at = static_cast<std::size_t>(x) + static_cast<std::size_t>(size.x) * (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z));
          if (voxels[at] == kLost) return true;
        }
      }
    }
    return false;
  });
  keep(kKept);
  for (const std::uint64_t index : touched) {
    if (voxels[index] == kLost) voxels[index] = kKept;
  }
}

}  // namespace kelp::bake
