// SPDX-License-Identifier: MIT
// The sun's shadow map: what falls on the sand, and on one plant from another.
#pragma once

#include <glm/glm.hpp>

#include "program.h"

namespace underwater {

// A depth texture that the scene is drawn into from the sun. Needs the context of its creation, also when it
// goes.
class SunMap {
 public:
  explicit SunMap(int size);  // pixels on a side
  ~SunMap();
  SunMap(const SunMap&) = delete;
  SunMap& operator=(const SunMap&) = delete;

  void begin() const;  // binds and clears it, with its viewport
  GLuint texture() const { return texture_; }
  int size() const { return size_; }

  // The sun's camera: all that grows within `radius` meters of the origin and up to `height`.
  static glm::mat4 worldToSun(const glm::vec3& sun);
  static glm::mat4 sunToClip(float radius, float height);

 private:
  int size_;
  GLuint texture_ = 0, framebuffer_ = 0;
};

}  // namespace underwater
