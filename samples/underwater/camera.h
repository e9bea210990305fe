// SPDX-License-Identifier: MIT
// The camera. It circles in the glade until the user takes over.
#pragma once

#include <glm/glm.hpp>

#include "kelp/runtime/instance.h"

namespace underwater {

class Camera {
 public:
  // Circles: where it is `seconds` into the scene.
  void circle(double seconds);
  bool circling() const { return circling_; }
  void release() { circling_ = true; }

  // The user's: from where it is. Turns by radians; swims at `wish` meters a second (right, up, forward) for
  // some seconds. It keeps off the sand, below the surface and not far from the reef.
  void look(const glm::vec2& turn);
  void swim(const glm::vec3& wish, float seconds);

  const glm::vec3& at() const { return at_; }
  glm::vec3 forward() const;  // unit
  glm::mat4 worldToEye() const;
  static glm::mat4 eyeToClip(const glm::ivec2& viewport);

 private:
  bool circling_ = true;
  glm::vec3 at_{0, 1, 4}, velocity_{0};  // meters, meters a second
  float yaw_ = 0, pitch_ = 0;            // radians: about +y from -z to -x, up
};

}  // namespace underwater
