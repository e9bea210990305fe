// SPDX-License-Identifier: MIT
// Morph targets whose offsets are known in closed form; keys of their weights.
#include "morphs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "kelp/formats/cage.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

// Adds a target to a shape: from(position of a vertex) in meters.
template <class From>
void addMorph(test::SkinnedShape& shape, const std::string& name, const From& from) {
  SourceSkin::Morph& morph = shape.skin().morphs.emplace_back();
  morph.name = name;
  for (std::uint32_t v = 0; v < shape.soup().positions.size(); ++v) {
    morph.vertices.push_back(v);
    morph.offsets.push_back(from(shape.soup().positions[v]));
  }
}

glm::vec3 lean(const glm::vec3& at) { return {0.1f * at.y, 0, 0.02f * at.y + 0.3f}; }

// Interpolation in tetrahedra is exact for what is linear.
TEST(MorphNodes, HaveOffsetsThatAreLinear) {
  test::SkinnedShape shape = test::tube(2);
  addMorph(shape, "lean", lean);
  const SkinCage made = shape.cage(0, 2);
  EXPECT_EQ(made.cell, 16);
  ASSERT_EQ(made.morphs.size(), 1u);
  const RawMorph& moves = made.morphs[0].moves;
  EXPECT_LT(made.morphs[0].fit.distances.max, 0.2);
  CageMemory memory;
  const Cage cage =
      *makeCage(made.cages[0].source(), shape.whole.size, 5, made.cell, 0, nullptr, 1u << 30, memory);
  ASSERT_EQ(moves.nodes.size(), cage.nodes());
  for (std::size_t i = 0; i < moves.nodes.size(); ++i) {
    const glm::dvec3 rest(cage.rest(moves.nodes[i]));
    const glm::vec3 from(glm::inverse(shape.frame.node_to_voxel) * glm::dvec4(rest, 1));
    const glm::dvec3 wanted = glm::dvec3(lean(from)) / shape.frame.voxel_size,
                     found = static_cast<double>(moves.step) * glm::dvec3(moves.offsets[i]);
    ASSERT_LT(glm::distance(found, wanted), 0.7) << rest.y;
  }
  const SkinCage again = shape.cage(0, 1);
  EXPECT_EQ(again.morphs[0].moves.offsets, moves.offsets);
}

// Cells are as large as the morph targets allow, too.
TEST(MorphNodes, WhatIsSmallNeedsSmallCells) {
  test::SkinnedShape shape = test::tube(1, 129, 48);
  EXPECT_EQ(shape.cage(0).cell, 16);
  addMorph(shape, "knob", [](const glm::vec3& at) {
    const float y = (at.y - 6) / 0.6f;
    return glm::vec3(at.x, 0, at.z) * (std::abs(y) < 1 ? 0.5f * (1 - y * y) : 0.0f);
  });
  const SkinCage made = shape.cage(0);
  EXPECT_LT(made.cell, 16);
  EXPECT_LE(made.morphs[0].fit.distances.mean, 0.3);
  EXPECT_GT(shape.cage(16).morphs[0].fit.distances.mean, 0.3);
}

// Where no target moves anything, all keeps still: the nodes of a box that stands apart are not named.
TEST(MorphNodes, OthersAreLeftOut) {
  test::SkinnedShape shape;
  shape.addJoint(-1, {0, 0, 0});
  shape.addBox({0, 0, 0}, {1, 4, 1}, 0);
  shape.addBox({3, 0, 0}, {4, 4, 1}, 0);
  shape.finish(64);
  addMorph(shape, "first", [](const glm::vec3& at) { return glm::vec3(0, 0, at.x < 2 ? 0.5f : 0.0f); });
  addMorph(shape, "little", [](const glm::vec3&) { return glm::vec3(0, 1e-4f, 0); });
  const SkinCage made = shape.cage(8);
  ASSERT_EQ(made.morphs.size(), 1u);
  ASSERT_EQ(made.notices.size(), 1u);
  EXPECT_NE(made.notices[0].find("'little'"), std::string::npos);
  CageMemory memory;
  const Cage cage =
      *makeCage(made.cages[0].source(), shape.whole.size, 5, made.cell, 0, nullptr, 1u << 30, memory);
  std::uint32_t near = 0;
  for (std::uint32_t n = 0; n < cage.nodes(); ++n) near += cage.rest(n).x < shape.whole.size.x / 2;
  EXPECT_EQ(made.morphs[0].moves.nodes.size(), near);
  for (const std::uint32_t node : made.morphs[0].moves.nodes)
    EXPECT_LT(cage.rest(node).x, shape.whole.size.x / 2);
}

