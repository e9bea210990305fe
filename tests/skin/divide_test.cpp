// SPDX-License-Identifier: MIT
// The whole division of a tube.
#include "kelp/skin/skin.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/sweep.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

// By default its joints turn so sharply that it would fold if it were swept.
test::SkinnedShape bendingTube(int joints, double radians = 2.4) {
  test::SkinnedShape shape = test::tube(joints);
  shape.skin().clips.push_back(test::turningClip(shape.skin(), "bend", 2, 121, [radians](int j, double t) {
    return j == 0 ? 0.0 : (j % 2 ? radians : -radians) * std::sin(1.5707963 * t);
  }));
  shape.skin().clips.push_back(
      test::turningClip(shape.skin(), "rest", 1, 2, [](int, double) { return 0.0; }));
  shape.voxelizeWhole();
  return shape;
}

// Where a part's voxel lies in the whole.
glm::ivec3 placeOf(const SkinPart& part, const VoxelGrid& whole, std::size_t index) {
  const glm::dvec3 at =
      glm::dmat4x3(part.grid.to_node) * glm::dvec4(glm::dvec3(voxelAt(part.grid.size, index)) + 0.5, 1);
  const glm::dmat4 to_node(
      glm::dvec4(glm::dvec3(whole.to_node[0]), 0), glm::dvec4(glm::dvec3(whole.to_node[1]), 0),
      glm::dvec4(glm::dvec3(whole.to_node[2]), 0), glm::dvec4(glm::dvec3(whole.to_node[3]), 1));
  return glm::ivec3(glm::floor(glm::dvec3(glm::inverse(to_node) * glm::dvec4(at, 1))));
}

TEST(DivideSkin, InTheBindPoseThePartsAreTheWhole) {
  const test::SkinnedShape shape = bendingTube(3);
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  ASSERT_GE(divided.parts.size(), 3u);
  std::vector<std::uint8_t> together(shape.whole.solid.size(), 0);
  std::size_t shared = 0;
  for (const SkinPart& part : divided.parts) {
    ASSERT_EQ(part.grid.solid.size(), denseCount(part.grid.size));
    std::vector<std::uint64_t> surface;
    for (const SurfaceSample& sample : part.grid.surface) {
      surface.push_back(sample.index);
      EXPECT_NEAR(glm::length(sample.normal), 1, 1e-4);
    }
    EXPECT_EQ(surface, fields::surfaceVoxels({part.grid.size, part.grid.solid}, 1)) << part.name;
    for (std::size_t i = 0; i < part.grid.solid.size(); ++i) {
      if (!part.grid.solid[i]) continue;
      const std::size_t at = denseIndex(shape.whole.size, placeOf(part, shape.whole, i));
      ASSERT_TRUE(shape.whole.solid[at]) << part.name;
      shared += together[at];
      together[at] = 1;
    }
  }
  EXPECT_EQ(together, shape.whole.solid);
  EXPECT_GT(shared, 500u);  // neighbors overlap
}

TEST(DivideSkin, SurfaceVoxelsLookLikeTheWhole) {
  const test::SkinnedShape shape = bendingTube(2);
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  std::size_t same = 0;
  for (const SkinPart& part : divided.parts)
    for (const SurfaceSample& sample : part.grid.surface) {
      const std::size_t at = denseIndex(shape.whole.size, placeOf(part, shape.whole, sample.index));
      for (const SurfaceSample& wanted : shape.whole.surface) {
        if (wanted.index != at) continue;
        ++same;
        ASSERT_EQ(sample.normal, wanted.normal);
        ASSERT_EQ(sample.source, wanted.source);
        break;
      }
    }
  EXPECT_GE(same, shape.whole.surface.size());
}

TEST(DivideSkin, IsTheSameOnAnyNumberOfThreads) {
  const test::SkinnedShape shape = bendingTube(3);
  const SkinParts one = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {}),
                  four = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 4, {});
  ASSERT_EQ(one.parts.size(), four.parts.size());
  for (std::size_t p = 0; p < one.parts.size(); ++p) {
    EXPECT_EQ(one.parts[p].grid.solid, four.parts[p].grid.solid);
    EXPECT_EQ(one.parts[p].rig.clips, four.parts[p].rig.clips);
  }
}

