// SPDX-License-Identifier: MIT
// Textures in linear light, filtered over the footprint of a voxel.
#pragma once

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// An image with its box-filtered mipmap. Keeps a reference to the image, which must outlive it.
class TexturePyramid {
 public:
  explicit TexturePyramid(const Image& image);

  // Linear RGBA at (u, v), in texture widths and heights. Interpolates between the two levels around `lod` (0
  // or less: the image itself, 1: half its size, ...). Colors are weighted by alpha, so transparent texels
  // do not bleed.
  glm::vec4 sample(glm::vec2 uv, float lod, Wrap wrap_u, Wrap wrap_v, bool nearest) const;

 private:
  struct Level {
    int width, height;
    std::vector<glm::vec4> texels;
  };

  glm::vec4 sampleLevel(glm::vec2 uv, std::size_t level, Wrap wrap_u, Wrap wrap_v, bool nearest) const;
  glm::ivec2 levelSize(std::size_t level) const;
  glm::vec4 texel(std::size_t level, int x, int y) const;

  const Image& image_;
  std::vector<Level> reduced_;  // from half the size down; level 0 stays in bytes
};

}  // namespace kelp::bake
