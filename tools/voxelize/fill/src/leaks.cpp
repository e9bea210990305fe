// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kVoxelsAtOnce = 1 << 20;

// Two faces of a voxel that share an edge, as steps to the neighbors behind them.
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

// The kKept voxels, ascending.
std::vector<std::uint64_t> keptVoxels(const std::vector<std::uint8_t>& voxels, int threads) {
  std::vector<std::vector<std::uint64_t>> found((voxels.size() + kVoxelsAtOnce - 1) / kVoxelsAtOnce);
  parallelRanges(voxels.size(), kVoxelsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint64_t>& here = found[begin / kVoxelsAtOnce];
    const std::uint8_t* const first = voxels.data() + begin;
    const std::uint8_t* const last = voxels.data() + end;
    for (const std::uint8_t* at = first; at != last; ++at) {
      at = static_cast<const std::uint8_t*>(std::memchr(at, kKept, static_cast<std::size_t>(last - at)));
      if (at == nullptr) break;
      here.push_back(begin + static_cast<std::size_t>(at - first));
    }
  });
  std::vector<std::uint64_t> all;
  for (const auto& here : found) all.insert(all.end(), here.begin(), here.end());
  return all;
}

// Closes gaps round by round.
class GapCloser {
 public:
  GapCloser(const Topology& mesh, const TriangleBvh& bvh, const glm::ivec3& size,
            std::vector<std::uint8_t>& voxels)
      : mesh_(mesh), bvh_(bvh), size_(size), voxels_(voxels) {}

  // Keeps the voxels that close a gap beside one of `kept`. Answers which; the result does not depend on
  // their order, since all are chosen before any is set.
  std::vector<std::uint64_t> closeBeside(const std::vector<std::uint64_t>& kept, int threads) {
    const std::vector<std::uint64_t> empty = emptyBeside(kept);
    std::vector<std::uint8_t> chosen(empty.size());
    parallelRanges(empty.size(), 512, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) chosen[i] = closes(voxelAt(size_, empty[i])) ? 1 : 0;
    });
    std::vector<std::uint64_t> closed;
    for (std::size_t i = 0; i < empty.size(); ++i) {
      if (!chosen[i]) continue;
      voxels_[empty[i]] = kKept;
      closed.push_back(empty[i]);
    }
    return closed;
  }

 private:
  // The empty voxels that share a face with one of `kept`.
  std::vector<std::uint64_t> emptyBeside(const std::vector<std::uint64_t>& kept) const {
    std::vector<std::uint64_t> empty;
    for (const std::uint64_t index : kept) {
      const glm::ivec3 voxel = voxelAt(size_, index);
      for (int face = 0; face < 6; ++face) {
        glm::ivec3 beside = voxel;
        beside[face / 2] += face % 2 ? 1 : -1;
        if (isWithin(beside) && at(beside) == kEmpty) empty.push_back(denseIndex(size_, beside));
      }
    }
    std::sort(empty.begin(), empty.end());
    empty.erase(std::unique(empty.begin(), empty.end()), empty.end());
    return empty;
  }

  bool closes(const glm::ivec3& voxel) const {
    static const std::array<Corner, 12> corners = makeCorners();
    const glm::dvec3 center = glm::dvec3(voxel) + 0.5;
    double own = -1;
    for (const Corner& corner : corners) {
      const std::uint8_t a = at(voxel + corner.a), b = at(voxel + corner.b);
      const glm::dvec3 beyond(corner.a + corner.b);
      if (a == kEmpty || b == kEmpty || (a != kKept && b != kKept) ||
          at(voxel + corner.a + corner.b) != kEmpty)
        continue;
      if (own < 0) own = distance(center, kHalfDiagonal);
      if (std::isinf(own)) return false;
      if (std::isinf(distance(center + 0.5 * beyond, kHalfDiagonal))) continue;
      const double other = distance(center + beyond, 2);
      if (own < other || (own == other && beyond.x + 2 * beyond.y + 4 * beyond.z > 0)) return true;
    }
    return false;
  }

  // Squared distance of the mesh from a point; infinite beyond `bound`.
  double distance(const glm::dvec3& p, double bound) const {
    const Nearest nearest =
        bvh_.nearest(p, bound, [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
    return nearest.triangle != kCap ? nearest.squared : std::numeric_limits<double>::infinity();
  }

  bool isWithin(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z;
  }
  std::uint8_t at(const glm::ivec3& v) const {
    return isWithin(v) ? voxels_[denseIndex(size_, v)] : static_cast<std::uint8_t>(kEmpty);
  }

  const Topology& mesh_;
  const TriangleBvh& bvh_;
  glm::ivec3 size_;
  std::vector<std::uint8_t>& voxels_;
};

}  // namespace

void closeDiagonalGaps(const Topology& mesh, const TriangleBvh& bvh, const glm::ivec3& size, int threads,
                       std::vector<std::uint8_t>& voxels) {
  GapCloser closer(mesh, bvh, size, voxels);
  std::vector<std::uint64_t> kept = keptVoxels(voxels, threads);
  // A voxel that closes one gap may touch another along an edge.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds && !kept.empty(); ++round) kept = closer.closeBeside(kept, threads);
}

}  // namespace kelp::bake
