// SPDX-License-Identifier: MIT
// The sand, drawn as ordinary triangles.
#pragma once

#include "program.h"

namespace underwater {

// Needs the context of its creation, also when it goes.
class SeaFloor {
 public:
  explicit SeaFloor(float radius);
  ~SeaFloor();
  SeaFloor(const SeaFloor&) = delete;
  SeaFloor& operator=(const SeaFloor&) = delete;

  bool good() const { return program_ != 0; }
  void draw(GLuint sun_map) const;  // a depth texture that compares, as SunMap's

 private:
  GLuint program_ = 0, array_ = 0, buffers_[2] = {};
  GLsizei indices_ = 0;
};

}  // namespace underwater
