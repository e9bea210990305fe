// SPDX-License-Identifier: MIT
// What the surface around a hole does, in a few points.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// The edge of a hole, walked in even steps: jags and noise finer than a step are averaged away. Nothing is as
// in the mesh but the course.
struct Rim {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> beyond;  // a step from each, on the surface around
  double step = 0;                 // of the mesh's rim, from its first corner on
  // The direction in which the surface around would go on, in the mean: its part along the hole's normal
  // (above 0: out of the body) and into the hole.
  double rise = 0, inward = 0;
  // how far the rim is from a plane in the mean, as a share of the radius of a disc of the hole's size
  double unevenness = 0;
};

// `corners` of a hole and the outward `normals` of the surface around at each (any length), in the order in
// which a cap runs along them. No points if the hole has no inside worth a cap of its own: too small, or the
// rim hardly encloses anything.
Rim walkRim(std::span<const glm::dvec3> corners, std::span<const glm::dvec3> normals);

}  // namespace kelp::bake
