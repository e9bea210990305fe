// SPDX-License-Identifier: MIT
// Parts that a rig asks for.
#include "plan.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "kelp/skin/skin.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

using Groups = std::vector<RigDescription::SkinGroup>;

std::string errorOf(const SourceSkin& skin, const Groups& groups) {
  try {
    planOf(skin, groups);
  } catch (const RigError& error) {
    return error.what();
  }
  return "";
}

// A tube that curls by so many radians at each joint.
test::SkinnedShape curlingTube(int joints, double radians) {
  test::SkinnedShape shape = test::tube(joints);
  shape.skin().clips.push_back(test::turningClip(shape.skin(), "curl", 2, 61, [radians](int j, double t) {
    return j == 0 ? 0.0 : radians * std::sin(1.5707963 * t);
  }));
  shape.voxelizeWhole();
  return shape;
}

SkinParts divided(test::SkinnedShape shape, const Groups& groups, int threads = 1) {
  shape.model.parts[0].rig.skin = groups;
  return divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, threads, {});
}

std::vector<std::string> namesOf(const SkinParts& parts) {
  std::vector<std::string> names;
  for (const SkinPart& part : parts.parts) names.push_back(part.name);
  std::sort(names.begin(), names.end());
  return names;
}

TEST(SkinPlan, JointsThatNoEntryNamesGoWithThoseAbove) {
  const SourceSkin skin = test::tube(6).skin();
  const SkinPlan plan = planOf(skin, {{{"bone4"}, 0, 2}, {{"bone2", "bone1"}, 0, 1}});
  EXPECT_EQ(plan.group_of, (std::vector<std::uint32_t>{0, 1, 1, 1, 0, 0}));
  EXPECT_EQ(plan.lead, (std::vector<std::uint32_t>{4, 1, 1, 1, 4, 4}));
  EXPECT_EQ(plan.groups[1].top, 1u);
  const SkinPlan swept = planOf(skin, {{{"bone1", "bone3"}, 4, 1}});
  EXPECT_EQ(swept.lead, (std::vector<std::uint32_t>{1, 1, 1, 3, 3, 3}));
}

TEST(SkinPlan, JointsOfOneNameAreToldApart) {
  SourceSkin skin = test::tube(4).skin();
  skin.joints[1].name = skin.joints[3].name = "bone";
  skin.joints[2].name = "bone.2";
  EXPECT_EQ(jointNames(skin), (std::vector<std::string>{"bone0", "bone", "bone.2", "bone.3"}));
  EXPECT_EQ(planOf(skin, {{{"bone.3"}, 0, 1}}).groups[0].joints, (std::vector<std::uint32_t>{3}));
}

TEST(SkinPlan, ErrorsNameTheJoint) {
  const SourceSkin skin = test::tube(4).skin();
  const std::string unknown = errorOf(skin, {{{"bone0"}, 0, 1}, {{"bone1", "bone9"}, 0, 1}});
  EXPECT_NE(
      unknown.find("/skin/parts/1/joints/1: the file's skin has no joint 'bone9'; it has 'bone0', 'bone1'"),
      std::string::npos)
      << unknown;
  const std::string order = errorOf(skin, {{{"bone2", "bone1"}, 4, 1}});
  EXPECT_NE(order.find("/skin/parts/0/joints/1: the joint 'bone1' is not below 'bone2'"), std::string::npos)
      << order;
  EXPECT_EQ(errorOf(skin, {{{"bone2", "bone1"}, 0, 1}}), "");
  EXPECT_EQ(errorOf(skin, {{{"bone0", "bone3"}, 3, 1}}), "");
}

TEST(SkinPlan, PartsAreThoseOfTheEntries) {
  const test::SkinnedShape shape = curlingTube(4, 0.5);
  const SkinParts parts = divided(shape, {{{"bone0"}, 0, 1}, {{"bone2", "bone1"}, 0, 1}, {{"bone3"}, 0, 2}});
  EXPECT_TRUE(parts.notices.empty()) << parts.notices.front();
  EXPECT_EQ(namesOf(parts), (std::vector<std::string>{"bone0", "bone1", "bone3", "bone3.2"}));
  for (const SkinPart& part : parts.parts) {
    EXPECT_FALSE(part.swept) << part.name;
    const bool joined = part.name == "bone1";
    EXPECT_EQ(part.joints, joined ? std::vector<std::string>({"bone2", "bone1"})
                                  : std::vector<std::string>({part.name.substr(0, 5)}));
    if (joined) {  // has the surface of both joints; of one it would be a quarter of the tube
      EXPECT_GT(part.grid.size.y, 45);
      EXPECT_LT(part.grid.size.y, 80);
    }
  }
  const SkinParts three =
      divided(shape, {{{"bone0"}, 0, 1}, {{"bone2", "bone1"}, 0, 1}, {{"bone3"}, 0, 2}}, 3);
  ASSERT_EQ(three.parts.size(), parts.parts.size());
  for (std::size_t p = 0; p < three.parts.size(); ++p) {
    EXPECT_EQ(three.parts[p].grid.solid, parts.parts[p].grid.solid);
    EXPECT_EQ(three.parts[p].rig, parts.parts[p].rig);
  }
}