TEST(DivideSkin, ReportsTheFitOfEachClip) {
  const test::SkinnedShape shape = bendingTube(3, 0.9);
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  ASSERT_EQ(divided.fits.size(), 2u);
  const SkinFit& bend = divided.fits[0];
  EXPECT_EQ(bend.clip, "bend");
  EXPECT_GT(bend.distances.mean, 0.05);
  EXPECT_LT(bend.distances.mean, 0.8);
  EXPECT_GT(bend.distances.p95, bend.distances.mean);
  EXPECT_LE(bend.distances.p95, 2.5);
  EXPECT_GE(bend.distances.max, bend.distances.p95);
  EXPECT_EQ(bend.joint.rfind("bone", 0), 0u);
  EXPECT_LT(divided.fits[1].distances.max, 1e-4);
  // A clip that moves nothing is one all the same.
  std::size_t tracks = 0;
  for (const SkinPart& part : divided.parts) {
    ASSERT_EQ(part.rig.clips.size(), 2u);
    EXPECT_EQ(part.rig.clips[1].name, "rest");
    tracks += part.rig.clips[1].tracks.size();
  }
  EXPECT_EQ(tracks, 1u);
}

// A joint that moves next to nothing gets no part.
TEST(DivideSkin, SmallPartsGoToTheirParent) {
  test::SkinnedShape shape = bendingTube(2);
  SourceSkin& skin = shape.skin();
  skin.joints.push_back({"tip", 1, {0, test::kTubeHeight, 0}});
  // The vertex in the middle of the lid.
  SourceSkin::Influence& last = skin.influences.back();
  ASSERT_EQ(last.weight, 1.0f);
  last.joint = 2;
  for (SourceSkin::Clip& clip : skin.clips) {
    std::vector<glm::dmat4x3> motions;
    for (std::size_t i = 0; i < clip.motions.size(); i += 2) {
      motions.insert(motions.end(), {clip.motions[i], clip.motions[i + 1], clip.motions[i + 1]});
    }
    clip.motions = std::move(motions);
  }
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  for (const SkinPart& part : divided.parts) EXPECT_NE(part.name.substr(0, 3), "tip");
}

// Where a socket is in the bind pose, and its axes, in the soup's space.
glm::dmat4x3 seatOf(const SkinPart& part, const RigDescription::Socket& socket) {
  const glm::vec3 size(part.grid.size);
  glm::vec3 at(0.5f * size.x + socket.offset.x * size.y, socket.at * size.y,
               0.5f * size.z + socket.offset.z * size.y);
  glm::mat3 axes = glm::mat3_cast(socket.rotation);
  if (part.swept) {
    ArcChain arcs;
    EXPECT_TRUE(makeArcs(realizeRig(part.rig).knots, part.grid.size, 0, kArcTolerance, arcs));
    axes = glm::mat3(sectionAt(arcs, at.y)) * axes;
    at = sweepPoint(arcs, part.grid.size, at);
  }
  const glm::dmat4x3 to_node(part.grid.to_node);
  const glm::dmat3 linear(to_node[0], to_node[1], to_node[2]);
  const glm::dmat3 turned = linear * glm::dmat3(axes);
  return {glm::normalize(turned[0]), glm::normalize(turned[1]), glm::normalize(turned[2]),
          to_node * glm::dvec4(glm::dvec3(at), 1)};
}

