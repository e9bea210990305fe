// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/leaks.h"

#include <array>
#include <cmath>
#include <limits>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

// Two faces of a voxel that share an edge, as steps to the neighbours behind them.
struct Corner {
  glm::ivec3 a{0}, b{0};
};

std::array<Corner, 12> makeCorners() {
  std::array<Corner, 12> corners;
  std::size_t count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 4; ++k) {
      Corner& corner = corners[count++];
      corner.a[(axis + 1) % 3] = k & 1 ? 1 : -1;
      corner.b[(axis + 2) % 3] = k & 2 ? 1 : -1;
    }
  }
  return corners;
}

class Grid {
 public:
  Grid(const glm::ivec3& size, const std::vector<std::uint8_t>& voxels) : size_(size), voxels_(voxels) {}
  std::uint8_t at(const glm::ivec3& v) const {
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return kEmpty;
    return voxels_[denseIndex(size_, v)];
  }

 private:
  glm::ivec3 size_;
  const std::vector<std::uint8_t>& voxels_;
};

}  // namespace

void closeDiagonalGaps(const Topology& mesh, const TriangleBvh& bvh,
                       const std::vector<std::uint64_t>& touched, const glm::ivec3& size, int threads,
                       std::vector<std::uint8_t>& voxels) {
  static const std::array<Corner, 12> corners = makeCorners();
  const Grid grid(size, voxels);
  // Squared distance of the mesh from a point; infinite beyond `bound`.
  const auto distance = [&](const glm::dvec3& p, double bound) {
    const Nearest nearest =
        bvh.nearest(p, bound, [&](std::uint32_t i) { return mesh.triangles[i].source != kCap; });
    return nearest.triangle != kCap ? nearest.squared : std::numeric_limits<double>::infinity();
  };
  const auto closes = [&](const glm::ivec3& voxel) {
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    double own = -1;
    for (const Corner& corner : corners) {
      const std::uint8_t a = grid.at(voxel + corner.a), b = grid.at(voxel + corner.b);
      const glm::dvec3 beyond(corner.a + corner.b);
      if (a == kEmpty || b == kEmpty || (a != kKept && b != kKept) ||
          grid.at(voxel + corner.a + corner.b) != kEmpty)
        continue;
      if (std::isinf(distance(centre + 0.5 * beyond, kHalfDiagonal))) continue;
      if (own < 0) own = distance(centre, 2);
      const double other = distance(centre + beyond, 2);
      if (own < other || (own == other && beyond.x + 2 * beyond.y + 4 * beyond.z > 0)) return true;
    }
    return false;
  };
  // A voxel that closes one gap may touch another along an edge.
  constexpr int kRounds = 4;
  std::vector<std::uint8_t> chosen(touched.size());
  for (int round = 0; round < kRounds; ++round) {
    // All are chosen before any is set, so that their order does not matter.
    parallelRanges(touched.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        chosen[i] = voxels[touched[i]] == kEmpty && closes(voxelAt(size, touched[i])) ? 1 : 0;
    });
    bool any = false;
    for (std::size_t i = 0; i < touched.size(); ++i) {
      if (!chosen[i]) continue;
      voxels[touched[i]] = kKept;
      any = true;
    }
    if (!any) break;
  }
}

}  // namespace kelp::bake
