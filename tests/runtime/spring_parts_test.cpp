// SPDX-License-Identifier: MIT
// Springs on rigs of many parts and on skins: which parts give way, and what hangs on them follows.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "caged.h"
#include "kelp/runtime/spring.h"
#include "support/short_memory.h"

namespace kelp::runtime {
namespace {

constexpr float kUnit = 0.1f;  // object units

// An ellipsoid that fills its box.
fields::Occupancy bean(const glm::ivec3& size) {
  fields::Occupancy volume{size,
                           std::vector<std::uint8_t>(static_cast<std::size_t>(size.x * size.y * size.z))};
  glm::ivec3 v;
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) {
        const glm::vec3 off = (2.0f * glm::vec3(v) + 1.0f) / glm::vec3(size) - 1.0f;
        volume.solid[volume.index(v)] = glm::dot(off, off) <= 1.2f;
      }
  return volume;
}

enum class Kind { kSheared, kSwept, kCaged };

// Places in voxels.
RawPart partAt(Kind kind, int parent, const glm::ivec3& size, const glm::vec3& low, const glm::vec3& pivot) {
  const fields::Occupancy volume = bean(size);
  RawPart part = kind == Kind::kCaged
                     ? CagedAsset::packOf(volume, 4, Bend::kSweep, straight({0, 0.5f, 1})).parts[0]
                     : test::packOf(volume, straight({0, 0.5f, 1})).parts[0];
  part.bend = kind == Kind::kSheared ? Bend::kShear : Bend::kSweep;
  part.parent = parent;
  part.to_object = glm::mat4x3(kUnit);
  part.to_object[3] = kUnit * low;
  part.pivot = glm::mat4x3(glm::rotate(glm::mat4(2.0f), 0.4f, glm::vec3(1, 2, 3)));
  part.pivot[3] = kUnit * pivot;
  return part;
}

enum FigurePart { kTorso, kArm, kForearm, kHand, kHead, kTail, kParts };
constexpr glm::vec3 kJoints[kParts] = {{10, 2, 8},  {19, 38, 8}, {21, 17, 8},
                                       {21, -5, 8}, {10, 39, 8}, {10, 10, 8}};

struct Figure {
  explicit Figure(Kind kind) : loaded(packOf(kind)), pose(Pose::create(*loaded.asset).value()) {
    pose.motion(kArm)->rotation = glm::angleAxis(0.3f, glm::normalize(glm::vec3(1, 0, 2)));
    pose.motion(kForearm)->rotation = glm::angleAxis(0.5f, glm::normalize(glm::vec3(1, 1, 0)));
    pose.motion(kHand)->scale = glm::vec3(1.1f, 1.0f, 0.9f);
    pose.motion(kTorso)->translation = {0.2f, 0.1f, -0.3f};
  }
  static RawPack packOf(Kind kind) {
    RawPack pack = test::packOf(bean({8, 8, 8}));
    pack.parts = {partAt(kind, -1, {20, 40, 16}, {0, 0, 0}, kJoints[kTorso]),
                  partAt(kind, kTorso, {10, 24, 10}, {16, 16, 3}, kJoints[kArm]),
                  partAt(kind, kArm, {9, 24, 9}, {17, -6, 4}, kJoints[kForearm]),
                  partAt(kind, kForearm, {10, 8, 10}, {16, -12, 3}, kJoints[kHand]),
                  partAt(kind, kTorso, {16, 16, 16}, {2, 38, 0}, kJoints[kHead]),
                  partAt(kind, kTorso, {8, 30, 8}, {6, 8, 4}, kJoints[kTail])};
    pack.parts[kTail].parent_at = 0.25f;
    return pack;
  }
  Instance instance(const Pose& with) const { return {loaded.asset.get(), &with, world}; }
  int parentOf(int part) const { return loaded.asset->pack().parts()[static_cast<std::size_t>(part)].parent; }
  glm::vec3 at(const Pose& with, int part, const glm::vec3& voxels) const {
    return toWorld(instance(with), part, kUnit * voxels).value();
  }
  Pose sprung(const Spring& spring) const {
    Pose with = Pose::create(*loaded.asset).value();
    with.assign(pose).value();
    spring.addTo(with).value();
    return with;
  }

  Loaded loaded;
  Pose pose;
  glm::mat4 world = glm::translate(glm::rotate(glm::mat4(3.0f), 0.7f, glm::vec3(1, 1, -2)), {1, 2, 3});
  float voxel = 3 * kUnit;  // in the world
};

class SpringParts : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, SpringParts, testing::Values(Kind::kSheared, Kind::kSwept, Kind::kCaged));

