// SPDX-License-Identifier: MIT
// A signed distance for voxels: what programs of level sets expect, with the pack's own normals for its gradient.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "level_voxels.h"

namespace kelp::dump {

// At most 0 at solid voxels, above 0 at empty ones, exactly; in voxels. Near the surface it is close to the distance from it, and its central differences at a
// surface voxel point along the voxel's normal as nearly as the occupancy allows. Known in bricks of 8^3 that hold everything nearer than kHalfWidth.
class SignedField {
 public:
  static constexpr float kHalfWidth = 3;

  // DumpError (kFailure) where this machine has not the memory.
  explicit SignedField(const LevelVoxels& level);

  struct Brick {
    glm::ivec3 at;        // in bricks; may lie beside the level's grid
    const float* values;  // 512, as kelp/formats/brick.h orders codes; beyond the band, kHalfWidth with the sign of the place
  };
  std::size_t bricks() const { return places_.size(); }
  Brick brick(std::size_t i) const { return {places_[i], values_.data() + i * kBrickVoxels}; }
  bool has(const glm::ivec3& brick) const { return index_.contains(keyOf(brick)); }

 private:
  struct Sample {
    glm::ivec3 voxel;
    glm::vec3 normal;
    float value;  // at the voxel's centre
  };
  static std::uint64_t keyOf(const glm::ivec3& brick) {  // sides of a level are below 2^15 bricks
    return static_cast<std::uint64_t>(brick.x + 1) | static_cast<std::uint64_t>(brick.y + 1) << 20 | static_cast<std::uint64_t>(brick.z + 1) << 40;
  }
  void makeBricks(const std::vector<Sample>& samples);
  float& at(const glm::ivec3& voxel);
  void spread(const std::vector<Sample>& samples);
  void followNormals(const std::vector<Sample>& samples);
  void keepSides();

  const LevelVoxels& level_;
  std::vector<glm::ivec3> places_;
  std::vector<float> values_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_;
};

}  // namespace kelp::dump
