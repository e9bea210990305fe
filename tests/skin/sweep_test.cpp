// SPDX-License-Identifier: MIT
// Chains of joints as swept parts.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "chains.h"
#include "kelp/common/dense_index.h"
#include "kelp/skin/skin.h"
#include "keys.h"
#include "rigid.h"
#include "skin_shapes.h"
#include "sweep_fit.h"

namespace kelp::bake {
namespace {

// All samples in one part, which is swept along all joints.
struct Swept {
  test::SkinnedShape shape;
  SkinSpace space;
  SkinSamples samples;
  SkinLabels labels;
  std::vector<std::uint32_t> all;
  std::optional<SkinSweep> sweep;

  explicit Swept(test::SkinnedShape its_shape, std::size_t knots = 10)
      : shape(std::move(its_shape)), space(skinSpace(shape.frame)) {
    samples = makeSkinSamples(shape.soup(), shape.skin(), space);
    labels.parts.assign(samples.size(), 0);
    labels.joints = {0};
    SkinChain& chain = labels.chains.emplace_back();
    for (std::uint32_t j = 0; j < shape.skin().joints.size(); ++j) chain.joints.push_back(j);
    chain.knots = knots;
    for (std::uint32_t i = 0; i < samples.size(); ++i) all.push_back(i);
    sweep = makeSweep(samples, shape.skin(), space, all, chain);
  }
};

SourceSkin::Clip curl(const SourceSkin& skin, double angle, double duration = 2, int times = 61) {
  return test::turningClip(skin, "curl", duration, times, [&](int j, double t) {
    return j == 0 ? 0.0 : angle * std::sin(1.5707963 * t + 0.4 * j);
  });
}

TEST(SkinSweep, InTheBindPoseEveryPlaceStays) {
  for (const double radians : {0.0, 1.0, 3.0}) {
    const Swept swept(radians > 0 ? test::curvedTube(6, radians) : test::tube(6));
    ASSERT_TRUE(swept.sweep) << radians;
    const PosedSweep posed(*swept.sweep, {glm::dmat4x3(1), swept.sweep->knots});
    ASSERT_TRUE(static_cast<bool>(posed));
    for (const glm::dvec3& at : swept.samples.positions) {
      const glm::vec3 straight = swept.sweep->straightened(swept.sweep->toPart(at));
      ASSERT_LT(glm::distance(posed.at(straight), at), 1e-3);
      ASSERT_GT(straight.y, 0);
      ASSERT_LT(straight.y, static_cast<float>(swept.sweep->size.y));
    }
    for (const double y : {3.0, 40.0, 100.0}) {
      const glm::dmat4x3 motion = posed.sectionMotion(y);
      EXPECT_LT(glm::distance(motion * glm::dvec4(10, 20, 30, 1), glm::dvec3(10, 20, 30)), 1e-3);
    }
    // Straight, the tube is as long as its arc, and round.
    // As long as its arc, and 4 units more at both ends; aslant ones reach a little farther.
    EXPECT_GE(swept.sweep->size.y, 135);
    EXPECT_LE(swept.sweep->size.y, 150);
  }
}

// A tube that bends evenly is an arc: that is what a swept part can be exactly.
TEST(SkinSweep, PosesFollowTheSurface) {
  for (const double radians : {0.0, 1.5}) {
    test::SkinnedShape shape = radians > 0 ? test::curvedTube(12, radians) : test::tube(12);
    shape.skin().clips.push_back(curl(shape.skin(), 0.25));
    const Swept swept(std::move(shape), 14);
    ASSERT_TRUE(swept.sweep);
    const SkinMoments moments = momentsAt(swept.shape.skin(), 0, {0, 0.3, 0.8, 1.4, 1.9}, swept.space, 1);
    const SweepFit fit(swept.samples, *swept.sweep, swept.all);
    const SweepFit::Poses poses = fit.poses(moments, 1);
    ASSERT_FALSE(poses.fold());
    for (std::size_t t = 0; t < moments.size(); ++t) {
      const PosedSweep posed(*swept.sweep, poses.of_moments[t]);
      double sum = 0, area = 0, still = 0;
      for (std::size_t i = 0; i < swept.samples.size(); ++i) {
        const glm::dvec3 wanted = skinnedPoint(swept.samples, i, moments, t);
        const glm::vec3 straight = swept.sweep->straightened(swept.sweep->toPart(swept.samples.positions[i]));
        const double off = glm::distance(posed.at(straight), wanted);
        sum += swept.samples.areas[i] * off * off;
        area += swept.samples.areas[i];
        still = std::max(still, glm::distance(swept.samples.positions[i], wanted));
      }
      EXPECT_GT(still, 10);
      EXPECT_LT(std::sqrt(sum / area), 0.35) << t;
      EXPECT_NEAR(fit.meanSquare(poses.of_moments[t], moments, t), sum / area, 0.02) << t;
    }
  }
}

// Where the poses that fit best would fold, stiffer ones are found; all of them as stiff, so that none jumps.
TEST(SkinSweep, PosesDoNotFoldAndDoNotJump) {
  test::SkinnedShape shape = test::tube(8);
  shape.skin().clips.push_back(curl(shape.skin(), 0.9, 2, 121));
  const Swept swept(std::move(shape));
  const SourceSkin::Clip& clip = swept.shape.skin().clips[0];
  const SkinMoments moments =
      momentsAt(swept.shape.skin(), 0, {clip.times.begin(), clip.times.end()}, swept.space, 1);
  const SweepFit fit(swept.samples, *swept.sweep, swept.all);
  const SweepFit::Poses poses = fit.poses(moments, 1);
  ASSERT_FALSE(poses.fold());
  std::vector<glm::vec3> straight;
  for (const glm::dvec3& at : swept.samples.positions)
    straight.push_back(swept.sweep->straightened(swept.sweep->toPart(at)));
  std::vector<glm::dvec3> last;
  double jump = 0;
  for (std::size_t t = 0; t < moments.size(); ++t) {
    EXPECT_TRUE(checkSweep(poses.of_moments[t].knots, swept.sweep->size));
    const PosedSweep posed(*swept.sweep, poses.of_moments[t]);
    // How far each sample is from where it is drawn, and how much that changes within 1/60 second.
    std::vector<glm::dvec3> off;
    for (std::size_t i = 0; i < straight.size(); i += 5) {
      off.push_back(posed.at(straight[i]) - skinnedPoint(swept.samples, i, moments, t));
      if (t > 0) jump = std::max(jump, glm::distance(off.back(), last[off.size() - 1]));
    }
    last = std::move(off);
  }
  EXPECT_LT(jump, 1);
}

TEST(SkinSweep, KeysKeepKnotsWithinAQuarterOfAVoxel) {
  test::SkinnedShape shape = test::curvedTube(6, 1.0);
  shape.skin().clips.push_back(curl(shape.skin(), 0.3, 2, 121));
  Swept swept(std::move(shape));
  const SourceSkin& skin = swept.shape.skin();
  const PartTree tree = hangParts(swept.samples, skin, swept.space, swept.labels);
  ASSERT_TRUE(tree.sweeps[0]);
  const double quarter = 0.25 / swept.space.voxels;
  const auto clips = makeSkinKeys(swept.samples, skin, 0, swept.space, swept.labels, tree, quarter);
  const std::vector<float>& times = skin.clips[0].times;
  const SkinMoments moments = momentsAt(skin, 0, {times.begin(), times.end()}, swept.space, 1);
  const SweepFit::Poses poses = SweepFit(swept.samples, *swept.sweep, swept.all).poses(moments, 1);
  double worst = 0;
  for (std::size_t t = 0; t < times.size(); ++t) {
    const SkinPose keyed = posesOfKeys(clips, tree, swept.space, static_cast<double>(times[t]))[0];
    const PosedSweep a(*swept.sweep, keyed), b(*swept.sweep, poses.of_moments[t]);
    for (const Knot& knot : swept.sweep->knots) {
      const glm::vec3 at(swept.sweep->corner() +
                         glm::dvec3(0, static_cast<double>(knot.at) * swept.sweep->height(), 0));
      worst = std::max(worst, glm::distance(a.at(at), b.at(at)));
    }
  }
  EXPECT_LE(worst, 1.02 * quarter);
  EXPECT_GT(worst, 0.2 * quarter);  // they are reduced indeed
  std::size_t keys = 0, knots = 0;
  for (const RigDescription::Track& track : clips[0].tracks) {
    keys += track.keys.size();
    knots += track.target == Target::kKnotOffset || track.target == Target::kKnotTangent;
  }
  EXPECT_GT(knots, 6u);
  EXPECT_LT(keys, times.size() * clips[0].tracks.size() / 3);
}

TEST(SkinChains, AreTubes) {
  test::SkinnedShape shape = test::tube(5);
  const SkinSpace space = skinSpace(shape.frame);
  SourceSkin& skin = shape.skin();
  const auto chains = [&] { return findChains(makeSkinSamples(shape.soup(), skin, space), skin, space); };
  using Chains = std::vector<std::vector<std::uint32_t>>;
  EXPECT_EQ(chains(), (Chains{{0, 1, 2, 3, 4}}));
  // A branch ends one.
  skin.joints[4].parent = 2;
  EXPECT_EQ(chains(), (Chains{{0, 1, 2}}));
  skin.joints[4].parent = 3;
  // A sharp corner divides one: the joint there belongs to what follows.
  skin.joints[3].origin = skin.joints[2].origin + glm::dvec3(3, 0, 0);
  skin.joints[4].origin = skin.joints[3].origin + glm::dvec3(3, 0, 0);
  EXPECT_EQ(chains(), (Chains{{0, 1}, {2, 3, 4}}));
  // Joints in one place are no bone: the corner is behind them.
  skin.joints[3].origin = skin.joints[2].origin;
  EXPECT_EQ(chains(), (Chains{{0, 1}, {2, 3, 4}}));
  skin.joints[4].origin = skin.joints[3].origin + glm::dvec3(0, 3, 0);
  EXPECT_EQ(chains(), (Chains{{0, 1, 2, 3, 4}}));
}

// A rope: far more joints than parts or knots could be.
TEST(SkinChains, MayHaveHundredsOfJoints) {
  test::SkinnedShape shape = test::tube(200, 201);
  shape.skin().clips.push_back(test::turningClip(shape.skin(), "wave", 2, 21, [](int j, double t) {
    return 0.02 * std::sin(1.5707963 * t + 0.03 * j);
  }));
  shape.voxelizeWhole();
  const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
  ASSERT_EQ(divided.parts.size(), 1u);
  EXPECT_TRUE(divided.parts[0].swept);
  EXPECT_EQ(divided.parts[0].joints.size(), 200u);
  EXPECT_LE(divided.parts[0].rig.knots.size(), 24u);
  EXPECT_LT(divided.fits[0].distances.p95, 0.5);
}

// The distance from each ninth voxel of one set to the nearest of the other, at most.
double farthest(const std::vector<glm::dvec3>& from, const std::vector<glm::dvec3>& to) {
  double most = 0;
  for (std::size_t i = 0; i < from.size(); i += 9) {
    double least = 1e9;
    for (const glm::dvec3& b : to) least = std::min(least, glm::dot(from[i] - b, from[i] - b));
    most = std::max(most, least);
  }
  return std::sqrt(most);
}

// The surface voxels of a part as they are drawn at rest, in voxels of the whole.
void addSurface(const SkinPart& part, const VoxelGrid& whole, std::vector<glm::dvec3>& centers,
                std::vector<glm::dvec3>& normals) {
  const glm::dmat4x3 to_node(whole.to_node);
  const glm::dmat3 back = glm::inverse(linearOf(to_node));
  const RawRig rest = realizeRig(part.rig);
  ArcChain arcs;
  if (part.swept) {
    ASSERT_TRUE(makeArcs(rest.knots, part.grid.size, 0, kArcTolerance, arcs));
  }
  const glm::dmat3 turn = back * linearOf(glm::dmat4x3(part.grid.to_node));
  for (const SurfaceSample& sample : part.grid.surface) {
    glm::vec3 at = glm::vec3(voxelAt(part.grid.size, sample.index)) + 0.5f;
    glm::vec3 normal = sample.normal;
    if (part.swept) {
      normal = glm::mat3(sectionAt(arcs, at.y)) * normal;
      at = sweepPoint(arcs, part.grid.size, at);
    }
    const glm::dvec3 in_node = glm::dmat4x3(part.grid.to_node) * glm::dvec4(glm::dvec3(at), 1);
    centers.push_back(back * (in_node - to_node[3]));
    normals.push_back(glm::normalize(turn * glm::dvec3(normal)));
  }
}

TEST(DivideSweptSkin, InTheBindPoseItsSurfaceIsThatOfTheWhole) {
  for (const double radians : {0.0, 2.0}) {
    test::SkinnedShape shape = radians > 0 ? test::curvedTube(6, radians) : test::tube(6);
    shape.skin().clips.push_back(curl(shape.skin(), 0.3));
    shape.voxelizeWhole();
    const SkinParts divided = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {});
    ASSERT_EQ(divided.parts.size(), 1u);
    EXPECT_TRUE(divided.parts[0].swept);
    EXPECT_LT(divided.fits[0].distances.p95, 1.0);
    std::vector<glm::dvec3> drawn, normals, whole;
    addSurface(divided.parts[0], shape.whole, drawn, normals);
    for (const SurfaceSample& sample : shape.whole.surface)
      whole.push_back(glm::dvec3(voxelAt(shape.whole.size, sample.index)) + 0.5);
    // Middles of surface voxels in two lattices; their surfaces are up to half a voxel nearer.
    EXPECT_LT(farthest(drawn, whole), 1.25) << radians;
    EXPECT_LT(farthest(whole, drawn), 1.25) << radians;
    // Normals too, where a voxel lies nearly on one of the whole.
    std::size_t alike = 0, near = 0;
    for (std::size_t i = 0; i < drawn.size(); i += 7)
      for (std::size_t j = 0; j < whole.size(); ++j) {
        if (glm::distance(drawn[i], whole[j]) > 0.5) continue;
        ++near;
        alike += glm::dot(normals[i], glm::dvec3(shape.whole.surface[j].normal)) > 0.9;
      }
    EXPECT_GT(near, 200u);
    EXPECT_GT(static_cast<double>(alike), 0.97 * static_cast<double>(near));
  }
}

TEST(DivideSweptSkin, IsTheSameOnAnyNumberOfThreads) {
  test::SkinnedShape shape = test::curvedTube(6, 1.0);
  shape.skin().clips.push_back(curl(shape.skin(), 0.3));
  shape.voxelizeWhole();
  const SkinParts one = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 1, {}),
                  four = divideSkin(shape.model, shape.model.parts[0], shape.frame, shape.whole, 4, {});
  ASSERT_EQ(one.parts.size(), four.parts.size());
  EXPECT_EQ(one.parts[0].grid.solid, four.parts[0].grid.solid);
  EXPECT_EQ(one.parts[0].rig, four.parts[0].rig);
}

}  // namespace
}  // namespace kelp::bake