// Where a part hangs on another, voxels of both stay together: the place itself, and 1.5 voxels beside it.
TEST_P(SpringParts, NothingTearsBesideABall) {
  const Figure figure(GetParam());
  for (const bool rooted : {true, false}) {
    Spring spring = Spring::create(*figure.loaded.asset, {1.5f, 0.2f, 0.5f, rooted}).value();
    const std::pair<int, glm::vec3> places[] = {{kForearm, {13, 3, 8}}, {kArm, {24, 26, 1}},
                                                {kHand, {25, -8, 12}},  {kTorso, {-3, 34, 6}},
                                                {kHead, {4, 50, 14}},   {kTail, {10, 30, 0}}};
    float most = 0, most_of_tail = 0;
    double worst = 0, worst_beside = 0;
    for (const auto& [part, place] : places)
      for (int step = 0; step < 6; ++step) {
        const glm::vec3 ball = figure.at(figure.pose, part, place);
        ASSERT_TRUE(spring.step(0.05f));
        ASSERT_TRUE(spring.pushAway(
            figure.instance(figure.pose), ball,
            figure.voxel * (GetParam() == Kind::kCaged ? 2.0f + float(step) : 5.0f + 2 * float(step))));
        const Pose with = figure.sprung(spring);
        ASSERT_TRUE(with.check());
        for (int child = kArm; child < kParts; ++child) {
          const int parent = figure.parentOf(child);
          const auto gap = [&](const Pose& in, const glm::vec3& at) {
            return (figure.at(in, child, at) - figure.at(in, parent, at)) / figure.voxel;
          };
          const glm::vec3 before = gap(figure.pose, kJoints[child]), now = gap(with, kJoints[child]);
          // In the middle of a solid, where no cell is, the nearest cell takes along what hangs there.
          if (GetParam() != Kind::kCaged || child != kTail)
            worst = std::max(worst, double(glm::distance(before, now)));
          for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 beside = kJoints[child];
            beside[axis] += 1.5f;
            worst_beside =
                std::max(worst_beside, double(glm::distance(gap(figure.pose, beside), gap(with, beside))));
          }
          const float moved = glm::distance(figure.at(with, parent, kJoints[child]),
                                            figure.at(figure.pose, parent, kJoints[child]));
          most = std::max(most, moved / figure.voxel);
          if (child == kTail) most_of_tail = std::max(most_of_tail, moved / figure.voxel);
        }
      }
    EXPECT_LT(worst, 0.05) << rooted;
    // Sections of a sheared part stay level, and what hangs there turns. A cage has dents as large as the
    // ball, of its own up to the joint.
    EXPECT_LT(worst_beside, GetParam() == Kind::kCaged     ? 4.0
                            : GetParam() == Kind::kSheared ? 1.5
                                                           : 0.8)
        << rooted;
    EXPECT_GT(most, 4) << "joints were hardly moved";
    EXPECT_GT(most_of_tail, 0.5f);
  }
}

// Parts that are not listed stay as they are, and follow.
TEST_P(SpringParts, OnlyListedPartsGiveWay) {
  const Figure figure(GetParam());
  const int listed[] = {kHand, kArm};
  Spring spring = Spring::create(*figure.loaded.asset, {1.5f, 0.2f, 0.5f, true, listed}).value();
  const glm::vec3 ball = figure.at(figure.pose, kForearm, {12, 14, 8});
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(spring.pushAway(figure.instance(figure.pose), ball, 12 * figure.voxel));
  const auto moved = [&](int part) {
    float most = 0;
    for (const Swing& swing : GetParam() == Kind::kCaged ? spring.nodes(part) : spring.knots(part))
      most = std::max(most, glm::length(swing.offset));
    return most;
  };
  EXPECT_GT(moved(kArm), 0.02f);
  for (const int part : {kTorso, kForearm, kHead, kTail}) EXPECT_EQ(moved(part), 0) << part;
  const Pose with = figure.sprung(spring);
  const auto wayOf = [&](int part, const glm::vec3& voxels) {
    return glm::distance(figure.at(with, part, voxels), figure.at(figure.pose, part, voxels)) / figure.voxel;
  };
  EXPECT_GT(wayOf(kForearm, {21, 5, 8}), 0.7f);
  EXPECT_GT(wayOf(kHand, {21, -8, 8}), 0.7f);
  for (const int part : {kTorso, kHead, kTail}) EXPECT_EQ(wayOf(part, {10, 20, 8}), 0) << part;
}