// One within the tube, one beyond its end; of rigid parts, of a swept one that is bent in the bind pose.
TEST(DivideSkin, SocketsStayWhereTheyAre) {
  for (const bool swept : {false, true}) {
    test::SkinnedShape shape = swept ? test::curvedTube(4, 1.0) : bendingTube(3);
    SourceSkin& skin = shape.skin();
    if (swept) {
      skin.clips.push_back(test::turningClip(
          skin, "bend", 2, 61, [](int j, double t) { return j == 0 ? 0.0 : 0.3 * std::sin(1.5707963 * t); }));
      shape.voxelizeWhole();
    }
    const auto last = static_cast<std::uint32_t>(skin.joints.size() - 1);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    glm::dmat4 inner =
        glm::translate(glm::dmat4(1), skin.joints[1].origin + glm::dvec3(0.1, 0.5, 0.2)) * turn;
    glm::dmat4 outer = glm::translate(
        glm::dmat4(1), skin.joints[last].origin + (swept ? glm::dvec3(-0.4, 2, 0) : glm::dvec3(0, 6, 0)));
    skin.sockets = {{"inner", 1, inner}, {"outer", last, outer}};
    const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
    int found = 0;
    for (const SkinPart& part : divided.parts)
      for (const RigDescription::Socket& socket : part.rig.sockets) {
        ++found;
        const glm::dmat4& wanted = socket.name == "inner" ? inner : outer;
        const glm::dmat4x3 seat = seatOf(part, socket);
        EXPECT_LT(glm::distance(seat[3], glm::dvec3(wanted[3])), 0.002) << socket.name << swept;
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_GT(glm::dot(seat[axis], glm::dvec3(wanted[axis])), 0.999) << socket.name << swept;
        EXPECT_EQ(part.name.rfind("bone", 0), 0u);
      }
    EXPECT_EQ(found, 2);
    ASSERT_EQ(divided.sockets.size(), 2u);
    for (const SocketFit& fit : divided.sockets) EXPECT_LT(fit.most, 8) << fit.socket;
  }
}

// A socket whose joint the file does not hang below the one that it moves with.
TEST(DivideSkin, SocketsFollowThePartThatMovesAsTheyDo) {
  test::SkinnedShape shape = bendingTube(2);
  SourceSkin& skin = shape.skin();
  skin.joints.push_back({"socket_tip", -1, {0, test::kTubeHeight, 0}});
  for (SourceSkin::Clip& clip : skin.clips) {
    std::vector<glm::dmat4x3> motions;
    for (std::size_t i = 0; i < clip.motions.size(); i += 2)
      motions.insert(motions.end(), {clip.motions[i], clip.motions[i + 1], clip.motions[i + 1]});
    clip.motions = std::move(motions);
  }
  skin.sockets = {{"tip", 2, glm::translate(glm::dmat4(1), glm::dvec3(0, test::kTubeHeight, 0))}};
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  ASSERT_EQ(divided.sockets.size(), 1u);
  EXPECT_EQ(divided.sockets[0].part.rfind("bone1", 0), 0u) << divided.sockets[0].part;
  EXPECT_LT(divided.sockets[0].most, 3);
}

// Many sockets far away do not make a part's box much larger; one beyond all sense is left out.
TEST(DivideSkin, FarSocketsAreTakenToTheEnd) {
  test::SkinnedShape shape = bendingTube(2);
  SourceSkin& skin = shape.skin();
  for (int i = 0; i < 20; ++i)
    skin.sockets.push_back({"far" + std::to_string(i), 1,
                            glm::translate(glm::dmat4(1), glm::dvec3(0, i % 2 ? 1000.0 : -1000.0, 0))});
  skin.sockets.push_back({"nowhere", 1, glm::translate(glm::dmat4(1), glm::dvec3(1e9, 0, 0))});
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  std::size_t found = 0;
  for (const SkinPart& part : divided.parts) {
    EXPECT_LE(part.grid.size.y, 3 * shape.whole.size.y);
    for (const RigDescription::Socket& socket : part.rig.sockets) {
      ++found;
      EXPECT_TRUE(socket.at == 0 || socket.at == 1) << socket.name;
    }
  }
  EXPECT_EQ(found, 20u);
  ASSERT_EQ(divided.notices.size(), 1u);
  EXPECT_NE(divided.notices[0].find("nowhere"), std::string::npos);
}

}  // namespace
}  // namespace kelp::bake
