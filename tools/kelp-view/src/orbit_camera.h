// SPDX-License-Identifier: MIT
// A camera that turns about a point; converts between pixels and the world.
#pragma once

#include <optional>

#include "kelp/runtime/instance.h"

namespace kelp::view {

class OrbitCamera {
 public:
  // Looks at the box from so far away that all of it stays in the picture when the camera turns.
  void frame(const Box& box);
  void resize(const glm::vec2& pixels) { viewport_ = glm::max(pixels, 1.0f); }

  void orbit(const glm::vec2& pixels);  // a drag by this many pixels
  void pan(const glm::vec2& pixels);
  void zoom(float clicks);  // of the wheel; positive: closer

  glm::mat4 worldToEye() const;
  glm::mat4 eyeToClip() const;
  float toTarget() const { return distance_; }  // from the eye, world

  // Pixels are counted from the top left corner, as windows count them.
  std::optional<glm::vec2> project(const glm::vec3& world) const;  // nullopt: behind the eye
  runtime::Ray ray(const glm::vec2& pixel) const;                  // its length at the target's depth is 1
  // The point under the pixel in the plane through `through` that faces the camera.
  glm::vec3 dragTo(const glm::vec3& through, const glm::vec2& pixel) const;

 private:
  glm::vec3 eye() const;

  glm::vec3 target_{0};
  glm::vec2 viewport_{1};
  float reach_ = 1;  // radius of the model, world
  float distance_ = 4;
  float yaw_ = 0.5f, pitch_ = 0.25f;  // radians
};

}  // namespace kelp::view