// An arm hangs down: its shoulder is fixed, not its hand, and the hand leaves the ball.
TEST_P(SpringParts, WhatHangsIsHeldAtItsTop) {
  const Figure figure(GetParam());
  const int listed[] = {kForearm};
  Spring spring = Spring::create(*figure.loaded.asset, {1.5f, 0.2f, 0.5f, true, listed}).value();
  const glm::vec3 end(21, -6, 8), ball = figure.at(figure.pose, kForearm, {14, -6, 8});
  ASSERT_TRUE(spring.pushAway(figure.instance(figure.pose), ball, 13 * figure.voxel));
  const Pose with = figure.sprung(spring);
  const glm::vec3 before = figure.at(figure.pose, kForearm, end), after = figure.at(with, kForearm, end);
  EXPECT_GT(glm::dot(after - before, glm::normalize(before - ball)), 2 * figure.voxel);
  if (GetParam() == Kind::kCaged) return;
  EXPECT_EQ(spring.knots(kForearm)[2].offset, glm::vec3(0));
  EXPECT_GT(glm::length(spring.knots(kForearm)[0].offset), 0.05f);
  // As a beam that is loaded at its end: 5/16 of that in the middle.
  EXPECT_NEAR(glm::length(spring.knots(kForearm)[1].offset) / glm::length(spring.knots(kForearm)[0].offset),
              0.3125f, 0.01f);
}

TEST_P(SpringParts, AtRestNothingChanges) {
  const Figure figure(GetParam());
  Spring spring = Spring::create(*figure.loaded.asset).value();
  const Box box = bounds(figure.instance(figure.pose));
  ASSERT_TRUE(spring.pushAway(figure.instance(figure.pose), box.max + 5.0f, 1));
  const Pose with = figure.sprung(spring);
  for (int part = 0; part < kParts; ++part) EXPECT_EQ(*with.motion(part), *figure.pose.motion(part)) << part;
}

TEST_P(SpringParts, OnlyCreateAllocates) {
  const Figure figure(GetParam());
  test::ShortMemory memory;
  Spring spring = Spring::create(*figure.loaded.asset, {}, memory.allocator()).value();
  Pose pose = Pose::create(*figure.loaded.asset, memory.allocator()).value();
  const std::size_t created = memory.requests;
  for (int i = 0; i < 3; ++i) {
    pose.reset();
    ASSERT_TRUE(spring.step(0.1f));
    ASSERT_TRUE(spring.pushAway(figure.instance(pose), figure.at(pose, kForearm, {15, 2, 8}), 1));
    ASSERT_TRUE(spring.addTo(pose));
  }
  EXPECT_EQ(memory.requests, created);
  for (std::size_t i = 0; i < created; ++i) {
    test::ShortMemory less;
    less.refuse_at = i;
    const Result<Spring> made = Spring::create(*figure.loaded.asset, {}, less.allocator());
    if (!made) {
      EXPECT_EQ(made.error().code, ErrorCode::kOutOfMemory) << i;
    }
  }
}

// A body, part 2, whose nodes follow the joints 0 and 1, and a lantern on joint 1.
struct Skin {
  Skin() : loaded(packOf()), pose(Pose::create(*loaded.asset).value()) {
    pose.motion(1)->rotation = glm::angleAxis(0.4f, glm::vec3(0, 0, 1));
  }
  static RawPack packOf() {
    RawPack pack = test::packOf(bean({8, 8, 8}));
    RawPart joint;
    joint.size = {16, 60, 16};
    joint.knots = straight({0, 1});
    joint.to_object = glm::mat4x3(kUnit);
    joint.pivot = glm::mat4x3(1);
    pack.parts = {joint, joint, partAt(Kind::kCaged, -1, {16, 60, 16}, {0, 0, 0}, {0, 0, 0}),
                  partAt(Kind::kSheared, 1, {8, 12, 8}, {12, 48, 4}, {13, 50, 8})};
    pack.parts[1].parent = 0;
    pack.parts[1].pivot[3] = kUnit * glm::vec3(8, 30, 8);
    CageMemory memory;
    RawPart& body = pack.parts[2];
    const Cage cage = makeCage(body.cages[0].source(), body.size, static_cast<int>(body.levels.size()),
                               body.cell, 0, nullptr, ~std::uint64_t{0}, memory)
                          .value();
    for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
      const int upper = std::clamp(255 * (cage.rest(i).y - 24) / 12, 0, 255);
      Influences its;
      its.parts[0] = upper < 255 ? 0 : 1;
      its.weights[0] = static_cast<std::uint8_t>(upper < 255 ? 255 - upper : 255);
      if (upper > 0 && upper < 255) its.parts[1] = 1, its.weights[1] = static_cast<std::uint8_t>(upper);
      body.influences.push_back(its);
    }
    return pack;
  }
  Instance instance(const Pose& with) const { return {loaded.asset.get(), &with}; }
  glm::vec3 at(const Pose& with, int part, const glm::vec3& voxels) const {
    return toWorld(instance(with), part, kUnit * voxels).value();
  }

  Loaded loaded;
  Pose pose;
};

