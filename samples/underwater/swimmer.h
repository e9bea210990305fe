// SPDX-License-Identifier: MIT
// A fish on its way: the spline of its body lies on the lane that it swims along, and the strokes of its tail
// come on top.
#pragma once

#include "kelp/runtime/instance.h"
#include "path.h"

namespace underwater {

// A model that swims: which of its directions is which. Its spline's axis runs from head to tail, and +y of
// the object is up.
struct Anatomy {
  glm::mat4 voxel_to_object{1};
  glm::mat3 object_to_swim{1};  // forward -> +x, up -> +y
  glm::vec3 size{0};            // voxels
  float length = 0;             // head to tail, object units
  float radius = 0;             // half of how tall it is, fins included; object units
  static Anatomy of(const kelp::Part& part);
};

// Where a fish of that anatomy is when its head is `head` meters along the lane: its middle on the lane, its
// axis along the lane's direction there, leaning into the turn by `bank` radians.
glm::mat4 swimFrame(const Anatomy& anatomy, const Lane& lane, float head, float scale, float bank);

// Puts the knots onto the lane: each as far behind the head as it belongs to, with the lane's direction for a
// tangent. `to_world` is swimFrame's. Splines bend this way up to where the body turns by a right angle;
// Pose::clamp sees to the rest.
void layOnLane(const Anatomy& anatomy, const glm::mat4& to_world, const Lane& lane, float head, float scale,
               std::span<kelp::Knot> knots);

}  // namespace underwater
