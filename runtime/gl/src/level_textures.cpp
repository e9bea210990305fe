// SPDX-License-Identifier: MIT
#include "level_textures.h"

#include <algorithm>
#include <cstring>

#include "kelp/formats/brick.h"
#include "program.h"

namespace kelp::gl {
namespace {

using namespace constant;

// Bricks of a row of the atlas: longer rows mean fewer calls, shorter ones less waste for small levels.
constexpr int kAtlasRow = 32;
constexpr int kAtlasMost = 256;  // bricks an axis: a cell has 8 bits for each

[[nodiscard]] bool reserve(Buffer<std::uint32_t>& scratch, std::size_t size) { return scratch.size() >= size || scratch.reset(size); }

int divideUp(int value, int by) { return (value + by - 1) / by; }

// The cells, with their slots replaced by places in the atlas. One z-slice at a time.
void fillCells(const Api& api, const runtime::LevelData& level, const LevelLayout& layout, std::uint32_t* scratch) {
  const auto width = static_cast<std::uint32_t>(layout.atlas.x);
  const auto height = static_cast<std::uint32_t>(layout.atlas.y);
  const std::size_t slice = static_cast<std::size_t>(layout.cells.x) * static_cast<std::size_t>(layout.cells.y);
  for (int z = 0; z < layout.cells.z; ++z) {
    const std::uint32_t* from = level.cells.data() + slice * static_cast<std::size_t>(z);
    for (std::size_t i = 0; i < slice; ++i) {
      const std::uint32_t slot = from[i] & kCellSlotMask;
      const std::uint32_t place = (slot % width) | (slot / width % height) << 8 | (slot / (width * height)) << 16;
      scratch[i] = from[i] & kCellSolid ? kCellSolid | place : from[i];
    }
    api.TexSubImage3D(kTexture3d, 0, 0, 0, z, layout.cells.x, layout.cells.y, 1, kRedInteger, kUnsignedInt, scratch);
  }
}

// Calls row(first slot, number of slots, y, z) for every row of bricks of the atlas.
template <class Row>
void forEachRow(const LevelLayout& layout, std::size_t slots, Row&& row) {
  const auto width = static_cast<std::size_t>(layout.atlas.x);
  for (std::size_t first = 0; first < slots; first += width) {
    const auto index = static_cast<int>(first / width);
    row(first, static_cast<int>(std::min(width, slots - first)), index % layout.atlas.y, index / layout.atlas.y);
  }
}

void fillCodes(const Api& api, const runtime::LevelData& level, const LevelLayout& layout, std::uint8_t* scratch) {
  forEachRow(layout, level.codes.size() / kBrickVoxels, [&](std::size_t first, int count, int y, int z) {
    const auto bricks = static_cast<std::size_t>(count);
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      for (std::size_t line = 0; line < 64; ++line) {
        std::memcpy(scratch + 8 * (line * bricks + brick), level.codes.data() + kBrickVoxels * (first + brick) + 8 * line, 8);
      }
    }
    api.TexSubImage3D(kTexture3d, 0, 0, 8 * y, 8 * z, 8 * count, 8, 8, kRedInteger, kUnsignedByte, scratch);
  });
}

void fillSliceBase(const Api& api, const runtime::LevelData& level, const LevelLayout& layout, std::uint32_t* scratch) {
  forEachRow(layout, level.slice_base.size() / 8, [&](std::size_t first, int count, int y, int z) {
    const auto bricks = static_cast<std::size_t>(count);
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      for (std::size_t slice = 0; slice < 8; ++slice) scratch[slice * bricks + brick] = level.slice_base[8 * (first + brick) + slice];
    }
    api.TexSubImage3D(kTexture3d, 0, 0, y, 8 * z, count, 1, 8, kRedInteger, kUnsignedInt, scratch);
  });
}

void fillAttributes(const Api& api, const runtime::LevelData& level, const LevelLayout& layout) {
  const auto width = static_cast<std::size_t>(layout.attribute_width);
  const auto whole = static_cast<int>(level.attributes.size() / width);
  const auto rest = static_cast<int>(level.attributes.size() % width);
  if (whole > 0) {
    api.TexSubImage2D(kTexture2d, 0, 0, 0, layout.attribute_width, whole, kRedInteger, kUnsignedInt, level.attributes.data());
  }
  if (rest > 0) {
    api.TexSubImage2D(kTexture2d, 0, 0, whole, rest, 1, kRedInteger, kUnsignedInt,
                      level.attributes.data() + width * static_cast<std::size_t>(whole));
  }
}

}  // namespace

