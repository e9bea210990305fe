// SPDX-License-Identifier: MIT
// What the mouse can take hold of: every knot, and the tip of every tangent. They stand in the middle of the part, where the
// spline is.
#pragma once

#include <vector>

#include "model.h"
#include "orbit_camera.h"

namespace viewer {

struct Handle {
  enum class Kind { kKnot, kTangent };
  int part = 0;
  int knot = 0;
  Kind kind = Kind::kKnot;

  bool operator==(const Handle&) const = default;
};

// All handles of a model, part by part and knot by knot.
std::vector<Handle> handlesOf(const Model& model);
glm::vec3 position(const Model& model, const Handle& handle);  // world

// The handle within `radius` pixels of the mouse; the nearest, if there are several.
std::optional<Handle> pick(const Model& model, const OrbitCamera& camera, const glm::vec2& mouse, float radius);
// How far the handle must go to be where the mouse is, in the plane that faces the camera: of a knot's position, or of its tangent; voxels.
glm::vec3 pullTo(const Model& model, const Handle& handle, const OrbitCamera& camera, const glm::vec2& mouse);
// Moves it there. Takes effect with the next Model::pose().
void drag(Model& model, const Handle& handle, const OrbitCamera& camera, const glm::vec2& mouse);

// The spline of a part as points in the world.
std::vector<glm::vec3> splineOf(const Model& model, int part);

}  // namespace viewer
