// SPDX-License-Identifier: MIT
#include "canvas.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include "kelp/common/error.h"
#include "kelp/common/srgb.h"

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

namespace {

// A byte is light or a plain number.
class Transfer {
 public:
  explicit Transfer(bool colors) : colors_(colors) {
    for (int i = 0; i < 256; ++i) {
      const float value = static_cast<float>(i) / 255.0f;
      table_[static_cast<std::size_t>(i)] = colors ? srgbToLinear(value) : value;
    }
  }
  float decode(std::uint8_t byte) const { return table_[byte]; }
  float decode(float value) const { return colors_ ? srgbToLinear(value) : value; }
  std::uint8_t encode(float value) const {
    const float clamped = glm::clamp(value, 0.0f, 1.0f);
    return static_cast<std::uint8_t>(std::lround(255.0f * (colors_ ? linearToSrgb(clamped) : clamped)));
  }

 private:
  bool colors_;
  std::array<float, 256> table_{};
};

}  // namespace

Picture resolve(const std::vector<std::uint8_t>& drawn, glm::ivec2 size, int samples, bool colors,
                const Background& background) {
  const Transfer transfer(colors);
  Picture picture;
  picture.size = size;
  picture.rgba.resize(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  const float share = 1.0f / static_cast<float>(samples * samples);
  for (int y = 0; y < size.y; ++y) {
    const float height = 1.0f - (static_cast<float>(y) + 0.5f) / static_cast<float>(size.y);
    const glm::vec3 behind = glm::mix(background.bottom, background.top, height);
    for (int x = 0; x < size.x; ++x) {
      glm::vec4 sum(0);  // color times coverage, coverage
      for (int sy = 0; sy < samples; ++sy) {
        for (int sx = 0; sx < samples; ++sx) {
          const auto row = static_cast<std::size_t>(samples) * static_cast<std::size_t>(size.y - 1 - y) +
                           static_cast<std::size_t>(sy);
          const std::uint8_t* from = drawn.data() + 4 * (row * static_cast<std::size_t>(samples * size.x) +
                                                         static_cast<std::size_t>(samples * x + sx));
          sum += glm::vec4(transfer.decode(from[0]), transfer.decode(from[1]), transfer.decode(from[2]),
                           static_cast<float>(from[3]) / 255.0f);
        }
      }
      std::uint8_t* out =
          picture.rgba.data() +
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x));
      const float coverage = share * sum.w;
      for (int i = 0; i < 3; ++i) {
        const float light = background.transparent
                                ? (sum.w > 0 ? sum[i] / sum.w : 0.0f)
                                : share * sum[i] + (1 - coverage) * transfer.decode(behind[i]);
        out[i] = transfer.encode(light);
      }
      out[3] = background.transparent ? static_cast<std::uint8_t>(std::lround(255.0f * coverage))
                                      : std::uint8_t{255};
    }
  }
  return picture;
}

}  // namespace kelp::render
