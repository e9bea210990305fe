// SPDX-License-Identifier: MIT
// The handles that the mouse can drag: every knot, and the tip of every tangent. They lie on the spline, in
// the middle of the part.
#pragma once

#include <vector>

#include "model.h"
#include "orbit_camera.h"

namespace kelp::view {

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
std::optional<Handle> pick(const Model& model, const OrbitCamera& camera, const glm::vec2& mouse,
                           float radius);
// How far the handle must move to reach the mouse, in the plane that faces the camera: the change of the
// knot's position, or of its tangent. Voxels of the part.
glm::vec3 pullTo(const Model& model, const Handle& handle, const OrbitCamera& camera, const glm::vec2& mouse);
// Moves the handle to the mouse, from the next Model::pose() on.
void drag(Model& model, const Handle& handle, const OrbitCamera& camera, const glm::vec2& mouse);

// Where a socket is, and how it is turned; world. It need not be one of the model's pack.
glm::mat4 socketFrame(const Model& model, const RawSocket& socket);

// The spline of a part as points in the world.
std::vector<glm::vec3> splineOf(const Model& model, int part);

}  // namespace kelp::view
