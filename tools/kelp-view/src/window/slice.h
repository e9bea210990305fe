// SPDX-License-Identifier: MIT
// Distances on a slice through a point, facing the camera.
#pragma once

#include <string>

#include "kelp/gl/renderer.h"

namespace kelp::view {

class Slice {
 public:
  Slice() = default;
  ~Slice();
  Slice(const Slice&) = delete;
  Slice& operator=(const Slice&) = delete;

  // `distance` of the slice from the camera's plane. Answers an empty text, or what is wrong.
  std::string draw(gl::Renderer& renderer, const gl::View& view, const runtime::Instance& instance,
                   float distance);

 private:
  std::string build(const gl::Renderer& renderer);

  unsigned program_ = 0, vertices_ = 0;
};

}  // namespace kelp::view
