// SPDX-License-Identifier: MIT
// A small pack with cages: a comb, whose teeth are pieces of one cube, on three levels, and a block with an
// inside, whose nodes follow the other parts. Its bytes are checked in as golden/cage.kelp.
#pragma once

#include <vector>

#include "support/naive_cages.h"
#include "tiny_pack.h"

namespace kelp::test {

// The levels of a solid, with one palette index and one normal.
inline std::vector<RawLevel> levelsOf(const glm::ivec3& size, int count, const IsSolid& solid) {
  enum : std::uint8_t { kEmpty, kInner, kSurface };
  std::vector<RawLevel> levels(static_cast<std::size_t>(count));
  for (int l = 0; l < count; ++l) {
    RawLevel& level = levels[static_cast<std::size_t>(l)];
    // The solid voxels of level 0 that a voxel covers: is one of the surface?
    const auto kindOf = [&](const glm::ivec3& voxel) {
      int kind = kEmpty;
      for (int i = 0; i < 1 << (3 * l); ++i) {
        const glm::ivec3 v = voxel * (1 << l) + glm::ivec3(i, i >> l, i >> (2 * l)) % (1 << l);
        if (!solid(v)) continue;
        for (int j = 0; j < 27 && kind < kSurface; ++j)
          if (!solid(v + glm::ivec3(j % 3, j / 3 % 3, j / 9) - 1)) kind = kSurface;
        if (kind == kEmpty) kind = kInner;
      }
      return kind;
    };
    const glm::ivec3 grid = brickGrid(levelSize(size, l));
    level.cells.resize(static_cast<std::size_t>(grid.x * grid.y * grid.z));
    std::vector<glm::ivec3> bricks;
    for (int i = 0; i < grid.x * grid.y * grid.z; ++i)
      bricks.emplace_back(i % grid.x, i / grid.x % grid.y, i / grid.x / grid.y);
    std::sort(bricks.begin(), bricks.end(),
              [](const glm::ivec3& a, const glm::ivec3& b) { return mortonCode(a) < mortonCode(b); });
    for (const glm::ivec3& brick : bricks) {
      std::vector<std::uint8_t> codes;
      std::uint32_t surface = 0;
      for (int v = 0; v < kBrickVoxels; ++v) {
        if (v % 64 == 0) surface = 0;
        const int kind = kindOf(brick * 8 + glm::ivec3(v & 7, v >> 3 & 7, v >> 6));
        codes.push_back(static_cast<std::uint8_t>(kind == kSurface ? kSurfaceCode + surface++
                                                  : kind == kInner ? int{kInnerCode}
                                                                   : 0));
      }
      std::uint32_t& cell =
          level.cells[static_cast<std::size_t>(brick.x + grid.x * (brick.y + grid.y * brick.z))];
      const auto count_of = std::count_if(codes.begin(), codes.end(), isSurfaceCode);
      if (count_of == 0) {
        cell = codes[0] == kInnerCode ? kCellInside : 0;
        continue;
      }
      cell = kCellSolid | static_cast<std::uint32_t>(level.codes.size() / kBrickVoxels);
      level.codes.insert(level.codes.end(), codes.begin(), codes.end());
      level.attributes.insert(level.attributes.end(), static_cast<std::size_t>(count_of),
                              makeAttribute(0, encodeNormal({0, 1, 0})));
    }
  }
  return levels;
}

// A part with a cage.
inline RawPart makeCagedPart(const glm::ivec3& size, int levels, int cell, const IsSolid& solid) {
  RawPart part;
  part.size = size;
  part.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  part.levels = levelsOf(size, levels, solid);
  addNaiveCages(part, cell, solid);
  return part;
}

inline bool isInBox(const glm::ivec3& v, const glm::ivec3& low, const glm::ivec3& high) {
  return v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x < high.x && v.y < high.y && v.z < high.z;
}

inline bool isBlock(const glm::ivec3& v) { return isInBox(v, {0, 0, 0}, {10, 10, 10}); }

// Teeth of two voxels, two apart, on a back.
inline bool isComb(const glm::ivec3& v) {
  return isInBox(v, {0, 0, 0}, {22, 13, 3}) && (v.y < 3 || v.x % 4 < 2);
}

inline RawPack makeTinyCagePack() {
  RawPack pack = makeTinyPack();
  RawPart comb = makeCagedPart({22, 13, 3}, 3, 4, isComb), block = makeCagedPart({10, 10, 10}, 1, 2, isBlock);
  comb.name = "comb";
  comb.bend = Bend::kSweep;
  block.name = "block";
  block.parent = 2;
  addInfluences(block, 3, 4, 1);
  pack.parts.push_back(comb);
  pack.parts.push_back(block);
  return pack;
}

// Six parts: the comb has three cages, whose nodes parts 3 and 4 move as morph targets; the block has
// sections, which part 4 says. Its bytes are checked in as golden/morphs.kelp.
inline RawPack makeTinyMorphPack() {
  RawPack pack = makeTinyPack();
  RawPart comb = makeCagedPart({22, 13, 3}, 3, 4, isComb), target;
  comb.name = "comb";
  addInfluences(comb, 2, 3, 2);
  addMorphs(comb, {3, 4}, 3);
  pack.parts.push_back(comb);
  target.size = {1, 1, 1};
  target.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  for (const char* const name : {"smile", "frown"}) {
    target.name = name;
    pack.parts.push_back(target);
  }
  pack.parts.push_back(makeCagedPart({10, 10, 10}, 1, 2, isBlock));
  pack.parts.back().name = "block";
  pack.parts.back().sections = 4;
  return pack;
}

}  // namespace kelp::test
