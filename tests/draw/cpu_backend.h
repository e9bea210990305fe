// SPDX-License-Identifier: MIT
// A host that draws without a graphics API: it executes draw data with the shaders compiled as C++. What it
// knows of a scene is what kelp::draw::Planner says.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/draw/planner.h"

namespace kelp::test {

// Rows from bottom to top.
struct Picture {
  explicit Picture(const glm::ivec2& size, float far_depth = 1);

  glm::ivec2 size;
  std::vector<glm::vec4> colors;
  std::vector<float> depths;
};

// A solid voxel that a pixel shows. instance -1: none.
struct Seen {
  int instance = -1, part = 0, level = 0;
  glm::ivec3 voxel{0};
  glm::vec3 normal{0};  // world

  bool operator==(const Seen&) const = default;
};

class CpuBackend {
 public:
  // fill: what the pool holds at first.
  CpuBackend(std::uint64_t pool_bytes, draw::Features features, std::uint32_t fill = 0xdeadbeefu);

  // Makes the copies of a call. Fails the test if they are not what planner.h promises.
  void copy(std::span<const draw::Copy> copies);
  // given: the scene's depth of Depth::kGiven.
  void draw(const draw::DrawData& data, draw::Pass pass, bool reversed_depth, Picture& picture,
            std::span<const float> given = {});
  // Which voxels the calls show; with a program for each kind of bend.
  std::vector<Seen> seen(const draw::DrawData& data, bool reversed_depth, const glm::ivec2& size);

  std::span<const std::uint32_t> pool() const { return pool_; }
  // How often a shader read outside of the pool, the records or the scene's depth.
  std::uint64_t readsOutside() const { return reads_outside_; }

 private:
  template <class Fragment, class Shade>
  void drawCall(const draw::DrawData& data, const draw::Call& call, std::span<const float> scene_depth,
                const glm::ivec2& size, Shade&& shade);

  draw::Features features_;
  std::vector<std::uint32_t> pool_;
  std::uint64_t reads_outside_ = 0;
};

// Makes the planner's copies.
inline void copyAll(draw::Planner& planner, CpuBackend& backend) {
  backend.copy(planner.copies());
  planner.copied();
}

}  // namespace kelp::test
