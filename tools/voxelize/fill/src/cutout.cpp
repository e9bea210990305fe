// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/cutout.h"

#include "kelp/common/parallel.h"

namespace kelp::bake {

void cutOutVoxels(const SurfaceLook& look, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                  std::vector<std::uint8_t>& voxels) {
  const std::size_t row = static_cast<std::size_t>(size.x), rows = static_cast<std::size_t>(size.y);
  parallelRanges(
      rows * static_cast<std::size_t>(size.z), 64, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t line = begin; line < end; ++line) {
          for (std::size_t x = 0; x < row; ++x) {
            std::uint8_t& voxel = voxels[line * row + x];
            if (voxel != kKept) continue;
            const glm::dvec3 centre = glm::dvec3(glm::u64vec3(x, line % rows, line / rows)) + 0.5;
            // The nearest sheet first: most voxels have one, and need no search among several.
            if (look.isCutOut(bvh.nearest(centre)) && look.nearestShown(bvh, centre).triangle == kCap)
              voxel = kEmpty;
          }
        }
      });
}

}  // namespace kelp::bake
