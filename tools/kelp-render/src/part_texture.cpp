// SPDX-License-Identifier: MIT
#include "part_texture.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <vector>

#include "kelp/common/error.h"
#include "kelp/common/part_colors.h"
#include "kelp/common/skin_info.h"

namespace kelp::render {
namespace {

std::vector<glm::u8vec3> colorsOf(const Pack& pack, bool fit) {
  std::vector<glm::u8vec3> colors;
  for (const PartSkin& part : skinOf(pack)) {
    const int index = static_cast<int>(colors.size());
    const auto p95 = part.fit ? std::optional(part.fit->p95) : std::nullopt;
    colors.push_back(fit ? fitColor(p95) : partColor(index));
  }
  return colors;
}

}  // namespace

PartTexture::PartTexture(std::span<const runtime::Instance> instances, bool fit) {
  std::vector<std::vector<glm::u8vec3>> colors;
  for (const runtime::Instance& instance : instances) colors.push_back(colorsOf(instance.asset->pack(), fit));
  const PartTexels texels(colors);
  rows_ = texels.rows;
  while (glGetError() != GL_NO_ERROR) {
  }
  glGenTextures(1, &name_);
  glBindTexture(GL_TEXTURE_2D, name_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, texels.size.x, texels.size.y, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               texels.texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (glGetError() != GL_NO_ERROR) {
    glDeleteTextures(1, &name_);
    throw ToolError(Exit::kRuntime,
                    "OpenGL gives no texture for the colours of so many parts; leave some of --and out");
  }
}

PartTexture::~PartTexture() { glDeleteTextures(1, &name_); }

void PartTexture::attach(gl::View& view) const {
  view.bind_user = const_cast<PartTexture*>(this);
  view.bind = [](void* user, std::uint32_t program) {
    const auto& self = *static_cast<const PartTexture*>(user);
    glUniform1i(glGetUniformLocation(program, "part_rows"), self.rows_);
    glUniform1i(glGetUniformLocation(program, "part_colors"), gl::kFirstHostUnit);
    glActiveTexture(GL_TEXTURE0 + gl::kFirstHostUnit);
    glBindTexture(GL_TEXTURE_2D, self.name_);
  };
}

}  // namespace kelp::render
