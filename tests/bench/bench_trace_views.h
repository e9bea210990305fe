// SPDX-License-Identifier: MIT
// Poses, cameras and rays. Rays are data, made once in double precision and rounded to float32, so that every
// method on the GPU, the C++ build of trace.glsl and the ground truth get the same bits.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "bench_trace_scenes.h"
#include "kelp/formats/sweep.h"

namespace kelp::bench {

struct Pose {
  std::string name;
  bool moderate = false;                 // Figure 6 a and b, and the sines of Table 1
  std::vector<std::vector<Knot>> knots;  // of each item: two, or of a swept one any number
  float roll = 0;                        // of swept items
};

// As the scene asks for: Figure 6, moments of tangents that swing as sines; or bent by angles.
std::vector<Pose> makePoses(const Scene& scene);

struct PosedItem {
  const Item* item = nullptr;
  std::vector<Knot> knots;
  Segment segment;                                        // of a sheared item
  std::shared_ptr<const ArcChain> chain;                  // of a swept one
  Box bounds;                                             // deformed, part space
  std::function<glm::dvec3(const glm::dvec3& rest)> map;  // of a caged one, instead
};
std::vector<PosedItem> poseItems(const Scene& scene, const Pose& pose);

// The rays of one view through one item, part space, row by row from the bottom.
struct Rays {
  std::vector<glm::vec4> origin;  // where the ray enters the bounds; w: how far it may go
  // w: distance from the eye to the origin, -1 where the ray misses the bounds
  std::vector<glm::vec4> direction;
};

struct View {
  std::string name;
  glm::ivec2 size{0};
  std::vector<Rays> rays;  // one for each item
  double far = 1;          // nothing is further from the eye
};

std::vector<std::string> viewNames();
View makeView(const std::string& name, const std::vector<PosedItem>& items, const glm::ivec2& size);

}  // namespace kelp::bench
