// SPDX-License-Identifier: MIT
#include "count_target.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <glm/common.hpp>

#include "kelp/common/error.h"

namespace kelp::render {

CountTarget::CountTarget(glm::ivec2 size) : size_(size) {
  glGenFramebuffers(1, &framebuffer_);
  glGenRenderbuffers(1, &buffer_);
  glBindRenderbuffer(GL_RENDERBUFFER, buffer_);
  // Four channels, because OpenGL ES 3.0 reads back no other number of integers.
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32UI, size.x, size.y);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffer_);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR)
    throw ToolError(Exit::kRuntime, "OpenGL gives no framebuffer to count steps in; lower --size");
}

CountTarget::~CountTarget() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(1, &buffer_);
}

void CountTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size_.x, size_.y);
  glDisable(GL_DEPTH_TEST);
}

void CountTarget::clear() const {
  const GLuint zero[4] = {};
  glClearBufferuiv(GL_COLOR, 0, zero);
}

StepCount CountTarget::read(const glm::vec4& rectangle) {
  const glm::vec2 half = 0.5f * glm::vec2(size_);
  const glm::vec2 from = glm::floor(half * (1.0f + glm::vec2(rectangle.x, rectangle.y)));
  const glm::vec2 to = glm::ceil(half * (1.0f + glm::vec2(rectangle.z, rectangle.w)));
  const glm::ivec2 low = glm::clamp(glm::ivec2(from), glm::ivec2(0), size_);
  const glm::ivec2 extent = glm::clamp(glm::ivec2(to), low, size_) - low;
  if (extent.x == 0 || extent.y == 0) return {};
  pixels_.resize(4 * static_cast<std::size_t>(extent.x) * static_cast<std::size_t>(extent.y));
  glReadPixels(low.x, low.y, extent.x, extent.y, GL_RGBA_INTEGER, GL_UNSIGNED_INT, pixels_.data());
  StepCount sum;
  for (std::size_t i = 0; i < pixels_.size(); i += 4) {
    sum.steps += pixels_[i];
    sum.rays += pixels_[i + 1];
  }
  return sum;
}

}  // namespace kelp::render
