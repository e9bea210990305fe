// SPDX-License-Identifier: MIT
#include "window/part_paint.h"

#define GL_GLEXT_PROTOTYPES
#define GLFW_INCLUDE_GLCOREARB
#include <GLFW/glfw3.h>

#include <utility>

#include "kelp/common/part_colors.h"

namespace kelp::view {

PartPaint::~PartPaint() {
  if (name_ != 0) glDeleteTextures(1, &name_);
}

void PartPaint::attach(std::vector<glm::u8vec3> colors, gl::View& view) {
  if (colors_.empty() || colors_[0] != colors) {
    colors_ = {std::move(colors)};
    const PartTexels texels(colors_);
    rows_ = texels.rows;
    if (name_ == 0) glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, texels.size.x, texels.size.y, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, texels.texels.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glBindTexture(GL_TEXTURE_2D, 0);
  }
  view.bind_user = this;
  view.bind = [](void* user, std::uint32_t program) {
    const auto& self = *static_cast<const PartPaint*>(user);
    glUniform1i(glGetUniformLocation(program, "part_rows"), self.rows_);
    glUniform1i(glGetUniformLocation(program, "part_colors"), gl::kFirstHostUnit);
    glActiveTexture(GL_TEXTURE0 + gl::kFirstHostUnit);
    glBindTexture(GL_TEXTURE_2D, self.name_);
  };
}

}  // namespace kelp::view
