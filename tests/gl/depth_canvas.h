// SPDX-License-Identifier: MIT
// A framebuffer whose depth can be read, exactly and with OpenGL ES too: ES reads no depth buffer, but it
// samples one.
#pragma once

#include "canvas.h"

namespace kelp::test {

// RGBA8 and a depth texture of the format given, bound while it lives. Rows from bottom to top.
class DepthCanvas {
 public:
  DepthCanvas(GlApi api, glm::ivec2 size, GLenum depth_format);
  ~DepthCanvas();
  DepthCanvas(const DepthCanvas&) = delete;
  DepthCanvas& operator=(const DepthCanvas&) = delete;

  glm::ivec2 size() const { return size_; }
  void clear() const;  // to zero, depth 1
  std::vector<Pixel> pixels() const;
  std::vector<float> depths() const;  // to the bit

 private:
  glm::ivec2 size_;
  GLuint color_ = 0, depth_ = 0, framebuffer_ = 0;
  GLuint bits_ = 0, bits_framebuffer_ = 0;  // the depths as unsigned integers
  GLuint program_ = 0, vertex_array_ = 0;
};

// A program from the bodies of a vertex and a fragment shader, which have no version. Fails the test, with
// the compiler's words, and answers 0, if it does not compile or link.
GLuint makeProgram(GlApi api, const std::string& vertex, const std::string& fragment);

}  // namespace kelp::test
