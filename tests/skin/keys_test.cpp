// SPDX-License-Identifier: MIT
// Keys keep the fitted motion, and are few.
#include "keys.h"

#include <cmath>

#include <gtest/gtest.h>

#include "collapse.h"
#include "rigid.h"
#include "skin_shapes.h"

namespace kelp::bake {
namespace {

constexpr double kQuarter = 0.25;

// A tube of three joints, a part for each, and one clip.
struct Keyed {
  test::SkinnedShape shape = test::tube(3);
  SkinSpace space = skinSpace(shape.frame);
  SkinSamples samples;
  SkinLabels labels;
  PartTree tree;
  std::vector<RigDescription::Clip> clips;

  explicit Keyed(SourceSkin::Clip clip) {
    SourceSkin& skin = shape.skin();
    skin.clips.push_back(std::move(clip));
    samples = makeSkinSamples(shape.soup(), skin, space);
    for (std::uint32_t i = 0; i < samples.size(); ++i) labels.parts.push_back(samples.heaviestJoint(i));
    labels.joints = {0, 1, 2};
    labels.chains.resize(3);
    tree = hangParts(samples, skin, space, labels);
    clips = makeSkinKeys(samples, skin, 0, space, labels, tree, kQuarter);
  }

  // How far the keys put any sample from the motion that is fitted at these times.
  double worst(const std::vector<double>& times) const {
    const SkinMoments moments = momentsAt(shape.skin(), 0, times, space, 1);
    double most = 0;
    std::vector<std::vector<glm::dmat4x3>> fitted;
    const auto members = labels.members();
    for (std::size_t p = 0; p < members.size(); ++p)
      fitted.push_back(fitMotions(samples, moments, members[p], labels.joints[p]));
    for (std::size_t t = 0; t < times.size(); ++t) {
      const std::vector<SkinPose> poses = posesOfKeys(clips, tree, space, times[t]);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const glm::dvec4 x(samples.positions[i], 1);
        most =
            std::max(most, glm::distance(poses[labels.parts[i]].motion * x, fitted[labels.parts[i]][t] * x));
      }
    }
    return most;
  }
  std::size_t keys() const {
    std::size_t count = 0;
    for (const RigDescription::Clip& clip : clips)
      for (const RigDescription::Track& track : clip.tracks) count += track.keys.size();
    return count;
  }
};

std::vector<double> denseTimes(double duration) {
  std::vector<double> times;
  for (int i = 0; i <= 997; ++i) times.push_back(duration * i / 997);
  return times;
}

const SourceSkin kBones = test::tube(3).skin();

TEST(SkinKeys, StayWithinAQuarterOfAVoxel) {
  const Keyed keyed(test::turningClip(kBones, "wave", 2, 121,
                                      [](int j, double t) { return 0.6 * std::sin(3.14159265 * t + j); }));
  std::vector<double> sampled(keyed.shape.skin().clips[0].times.begin(),
                              keyed.shape.skin().clips[0].times.end());
  EXPECT_LE(keyed.worst(sampled), kQuarter + 1e-6);
  EXPECT_LE(keyed.worst(denseTimes(2)), 1.05 * kQuarter);
  EXPECT_GT(keyed.worst(sampled), 0.05);  // they are reduced indeed
  EXPECT_GT(keyed.keys(), 30u);
  EXPECT_LT(keyed.keys(), 3u * 2u * 121u / 3u);
}

TEST(SkinKeys, OfAnEvenTurnAreTwo) {
  const Keyed keyed(
      test::turningClip(kBones, "turn", 2, 121, [](int j, double t) { return j == 0 ? 0.5 * t : 0.0; }));
  ASSERT_EQ(keyed.clips[0].tracks.size(), 1u);
  EXPECT_EQ(keyed.clips[0].tracks[0].target, Target::kPartRotation);
  EXPECT_EQ(keyed.clips[0].tracks[0].keys.size(), 2u);
  // The other parts follow it, and need nothing of their own but a held rounding error.
  for (const std::size_t p : {1u, 2u})
    for (const RigDescription::Track& track : keyed.clips[p].tracks) EXPECT_EQ(track.keys.size(), 1u);
  EXPECT_LE(keyed.worst(denseTimes(2)), 1.0 / 64);  // to which keys are rounded
}

TEST(SkinKeys, OfAHeldPoseIsOne) {
  const Keyed keyed(
      test::turningClip(kBones, "pose", 1, 61, [](int j, double) { return j == 1 ? 0.4 : 0.0; }));
  EXPECT_TRUE(keyed.clips[0].tracks.size() <= 2);
  for (const RigDescription::Clip& clip : keyed.clips)
    for (const RigDescription::Track& track : clip.tracks) EXPECT_EQ(track.keys.size(), 1u);
  EXPECT_GE(keyed.clips[1].tracks.size(), 1u);
  EXPECT_LE(keyed.worst(denseTimes(1)), 1.0 / 64);
}

// Steps are sampled just before and at their time: no moment of the clip shows what lies between.
TEST(SkinKeys, KeepSteps) {
  SourceSkin::Clip clip = test::turningClip(kBones, "step", 1, 61,
                                            [](int j, double t) { return j == 1 && t > 0.501 ? 0.8 : 0.0; });
  const float before = clip.times[31] - 1e-4f;
  const auto row = clip.motions.begin() + 30 * 3;
  const std::vector<glm::dmat4x3> held(row, row + 3);
  clip.times.insert(clip.times.begin() + 31, before);
  clip.motions.insert(clip.motions.begin() + 31 * 3, held.begin(), held.end());
  const double step = static_cast<double>(clip.times[32]);
  const Keyed keyed(std::move(clip));
  EXPECT_LE(keyed.worst({0.2, step - 2e-4, step + 1e-5, step + 1e-3, 0.9}), kQuarter + 1e-6);
  EXPECT_LE(keyed.keys(), 20u);
}

TEST(SkinKeys, SlowTurnsTakeTheShorterWay) {
  const Keyed keyed(
      test::turningClip(kBones, "round", 4, 241, [](int j, double t) { return j == 0 ? 3.0 * t : 0.0; }));
  EXPECT_LE(keyed.worst(denseTimes(4)), 1.05 * kQuarter);  // nearly two whole turns
  EXPECT_GE(keyed.clips[0].tracks[0].keys.size(), 4u);
}

}  // namespace
}  // namespace kelp::bake
