// SPDX-License-Identifier: MIT
// Tells which voxels at the surface of bodies may go or come without harm to their shape.
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"
#include "kelp/common/progress.h"
#include "kelp/voxelize/fill/fill.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// Answers from the voxels as they are: it sees every change that is made to them. Keeps references to all
// that it is made from. Queries may run on several threads while nothing changes.
class ChangeRules {
 public:
  ChangeRules(const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint64_t>& touched,
              const glm::ivec3& size, const std::vector<std::uint8_t>& voxels)
      : mesh_(mesh), bvh_(bvh), touched_(touched), size_(size), voxels_(voxels) {}

  // The surroundings of a touched voxel: the nearest body, if a solid one is nearest.
  struct Near {
    std::uint32_t component = kCap;  // kCap: none
    float height = 0;                // of the voxel's center above the surface, voxels; inside: below 0
    std::uint8_t below = 0;          // the one of the six neighbors that lies deeper in the body
    bool sheet = false;              // a sheet or a wall is near too
    bool through = false;            // the nearest point of the body lies in the voxel

    bool sameSide(const Near& other) const {
      return height == other.height && component == other.component && below == other.below;
    }
  };
  void findNear(int threads, const Step& step);
  // `i`: the number of the touched voxel.
  const Near& near(std::size_t i) const { return near_[i]; }

  bool isSolidAt(std::uint64_t index) const { return voxels_[index] != kEmpty; }

  // Adds to the solid voxels of a flat side those at its edges. They lie nearer to the sides around, and
  // would be left as a ridge.
  void addEdges(std::vector<std::size_t>& side) const;

  // True if a solid voxel is the rim of a plate or the side of a blade: two opposite neighbors are empty,
  // other than the one below and its opposite.
  bool isRim(std::size_t i, int below) const;

  // True if a touched voxel may change from solid to empty or back: its body goes on below it, and the change
  // connects, parts, opens and closes nothing.
  bool mayChange(std::size_t i, int below) const;

 private:
  Near nearest(std::uint64_t index) const;
  // The nearest triangle that is not a cap, within half a diagonal.
  Nearest nearestDrawn(const glm::dvec3& center) const;
  bool isSolid(std::uint32_t triangle) const {
    return mesh_.components[mesh_.triangles[triangle].component].solid;
  }
  bool isWithin(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z;
  }
  std::uint8_t at(const glm::ivec3& v) const {
    return isWithin(v) ? voxels_[denseIndex(size_, v)] : static_cast<std::uint8_t>(kEmpty);
  }
  // Null if the voxel is not touched.
  const Near* nearAt(const glm::ivec3& v) const;
  bool isTouched(const glm::ivec3& v) const;
  // True if a solid voxel belongs to that body, and not to another that lies against it. Voxels deep inside
  // belong to the body around them.
  bool isOwn(const glm::ivec3& v, std::uint32_t component) const;
  int solidFaces(const glm::ivec3& v) const;

  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint64_t>& touched_;
  glm::ivec3 size_;
  const std::vector<std::uint8_t>& voxels_;
  std::vector<Near> near_;
};

}  // namespace kelp::bake
