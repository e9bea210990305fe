// SPDX-License-Identifier: MIT
// Sockets on the boxes of joints; skins with more joints than a pack can hold.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "joints.h"
#include "moments.h"
#include "skin_sockets.h"

namespace kelp::bake {
namespace {

// A chain of joints, each a unit above the one before, which all turn; `uses`: how many vertices each moves.
SourceSkin chain(const std::vector<int>& uses) {
  SourceSkin skin;
  SourceSkin::Clip clip{"turn", 1, {0, 0.5f, 1}, {}, {}, {}};
  for (std::size_t j = 0; j < uses.size(); ++j) {
    SourceSkin::Joint& joint = skin.joints.emplace_back();
    joint.name = "j" + std::to_string(j);
    joint.parent = static_cast<int>(j) - 1;
    joint.base = joint.frame = glm::translate(glm::dmat4(1), glm::dvec3(0, static_cast<double>(j), 0));
    joint.inverse_bind = glm::inverse(joint.frame);
    for (int i = 0; i < uses[j]; ++i) {
      skin.first_influence.push_back(static_cast<std::uint32_t>(skin.influences.size()));
      skin.influences.push_back({static_cast<std::uint32_t>(j), 1});
    }
  }
  skin.first_influence.push_back(static_cast<std::uint32_t>(skin.influences.size()));
  for (std::size_t t = 0; t < 3; ++t)
    for (std::size_t j = 0; j < uses.size(); ++j) {
      const double angle = 0.3 * static_cast<double>(t) * (1 + static_cast<double>(j));
      const glm::dvec3 axis(0, 0, 1);
      clip.locals.emplace_back(skin.joints[j].frame * glm::rotate(glm::dmat4(1), angle, axis) *
                               skin.joints[j].inverse_bind);
      clip.turns.push_back(glm::angleAxis(angle, axis));
    }
  skin.clips.push_back(std::move(clip));
  return skin;
}

std::vector<std::string> namesOf(const SourceSkin& skin) {
  std::vector<std::string> names;
  for (const SourceSkin::Joint& joint : skin.joints) names.push_back(joint.name);
  return names;
}

void expectMotions(const SourceSkin& before, const SourceSkin& after, const std::vector<std::size_t>& kept) {
  for (const double time : {0.0, 0.5, 1.0}) {
    const std::vector<glm::dmat4x3> a = motionsAt(before, 0, time), b = motionsAt(after, 0, time);
    ASSERT_EQ(b.size(), kept.size());
    for (std::size_t j = 0; j < kept.size(); ++j)
      for (int column = 0; column < 4; ++column)
        EXPECT_LT(glm::distance(a[kept[j]][column], b[j][column]), 1e-12);
  }
}

TEST(LimitJoints, TakesThoseThatMoveNothing) {
  const SourceSkin all = chain({1, 0, 1, 0, 2, 0, 0});
  SourceSkin skin = all;
  std::vector<std::string> notices;
  limitJoints(skin, 7, notices);
  EXPECT_EQ(skin.joints.size(), 7u);
  limitJoints(skin, 6, notices);
  EXPECT_EQ(namesOf(skin), (std::vector<std::string>{"j0", "j1", "j2", "j3", "j4"}));
  EXPECT_TRUE(notices.empty());
  expectMotions(all, skin, {0, 1, 2, 3, 4});
}

TEST(LimitJoints, TakesThoseThatMoveLeast) {
  const SourceSkin all = chain({5, 1, 4, 2, 3});
  SourceSkin skin = all;
  skin.sockets.push_back({"grip", 3, glm::dmat4(1)});
  std::vector<std::string> notices;
  limitJoints(skin, 3, notices);
  EXPECT_EQ(namesOf(skin), (std::vector<std::string>{"j0", "j2", "j3"}));  // a socket is a use
  EXPECT_EQ(notices.size(), 1u);
  EXPECT_EQ(skin.joints[1].parent, 0);
  EXPECT_EQ(skin.joints[2].parent, 1);
  EXPECT_EQ(skin.sockets[0].joint, 2u);
  std::vector<int> moved(3, 0);
  for (const SourceSkin::Influence& influence : skin.influences) ++moved.at(influence.joint);
  EXPECT_EQ(moved, (std::vector<int>{6, 4, 5}));
  expectMotions(all, skin, {0, 2, 3});
  EXPECT_EQ(skin.clips[0].turns.size(), skin.clips[0].locals.size());
}

// The root has no weight, and stays: voxels of a joint that goes follow it, and no neighbor.
TEST(LimitJoints, KeepsTheRoot) {
  SourceSkin skin = chain({0, 1, 1, 1});
  skin.joints[2].parent = skin.joints[3].parent = 0;
  std::vector<std::string> notices;
  limitJoints(skin, 2, notices);
  EXPECT_EQ(namesOf(skin), (std::vector<std::string>{"j0", "j1"}));
  std::vector<int> moved(2, 0);
  for (const SourceSkin::Influence& influence : skin.influences) ++moved.at(influence.joint);
  EXPECT_EQ(moved, (std::vector<int>{2, 1}));
}

TEST(JointSockets, LieInTheBoxesOfTheirJoints) {
  SourceSkin skin = chain({1, 1});
  Frame frame;
  frame.size = {10, 20, 6};
  frame.voxel_size = 0.5;
  // Turned: the soup's x is the voxels' y.
  frame.node_to_voxel = glm::scale(
      glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(5, 1, 3)), M_PI / 2, glm::dvec3(0, 0, 1)),
      glm::dvec3(2));
  const std::vector<glm::dvec3> places{{3, 0.5, 0.2}, {11.2, 0, 1}, {-3, 20, -4}, {9000, 0, 0}};
  for (const glm::dvec3& at : places)
    skin.sockets.push_back({"s" + std::to_string(skin.sockets.size()), 1,
                            glm::rotate(glm::translate(glm::dmat4(1), at), 0.7, glm::dvec3(1, 2, 3))});
  std::vector<SkinJoint> joints(2);
  std::vector<std::string> notices;
  addJointSockets(skin, frame, joints, notices);
  EXPECT_TRUE(joints[0].rig.sockets.empty());
  EXPECT_EQ(joints[0].grow, glm::ivec2(0));
  ASSERT_EQ(joints[1].rig.sockets.size(), 3u);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("'s3'"), std::string::npos);
  EXPECT_EQ(joints[1].grow, glm::ivec2(5, 4));  // of y -5 and 23.4
  const double height = 20 + 5 + 4;
  for (std::size_t i = 0; i < 3; ++i) {
    const RigDescription::Socket& socket = joints[1].rig.sockets[i];
    // As SPEC.md 4.7 says, in the box; its origin is 5 layers below the frame's.
    const glm::dvec3 at(5 + static_cast<double>(socket.offset.x) * height,
                        static_cast<double>(socket.at) * height - 5,
                        3 + static_cast<double>(socket.offset.z) * height);
    const glm::dmat4 wanted = frame.node_to_voxel * skin.sockets[i].place;
    EXPECT_LT(glm::distance(at, glm::dvec3(wanted[3])), 1e-4) << i;
    const glm::dmat3 turned(glm::mat3_cast(socket.rotation));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT(glm::distance(turned[axis], glm::normalize(glm::dvec3(wanted[axis]))), 1e-5) << i;
  }
}

}  // namespace
}  // namespace kelp::bake
