// SPDX-License-Identifier: MIT
// The smallest pack that has something of everything. Its bytes are checked in as golden/solid.kelp: never
// change it.
#pragma once

#include "kelp/formats/raw_pack.h"

namespace kelp::test {

// A brick: one surface voxel, the rest empty.
inline void addTinyBrick(RawLevel& level, int voxel, std::uint8_t palette_index, const glm::vec3& normal) {
  level.codes.resize(level.codes.size() + kBrickVoxels);
  level.codes[level.codes.size() - kBrickVoxels + static_cast<std::size_t>(voxel)] = kSurfaceCode;
  level.attributes.push_back(makeAttribute(palette_index, encodeNormal(normal)));
}
// The same with all that touches the voxel (1, 1, 1), which is inner.
inline void addTinyCube(RawLevel& level, std::uint8_t palette_index, const glm::vec3& normal) {
  level.codes.resize(level.codes.size() + kBrickVoxels);
  std::uint8_t* const codes = level.codes.data() + level.codes.size() - kBrickVoxels;
  for (int i = 0; i < 27; ++i) {
    const int rank = i % 9 - (i > 13 && i < 18 ? 1 : 0);
    const bool inner = i == 13;
    codes[i % 3 + 8 * (i / 3 % 3) + 64 * (i / 9)] =
        static_cast<std::uint8_t>(inner ? int{kInnerCode} : kSurfaceCode + rank);
    if (!inner) level.attributes.push_back(makeAttribute(palette_index, encodeNormal(normal)));
  }
}

inline RawPack makeTinyPack() {
  RawPack pack;
  pack.info_json = R"({"tool":"kelp tiny"})";
  pack.palette.resize(2);
  pack.palette[0] = {{0.25f, 0.5f, 0.125f, 1.0f}, {0, 0, 0}, 0.0f, 0.75f};
  pack.palette[1] = {{1.0f, 0.0f, 0.0f, 0.5f}, {0, 2.5f, 0}, 1.0f, 0.0f};

  RawPart stem;
  stem.name = "stem";
  stem.size = {8, 24, 8};
  stem.to_object[3] = {-4, 0, -4};
  stem.knots = {{0, {0, 0, 0}, {0.125f, 0, 0.5f}},
                {0.5f, {0.25f, 0.5f, 0}, {0, 1, 0}},
                {1, {0, 1, 0}, {0.125f, 0, 0.25f}}};
  stem.automatic_tangents = 2;
  stem.levels.resize(2);
  stem.levels[0].cells = {kCellSolid | 0, 7u << kCellClearanceShift, kCellSolid | 1};
  addTinyCube(stem.levels[0], 0, {0, -1, 0});
  addTinyBrick(stem.levels[0], 511 - 7, 1, {0.6f, 0.8f, 0});
  stem.levels[1].cells = {kCellSolid | 0, kCellSolid | 1};  // 4 x 12 x 4 voxels
  stem.levels[1].codes.resize(kBrickVoxels);
  for (int i = 0; i < 8; ++i) {
    stem.levels[1].codes[static_cast<std::size_t>(i % 2 + 8 * (i / 2 % 2) + 64 * (i / 4))] =
        static_cast<std::uint8_t>(kSurfaceCode + i % 4);
    stem.levels[1].attributes.push_back(makeAttribute(0, encodeNormal({0, -1, 0})));
  }
  addTinyBrick(stem.levels[1], 8 * 3 + 64 * 3, 1, {0.6f, 0.8f, 0});

  RawPart leaf;
  leaf.name = "Bl\xc3\xa4tt";
  leaf.parent = 0;
  leaf.parent_at = 0.75f;
  leaf.bend = Bend::kSweep;
  leaf.roll = -0.5f;
  leaf.size = {2, 1, 1};
  leaf.pivot[3] = {1, 2, 3};
  leaf.knots.resize(2);
  leaf.knots[1] = {1, {0, 1, 0}, {0, 1, 0}};
  leaf.knots[0].tangent = {0, 1, 0};
  leaf.levels.resize(1);
  leaf.levels[0].cells = {kCellSolid};
  addTinyBrick(leaf.levels[0], 0, 1, {0, 0, -1});
  pack.parts = {stem, leaf};

  RawClip sway;
  sway.name = "sway";
  sway.duration = 3.5f;
  sway.waves = {{0, 2, Target::kKnotOffset, {0.5f, 0, -0.25f}, 3.5f, 0.125f}};
  RawTrack turn;
  turn.part = 1;
  turn.target = Target::kPartRotation;
  turn.interpolation = Interpolation::kLinear;
  turn.keys = {{0, {0, 0, 0, 1}, glm::vec4(0.0f), glm::vec4(0.0f)},
               {1.5f, {0, 0.6f, 0, 0.8f}, glm::vec4(0.0f), glm::vec4(0.0f)}};
  RawTrack bend;
  bend.part = 0;
  bend.knot = 1;
  bend.target = Target::kKnotTangent;
  bend.interpolation = Interpolation::kCubic;
  bend.keys = {{0.5f, {1, 0, 2, 0}, {0.5f, 0, 0, 0}, {-0.5f, 0, 0, 0}}};
  sway.tracks = {turn, bend};
  pack.clips = {sway};
  pack.sockets = {{"tip", 0, 0.875f, {0.125f, -0.0625f}, glm::quat(0.8f, 0, 0.6f, 0)},
                  {"Bl\xc3\xbcte", 1, 0, {0, 0.5f}, {1, 0, 0, 0}}};
  return pack;
}

// A pack of which the first part and the last are empty. Its bytes are checked in as golden/empty.kelp.
inline RawPack makeTinyEmptyPack() {
  RawPack pack = makeTinyPack();
  RawPart root;
  root.name = "root";
  root.size = {3, 40, 5};
  root.to_object[3] = {-1, 0, -2};
  root.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  RawPart tip = root;
  tip.name = "tip";
  tip.parent = 2;
  tip.parent_at = 1;
  root.knots.insert(root.knots.begin() + 1, {0.5f, {0.25f, 0.5f, 0}, {0, 1, 0}});
  pack.parts.insert(pack.parts.begin(), root);
  pack.parts[1].parent = 0;
  pack.parts[2].parent = 1;
  pack.parts.push_back(tip);
  pack.clips[0].waves[0] = {0, 1, Target::kKnotOffset, {0.5f, 0, -0.25f}, 3.5f, 0.125f};
  pack.clips[0].tracks[0].part = 3;
  pack.clips[0].tracks[1].part = 1;
  pack.sockets[0].part = 3;
  pack.sockets[1].part = 0;
  return pack;
}

// A pack with joints, two of one name. Its bytes are checked in as golden/joints.kelp.
inline RawPack makeTinyJointPack() {
  RawPack pack = makeTinyPack();
  RawJoint root{"root", -1, glm::mat4x3(1), {}}, bone{
                                                     "H\xc3\xbc"
                                                     "fte",
                                                     0,
                                                     glm::mat4x3(1),
                                                     {0, 1}};
  root.inverse_bind[3] = {0.5f, -2, 0.25f};
  bone.inverse_bind = {{0, 0, -2}, {0, 2, 0}, {2, 0, 0}, {-1, -3, 0.125f}};
  RawJoint again = bone;
  again.parent = 1;
  again.inverse_bind[3].x = 4;
  again.parts = {1};
  pack.joints = {root, bone, again};
  return pack;
}

}  // namespace kelp::test
