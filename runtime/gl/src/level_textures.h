// SPDX-License-Identifier: MIT
// One level of one part as textures. The layout is chosen for the GPU, not the file's: bricks lie in a 3D atlas, and a cell holds its
// brick's place there, 8 bits an axis, so that a shader divides by nothing.
#pragma once

#include "gl_api.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/model.h"
#include "kelp/runtime/asset.h"

namespace kelp::gl {

struct LevelTextures {
  Name cells = 0;
  Name codes = 0;
  Name slice_base = 0;
  Name attributes = 0;
  std::uint64_t bytes = 0;
  glm::ivec3 size{0};  // voxels

  bool uploaded() const { return cells != 0; }
};

// How a level is laid out in this context.
struct LevelLayout {
  glm::ivec3 cells{0};       // texels
  glm::ivec3 atlas{0};       // bricks; slot n is the n-th, x fastest
  int attribute_width = 0;
  int attribute_rows = 0;
  std::uint64_t bytes = 0;
};

// kLimit, with the part that does not fit, if the context's textures are too small.
Result<LevelLayout> layOut(const Api& api, const runtime::LevelData& level);

// Makes and fills the textures. `scratch` is reused and grows. Within an UploadGuard. On an error nothing is left behind.
Result<LevelTextures> uploadLevel(const Api& api, const runtime::LevelData& level, const LevelLayout& layout, Buffer<std::uint32_t>& scratch);

void deleteLevel(const Api& api, LevelTextures& textures);

// The palette, 3 texels an entry: instance.glsl. Within an UploadGuard.
Result<Name> uploadPalette(const Api& api, std::span<const Material> palette);
std::uint64_t paletteBytes(std::span<const Material> palette);

// Makes a texture of `target` that is sampled with texelFetch alone, and binds it to the active unit.
Name makeTexture(const Api& api, Enum target);

}  // namespace kelp::gl
