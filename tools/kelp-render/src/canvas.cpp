// SPDX-License-Identifier: MIT
#include "canvas.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>

#include <fmt/format.h>

#include "kelp/common/error.h"

namespace kelp::render {

Canvas::Canvas(glm::ivec2 size, bool colors, bool es) : size_(size) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
  if (std::max(size.x, size.y) > most) {
    throw ToolError(Exit::kRuntime,
                    fmt::format("{} x {} samples are too many: OpenGL draws at most {} along a "
                                "side here; lower --size or --samples",
                                size.x, size.y, most));
  }
  glGenFramebuffers(1, &framebuffer_);
  glGenRenderbuffers(2, buffers_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers_[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, colors ? GL_SRGB8_ALPHA8 : GL_RGBA8, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers_[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, size.x, size.y);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR) {
    throw ToolError(Exit::kRuntime,
                    fmt::format("OpenGL gives no framebuffer of {} x {} samples; lower --size or --samples",
                                size.x, size.y));
  }
  if (colors && !es) glEnable(GL_FRAMEBUFFER_SRGB);  // OpenGL ES always encodes
  bind();
  pixels_.resize(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
}

Canvas::~Canvas() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(2, buffers_);
}

void Canvas::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size_.x, size_.y);
}

void Canvas::clear() const {
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Canvas::restrict(bool one_pixel) const {
  if (one_pixel) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 1, 1);
  } else {
    glDisable(GL_SCISSOR_TEST);
  }
}

void Canvas::finish() const { glFinish(); }

const std::vector<std::uint8_t>& Canvas::read() {
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  return pixels_;
}

}  // namespace kelp::render
