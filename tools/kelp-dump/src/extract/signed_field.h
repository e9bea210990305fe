// SPDX-License-Identifier: MIT
// A signed distance field of voxels, for programs that read level sets. Its gradient follows the pack's
// normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pack/level_voxels.h"

namespace kelp::dump {

// In voxels. At most 0 in all solid voxels, above 0 in all empty ones. Near the surface it is close to the
// distance, and at a surface voxel its central differences point along the voxel's normal as nearly as the
// occupancy allows. It is known in bricks of 8^3 voxels; they cover everything nearer than kHalfWidth.
class SignedField {
 public:
  static constexpr float kHalfWidth = 3;

  // ToolError kRuntime if this machine has too little memory.
  explicit SignedField(const LevelVoxels& level);

  struct Brick {
    glm::ivec3 at;  // in bricks; may lie beside the level's grid
    // 512 values in the order of codes (kelp/formats/brick.h). Beyond the band: kHalfWidth, or its negative
    // inside.
    const float* values;
  };
  std::size_t bricks() const { return places_.size(); }
  Brick brick(std::size_t i) const { return {places_[i], values_.data() + i * kBrickVoxels}; }
  bool has(const glm::ivec3& brick) const { return index_.contains(keyOf(brick)); }

 private:
  struct Sample {
    glm::ivec3 voxel;
    glm::vec3 normal;
    float value;  // at the voxel's center
  };
  static std::uint64_t keyOf(const glm::ivec3& brick) {  // sides of a level are below 2^15 bricks
    return static_cast<std::uint64_t>(brick.x + 1) | static_cast<std::uint64_t>(brick.y + 1) << 20 |
           static_cast<std::uint64_t>(brick.z + 1) << 40;
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
