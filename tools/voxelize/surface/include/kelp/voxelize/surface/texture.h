// SPDX-License-Identifier: MIT
// Textures as the surface samples them: linear light, filtered over the footprint of a voxel.
#pragma once

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// An image with its box-filtered reductions. Refers to the image, which must outlive it.
class TexturePyramid {
 public:
  explicit TexturePyramid(const Image& image);

  // Colours are weighted by alpha, since what is transparent has none to give.
  // Linear RGBA at (u, v), in texture widths and heights, mixed of the two reductions around `lod` (0 and
  // less: the image itself, 1: half its size ...).
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
  std::vector<Level> reduced_;  // from half the size on: the image itself stays in bytes
};

}  // namespace kelp::bake