// A group whose uppermost joint stands last, and whose joints have another one between them.
TEST(SkinPlan, GroupsThatAreNotConnected) {
  const SkinParts parts =
      divided(curlingTube(4, 0.3), {{{"bone3", "bone1"}, 0, 1}, {{"bone2"}, 0, 1}, {{"bone0"}, 0, 1}});
  EXPECT_EQ(std::count_if(parts.parts.begin(), parts.parts.end(), [](const auto& p) { return p.parent < 0; }),
            1);
  for (std::size_t p = 0; p < parts.parts.size(); ++p) EXPECT_LT(parts.parts[p].parent, static_cast<int>(p));
}

TEST(SkinPlan, SweptPartsHaveTheirKnots) {
  const test::SkinnedShape shape = curlingTube(6, 0.3);
  for (const int knots : {4, 7, 12}) {
    const SkinParts parts =
        divided(shape, {{{"bone0"}, 0, 1}, {{"bone1", "bone2", "bone3", "bone4", "bone5"}, knots, 1}});
    EXPECT_TRUE(parts.notices.empty()) << parts.notices.front();
    ASSERT_EQ(namesOf(parts), (std::vector<std::string>{"bone0", "bone1"}));
    const SkinPart& part = parts.parts[parts.parts[0].name == "bone1" ? 0 : 1];
    EXPECT_TRUE(part.swept);
    EXPECT_EQ(part.rig.knots.size(), static_cast<std::size_t>(knots));
    EXPECT_EQ(part.joints.size(), 5u);
    EXPECT_LT(part.fit.mean, 1.0) << knots;
  }
}

TEST(SkinPlan, WhatFoldsStaysRigidAndIsTold) {
  const SkinParts parts =
      divided(curlingTube(4, 2.2), {{{"bone0"}, 0, 1}, {{"bone1", "bone2", "bone3"}, 8, 1}});
  EXPECT_EQ(namesOf(parts), (std::vector<std::string>{"bone0", "bone1", "bone2", "bone3"}));
  for (const SkinPart& part : parts.parts) EXPECT_FALSE(part.swept);
  ASSERT_EQ(parts.notices.size(), 1u);
  EXPECT_NE(parts.notices[0].find("/skin/parts/1 ('bone1' to 'bone3'): rigid parts"), std::string::npos)
      << parts.notices[0];
  EXPECT_NE(parts.notices[0].find("clip 'curl'"), std::string::npos) << parts.notices[0];
}

TEST(SkinPlan, PiecesThatCannotBeAreTold) {
  const SkinParts parts = divided(curlingTube(2, 0.5), {{{"bone0"}, 0, 1}, {{"bone1"}, 0, 256}});
  ASSERT_EQ(parts.notices.size(), 1u);
  EXPECT_NE(parts.notices[0].find(" of its 256 pieces"), std::string::npos) << parts.notices[0];
  EXPECT_GT(parts.parts.size(), 4u);
}

TEST(SkinPlan, NeedsNoClips) {
  test::SkinnedShape shape = test::tube(4);
  shape.voxelizeWhole();
  const SkinParts parts = divided(shape, {{{"bone0", "bone1"}, 0, 1}, {{"bone2", "bone3"}, 5, 1}});
  EXPECT_EQ(namesOf(parts), (std::vector<std::string>{"bone0", "bone2"}));
  EXPECT_TRUE(parts.notices.empty());
}

// Joints in one place have no bone to bend along.
TEST(SkinPlan, AChainWithoutALengthStaysRigid) {
  test::SkinnedShape shape = curlingTube(3, 0.3);
  shape.skin().joints[2].origin = shape.skin().joints[1].origin;
  const SkinParts parts = divided(shape, {{{"bone0"}, 0, 1}, {{"bone1", "bone2"}, 5, 1}});
  ASSERT_EQ(parts.notices.size(), 1u);
  EXPECT_NE(parts.notices[0].find("joints are in one place"), std::string::npos) << parts.notices[0];
}

}  // namespace
}  // namespace kelp::bake