TEST(SpringSkin, NodesGiveWayByTheWeightOfListedJoints) {
  const Skin skin;
  const Cage& cage = skin.loaded.asset->pack().parts()[2].cages[0];
  // A ball that touches all of one side.
  const auto pushed = [&](std::optional<std::span<const int>> parts) {
    Spring spring = Spring::create(*skin.loaded.asset, {1, 0.2f, 0.5f, false, parts}).value();
    spring.pushAway(skin.instance(skin.pose), skin.at(skin.pose, 2, {-18, 30, 8}), 2.3f).value();
    return spring;
  };
  const Spring all = pushed(std::nullopt);
  const int upper[] = {1};
  const Spring some = pushed(upper);
  int below = 0, above = 0;
  for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
    const bool follows = cage.rest(i).y > 24;
    if (!follows) {
      EXPECT_EQ(some.nodes(2)[i].offset, glm::vec3(0)) << i;
    }
    below += !follows && all.nodes(2)[i].offset != glm::vec3(0);
    above += follows && some.nodes(2)[i].offset != glm::vec3(0);
  }
  EXPECT_GT(below, 10);
  EXPECT_GT(above, 10);
  // Joints have no voxels that a ball may meet.
  Spring within = Spring::create(*skin.loaded.asset).value();
  within.pushAway(skin.instance(skin.pose), skin.at(skin.pose, 2, {4, 40, 8}), 1.2f).value();
  for (const int joint : {0, 1})
    for (const Swing& swing : within.knots(joint)) EXPECT_EQ(swing.offset, glm::vec3(0));
  // No cell folds, and none is stretched to twice its size.
  Pose with = Pose::create(*skin.loaded.asset).value();
  with.assign(skin.pose).value();
  some.addTo(with).value();
  const PosedCage posed = posedCage(skin.instance(with), 2, 0).value();
  EXPECT_EQ(posed.inverted_count, 0u);
  for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
    for (int corner = 0; corner < 8; ++corner)
      for (const int axis : {1, 2, 4})
        EXPECT_LT(
            glm::distance(posed.nodes[cage.node(cell, corner)], posed.nodes[cage.node(cell, corner ^ axis)]),
            2.0f * static_cast<float>(cage.side));
}

TEST(SpringSkin, WhatHangsOnAJointGoesWithTheNodes) {
  const Skin skin;
  constexpr int kLantern = 3;
  const glm::vec3 joint(13, 50, 8);
  Spring spring = Spring::create(*skin.loaded.asset, {1, 0.2f, 0.5f, true}).value();
  spring.pushAway(skin.instance(skin.pose), skin.at(skin.pose, 2, {-2, 52, 8}), 1.2f).value();
  Pose with = Pose::create(*skin.loaded.asset).value();
  with.assign(skin.pose).value();
  spring.addTo(with).value();
  const glm::vec3 of_body = skin.at(with, 2, joint) - skin.at(skin.pose, 2, joint);
  const glm::vec3 of_lantern = skin.at(with, kLantern, joint) - skin.at(skin.pose, kLantern, joint);
  EXPECT_GT(glm::length(of_body), 3 * kUnit);
  EXPECT_LT(glm::distance(of_body, of_lantern), 0.05f * kUnit);
  EXPECT_EQ(*with.motion(1), *skin.pose.motion(1));
}

TEST(SpringSkin, WrongListsAreRefused) {
  const Skin skin;
  const auto made = [&](std::span<const int> parts) {
    SpringOptions options;
    options.parts = parts;
    return Spring::create(*skin.loaded.asset, options);
  };
  EXPECT_EQ(made({}).error().code, ErrorCode::kMisuse);
  for (const int absent : {-1, 4, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    const int list[] = {2, absent};
    const Result<Spring> refused = made(list);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kMisuse);
    EXPECT_EQ(refused.error().offset, 1u);
  }
  const int twice[] = {1, 1, 2, 0};
  EXPECT_TRUE(made(twice));
}

}  // namespace
}  // namespace kelp::runtime