double weightAt(const RigDescription::Clip& clip, double time) {
  if (clip.tracks.empty()) return 0;
  const std::vector<RigDescription::Key>& keys = clip.tracks.at(0).keys;
  std::size_t k = 0;
  while (k + 1 < keys.size() && static_cast<double>(keys[k + 1].time) <= time) ++k;
  if (k + 1 == keys.size()) return static_cast<double>(keys[k].value.x);
  const double from = static_cast<double>(keys[k].time), to = static_cast<double>(keys[k + 1].time);
  return glm::mix(static_cast<double>(keys[k].value.x), static_cast<double>(keys[k + 1].value.x),
                  (time - from) / (to - from));
}

// Three targets move the same node: as few keys as keep it within the tolerance.
TEST(MorphKeys, KeepNodesInTheirPlaces) {
  SourceSkin skin;
  skin.morphs = {{"ramp", {}, {}}, {"wave", {}, {}}, {"step", {}, {}}, {"rest", {}, {}}};
  SourceSkin::Clip clip{"play", 2, {}, {}, {}, {}};
  const auto weights = [](double time) {
    return std::vector<double>{0.5 * time, 0.5 - 0.5 * std::cos(3 * time), time < 1 ? 0.0 : -1.0, 0.0};
  };
  for (int i = 0; i <= 480; ++i) {
    clip.times.push_back(static_cast<float>(i / 240.0));
    for (const double weight : weights(i / 240.0)) clip.weights.push_back(static_cast<float>(weight));
  }
  skin.clips.push_back(clip);
  const std::vector<RawMorph> moves{{0, 0.5f, {4}, {{0, 40, 0}}},
                                    {0, 0.01f, {4, 5}, {{300, 0, 0}, {3000, 0, 0}}},
                                    {0, 1, {3, 4}, {{0, 0, 9}, {1, 2, 2}}},
                                    {0, 1, {1}, {{5, 5, 5}}}};
  std::vector<std::string> notices;
  const std::vector<SkinMorph> made = morphsOfSkin(skin, moves, std::vector<SkinFit>(4), 0.01, notices);
  ASSERT_EQ(made.size(), 4u);
  EXPECT_TRUE(made[3].rig.clips.empty());
  for (std::size_t t = 0; t < clip.times.size(); ++t) {
    std::vector<glm::dvec3> off(6, glm::dvec3(0));
    for (std::size_t m = 0; m < 3; ++m) {
      const double time = static_cast<double>(clip.times[t]),
                   error =
                       weightAt(made[m].rig.clips.at(0), time) - static_cast<double>(clip.weights[4 * t + m]);
      for (std::size_t i = 0; i < moves[m].nodes.size(); ++i)
        off[moves[m].nodes[i]] +=
            error * static_cast<double>(moves[m].step) * glm::dvec3(moves[m].offsets[i]);
    }
    for (const glm::dvec3& by : off) ASSERT_LE(glm::length(by), 0.01) << t;
  }
  EXPECT_EQ(made[0].rig.clips[0].tracks[0].keys.size(), 2u);
  EXPECT_LE(made[1].rig.clips[0].tracks[0].keys.size(), 100u);
  EXPECT_EQ(made[2].rig.clips[0].tracks[0].keys.size(), 4u);
}

TEST(LimitMorphs, TakesThoseThatMoveLeast) {
  SourceSkin skin;
  skin.morphs = {{"b", {0, 1}, {{1, 0, 0}, {0, 1, 0}}}, {"a", {3}, {{0, 0.5f, 0}}}, {"c", {2}, {{0, 3, 0}}}};
  skin.clips.push_back({"play", 1, {0, 1}, {}, {}, {1, 2, 3, 4, 5, 6}});
  std::vector<std::string> notices;
  limitMorphs(skin, 3, notices);
  EXPECT_TRUE(notices.empty());
  limitMorphs(skin, 2, notices);
  ASSERT_EQ(skin.morphs.size(), 2u);
  EXPECT_EQ(skin.morphs[0].name, "b");
  EXPECT_EQ(skin.morphs[1].name, "c");
  EXPECT_EQ(skin.clips[0].weights, (std::vector<float>{1, 3, 4, 6}));
  EXPECT_EQ(notices.size(), 1u);
}

}  // namespace
}  // namespace kelp::bake
