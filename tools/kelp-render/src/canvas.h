// SPDX-License-Identifier: MIT
// The framebuffer that is drawn into and read back.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace kelp::render {

class Canvas {
 public:
  // Bound from here on, viewport set. `colors`: what is written is linear colour and is stored as sRGB. RenderError (kFailure) if the
  // context has no framebuffer of that size.
  Canvas(glm::ivec2 size, bool colors, bool es);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void clear() const;
  // RGBA, rows from bottom to top.
  const std::vector<std::uint8_t>& read();

 private:
  glm::ivec2 size_;
  unsigned framebuffer_ = 0;
  unsigned buffers_[2] = {};
  std::vector<std::uint8_t> pixels_;
};

}  // namespace kelp::render
