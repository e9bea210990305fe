// SPDX-License-Identifier: MIT
// The depth drawn so far, copied from the bound framebuffer into a texture of kelp's, so that the next draw
// can end its rays there.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "gl_api.h"

namespace kelp::gl {

class DepthCopy {
 public:
  void create(const Api& api);
  void destroy(const Api& api);
  Name texture() const { return texture_; }

  // Examines the framebuffer that is bound for drawing, and allocates a texture of its viewport's size. It is
  // allocated again only for a larger viewport or another format. False: the depth cannot be copied, because
  // there is none, it is multisampled, or the driver refuses. Within an UploadGuard.
  bool prepare(const Api& api);
  // Call it after prepare(), with the same framebuffer. The framebuffer bindings stay as they were. The
  // host's scissor test applies to the copy as to the draw.
  void copy(const Api& api) const;

 private:
  // A depth buffer, as OpenGL describes it.
  struct Source {
    std::int32_t framebuffer = 0;
    std::int32_t type = 0;  // of the attached object, and its name
    std::int32_t object = 0;
    std::int32_t bits = 0;
    std::int32_t stencil = 0;
    std::int32_t kind = 0;  // fixed or floating point
    bool operator==(const Source&) const = default;
  };
  struct Format;
  static const Format kFormats[6];

  static Source sourceOf(const Api& api, std::int32_t framebuffer);
  bool allocate(const Api& api, const glm::ivec2& size, const Format& format);
  bool works(const Api& api) const;

  Name texture_ = 0;
  Name framebuffer_ = 0;
  glm::ivec2 size_{0};      // 0: no storage yet
  Source source_;           // that was tried last
  bool good_ = false;       // and whether its depth can be copied
  glm::ivec4 viewport_{0};  // x, y, width, height
  std::int32_t read_ = 0;   // the host's binding
};

}  // namespace kelp::gl
