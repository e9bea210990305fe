// SPDX-License-Identifier: MIT
// The smallest pack that has something of everything that fog has, and a solid part. Its bytes are checked in
// as golden/fog.kelp: never change it.
#pragma once

#include "fog_level.h"
#include "tiny_pack.h"

namespace kelp::test {

// Metadata, then the levels: smoke 1; stone 0, smoke 0, flame 0.
inline RawPack makeTinyFogPack() {
  RawPack pack;
  pack.info_json = R"({"tool":"kelp tiny fog"})";
  pack.palette.resize(1);
  pack.palette[0].base_color = {0.25f, 0.5f, 0.125f, 1.0f};

  RawPart stone;
  stone.name = "stone";
  stone.size = {2, 1, 1};
  stone.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  stone.levels.resize(1);
  stone.levels[0].cells = {kCellSolid};
  addTinyBrick(stone.levels[0], 0, 0, {0, 0, -1});

  RawPart smoke;
  smoke.name = "smoke";
  smoke.parent = 0;
  smoke.size = {26, 12, 9};
  smoke.to_object[3] = {-13, 0, -4.5f};
  smoke.knots = {{0, {0, 0, 0}, {0.25f, 0.75f, 0.125f}}, {1, {0.125f, 1, 0}, {0, 1, 0}}};
  smoke.fog = RawFog{{0.75f, 0.5f, 0.25f}, -0.5f, 0, {}};
  // The third of four bricks along x is clear, and its neighbors are where they share samples with it.
  smoke.levels = {fogLevel(smoke.size, 0.125f,
                           [](const glm::ivec3& v) {
                             return static_cast<std::uint8_t>(v.x < 16
                                                                  ? (v.x * 7 + v.y * 3 + v.z * 11) % 16 * 16
                                                              : v.x > 24 ? 255
                                                                         : 0);
                           }),
                  fogLevel({13, 6, 5}, 0.0625f, [](const glm::ivec3& v) {
                    return static_cast<std::uint8_t>(v.x < 8 ? 255 - v.y : v.x == 12 ? 1 : 0);
                  })};

  RawPart flame;
  flame.name = "flame";
  flame.size = {1, 9, 2};
  flame.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  flame.fog = RawFog{{0, 1, 0}, 0.875f, 2.5f, {{1, 0.25f, 0}, {4, 3, 2}}};
  // There is heat without density, and density without heat.
  flame.levels = {fogLevel(
      flame.size, 3.0f,
      [](const glm::ivec3& v) { return static_cast<std::uint8_t>(v.z == 0 ? 30 * v.y : 0); },
      [](const glm::ivec3& v) { return static_cast<std::uint8_t>(v.z == 1 ? 255 - 30 * v.y : 0); })};
  pack.parts = {stone, smoke, flame};
  return pack;
}

}  // namespace kelp::test