Result<LevelLayout> layOut(const Api& api, const runtime::LevelData& level) {
  LevelLayout layout;
  layout.cells = level.grid;
  if (std::max({level.grid.x, level.grid.y, level.grid.z}) > api.max_3d_texture_size) {
    return Error{ErrorCode::kLimit, "a level has more bricks along an axis than GL_MAX_3D_TEXTURE_SIZE"};
  }

  const std::size_t slots = std::max<std::size_t>(level.codes.size() / kBrickVoxels, 1);
  const int most = std::min(api.max_3d_texture_size / kBrickSide, kAtlasMost);
  if (slots > static_cast<std::size_t>(most) * static_cast<std::size_t>(most) * static_cast<std::size_t>(most)) {
    return Error{ErrorCode::kLimit, "a level has more bricks than a 3D texture of this context holds"};
  }
  const auto count = static_cast<int>(slots);
  int row = std::min(kAtlasRow, most);
  if (divideUp(count, row * row) > most) row = most;
  layout.atlas.x = std::min(count, row);
  layout.atlas.y = std::min(divideUp(count, layout.atlas.x), row);
  layout.atlas.z = divideUp(count, layout.atlas.x * layout.atlas.y);

  const std::size_t attributes = std::max<std::size_t>(level.attributes.size(), 1);
  layout.attribute_width = 1 << attributeBits(api);
  const std::size_t rows = (attributes - 1) / static_cast<std::size_t>(layout.attribute_width) + 1;
  if (rows > static_cast<std::size_t>(api.max_texture_size)) {
    return Error{ErrorCode::kLimit, "a level has more surface voxels than a texture of this context holds"};
  }
  layout.attribute_rows = static_cast<int>(rows);

  const auto volume = [](const glm::ivec3& v) {
    return static_cast<std::uint64_t>(v.x) * static_cast<std::uint64_t>(v.y) * static_cast<std::uint64_t>(v.z);
  };
  layout.bytes = 4 * volume(layout.cells) + (kBrickVoxels + 4 * 8) * volume(layout.atlas) + 4 * rows * static_cast<std::uint64_t>(layout.attribute_width);
  return layout;
}

Name makeTexture(const Api& api, Enum target) {
  Name name = 0;
  api.GenTextures(1, &name);
  api.BindTexture(target, name);
  api.TexParameteri(target, kTextureMinFilter, kNearest);
  api.TexParameteri(target, kTextureMagFilter, kNearest);
  api.TexParameteri(target, kTextureMaxLevel, 0);
  return name;
}

Result<LevelTextures> uploadLevel(const Api& api, const runtime::LevelData& level, const LevelLayout& layout, Buffer<std::uint32_t>& scratch) {
  const std::size_t slice = static_cast<std::size_t>(layout.cells.x) * static_cast<std::size_t>(layout.cells.y);
  const std::size_t row = static_cast<std::size_t>(layout.atlas.x) * kBrickVoxels / sizeof(std::uint32_t);
  if (!reserve(scratch, std::max(slice, row))) return Error{ErrorCode::kOutOfMemory, "no memory to rearrange a level for the GPU"};

  drainErrors(api);
  const glm::ivec3 cells = layout.cells;
  const glm::ivec3 atlas = layout.atlas;
  LevelTextures textures;
  textures.size = level.size;
  textures.bytes = layout.bytes;
  textures.cells = makeTexture(api, kTexture3d);
  api.TexImage3D(kTexture3d, 0, kR32ui, cells.x, cells.y, cells.z, 0, kRedInteger, kUnsignedInt, nullptr);
  fillCells(api, level, layout, scratch.data());
  textures.codes = makeTexture(api, kTexture3d);
  api.TexImage3D(kTexture3d, 0, kR8ui, 8 * atlas.x, 8 * atlas.y, 8 * atlas.z, 0, kRedInteger, kUnsignedByte, nullptr);
  fillCodes(api, level, layout, reinterpret_cast<std::uint8_t*>(scratch.data()));
  textures.slice_base = makeTexture(api, kTexture3d);
  api.TexImage3D(kTexture3d, 0, kR32ui, atlas.x, atlas.y, 8 * atlas.z, 0, kRedInteger, kUnsignedInt, nullptr);
  fillSliceBase(api, level, layout, scratch.data());
  textures.attributes = makeTexture(api, kTexture2d);
  api.TexImage2D(kTexture2d, 0, kR32ui, layout.attribute_width, layout.attribute_rows, 0, kRedInteger, kUnsignedInt, nullptr);
  fillAttributes(api, level, layout);

  if (auto good = checkErrors(api, "OpenGL refused a level's textures"); !good) {
    deleteLevel(api, textures);
    return good.error();
  }
  return textures;
}

void deleteLevel(const Api& api, LevelTextures& textures) {
  const Name names[] = {textures.cells, textures.codes, textures.slice_base, textures.attributes};
  api.DeleteTextures(4, names);  // zeros are ignored
  textures = {};
}

std::uint64_t paletteBytes(std::span<const Material> palette) { return 3 * sizeof(glm::vec4) * palette.size(); }

Result<Name> uploadPalette(const Api& api, std::span<const Material> palette) {
  glm::vec4 texels[3][256];
  const auto count = std::min<std::size_t>(palette.size(), 256);
  for (std::size_t i = 0; i < count; ++i) {
    texels[0][i] = palette[i].base_color;
    texels[1][i] = glm::vec4(palette[i].emissive, palette[i].metallic);
    texels[2][i] = glm::vec4(palette[i].roughness, 0, 0, 0);
  }
  drainErrors(api);
  const Name name = makeTexture(api, kTexture2d);
  api.TexImage2D(kTexture2d, 0, kRgba32f, static_cast<std::int32_t>(count), 3, 0, kRgba, kFloat, nullptr);
  for (int row = 0; row < 3; ++row) {
    api.TexSubImage2D(kTexture2d, 0, 0, row, static_cast<std::int32_t>(count), 1, kRgba, kFloat, texels[row]);
  }
  if (auto good = checkErrors(api, "OpenGL refused the palette's texture"); !good) {
    api.DeleteTextures(1, &name);
    return good.error();
  }
  return name;
}

}  // namespace kelp::gl
