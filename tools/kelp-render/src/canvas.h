// SPDX-License-Identifier: MIT
// The framebuffer that is drawn into and read back, and the way from its samples to the pixels of a file.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "options.h"

namespace kelp::render {

class Canvas {
 public:
  // Binds itself and sets the viewport. `colors`: linear color is written, and stored as sRGB.
  // ToolError kRuntime if the context has no framebuffer of that size.
  Canvas(glm::ivec2 size, bool colors, bool es);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  // Binds itself again and sets the viewport.
  void bind() const;
  void clear() const;
  // Only one pixel is drawn from here on, or all of them again.
  void restrict(bool one_pixel) const;
  // Waits until OpenGL has drawn everything.
  void finish() const;
  // RGBA, rows from bottom to top.
  const std::vector<std::uint8_t>& read();

 private:
  glm::ivec2 size_;
  unsigned framebuffer_ = 0;
  unsigned buffers_[2] = {};
  std::vector<std::uint8_t> pixels_;
};

// RGBA, 8 bits each, rows from top to bottom.
struct Picture {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgba;
};

// `drawn`: `samples` * `samples` values for each pixel, RGBA, premultiplied, rows from bottom to top; alpha 0
// where nothing was drawn. `colors`: the values are sRGB colors and are averaged as light; else plain
// numbers. With a transparent background alpha is the coverage.
Picture resolve(const std::vector<std::uint8_t>& drawn, glm::ivec2 size, int samples, bool colors,
                const Background& background);

}  // namespace kelp::render
