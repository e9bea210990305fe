// SPDX-License-Identifier: MIT
// A column that leans by offsets of its knots alone is straight, because automatic tangents follow; and what
// overrides them. Truth: the straight line, and splines of knots worked out by hand, in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kelp/runtime/instance.h"
#include "kelp/runtime/spring.h"
#include "loaded.h"
#include "support/spline_truth.h"

namespace kelp::runtime {
namespace {

constexpr double kLeanVoxel = 1.0 / 128;  // the column is 1 m high
// Half a voxel is what a lean needs; this is what rounding to float adds up to.
constexpr double kTolerance = 0.01 * kLeanVoxel;
constexpr glm::vec3 kLeanSide(0.8f, 0, -0.6f);

glm::vec3 offsetOf(int degrees) { return std::tan(glm::radians(static_cast<float>(degrees))) * kLeanSide; }

RawPack column(std::uint64_t automatic = 7) {
  RawPack pack =
      test::packOf({{16, 128, 16}, std::vector<std::uint8_t>(16 * 128 * 16, 1)}, straight({0, 0.5f, 1}));
  pack.parts[0].automatic_tangents = automatic;
  return pack;
}

Wave waveOf(std::uint32_t knot, Target target, const glm::vec3& amplitude) {
  return {0, knot, target, amplitude, 4, 0};
}
RawTrack trackOf(std::uint32_t knot, Target target, const glm::vec3& value) {
  const glm::vec4 at_end(value, 0);
  return {0, knot, target, Interpolation::kLinear, {{0, glm::vec4(0), {}, {}}, {4, at_end, {}, {}}}};
}

// Points of the column's middle line, 1 m high: where the runtime takes them, and where the spline of the
// pose's knots does, in double precision. `lean`: of the top.
void expectStraight(const Loaded& loaded, const Pose& pose, const glm::dvec3& lean) {
  ASSERT_TRUE(pose.check());
  const Instance instance{loaded.asset.get(), &pose};
  double worst = 0;
  for (int i = 0; i <= 128; ++i) {
    const double y = i / 128.0;
    const glm::dvec3 wanted = glm::dvec3(0, y, 0) + y * lean;
    worst = std::max(
        worst,
        glm::distance(glm::dvec3(toWorld(instance, 0, {0, static_cast<float>(y), 0}).value()), wanted));
  }
  EXPECT_LT(worst, kTolerance) << "by toWorld";
  for (std::size_t k = 0; k < 2; ++k) {
    const test::SplineTruth segment(pose.knots(0)[k], pose.knots(0)[k + 1]);
    for (double t = 0; t <= 1; t += 1.0 / 64) {
      const glm::dvec3 at(segment.value(0, t), segment.value(1, t), segment.value(2, t));
      EXPECT_LT(glm::distance(at, glm::dvec3(0, at.y, 0) + at.y * lean), kTolerance) << "by the spline";
    }
  }
}

TEST(Lean, OfMovedKnotsIsStraight) {
  const Loaded loaded(column());
  for (int degrees = 10; degrees <= 70; degrees += 10) {
    SCOPED_TRACE(degrees);
    const glm::vec3 offset = offsetOf(degrees);
    Pose pose = *Pose::create(*loaded.asset), other = *Pose::create(*loaded.asset);
    ASSERT_TRUE(pose.move(0, 1, 0.5f * offset));
    ASSERT_TRUE(pose.move(0, 2, offset));
    expectStraight(loaded, pose, offset);
    // The same in steps, in the other order.
    ASSERT_TRUE(other.move(0, 2, 0.25f * offset));
    ASSERT_TRUE(other.move(0, 1, 0.5f * offset));
    ASSERT_TRUE(other.move(0, 2, 0.75f * offset));
    expectStraight(loaded, other, offset);
  }
}

TEST(Lean, OfClipsIsStraightAtEveryTime) {
  RawPack pack = column();
  std::vector<glm::vec3> offsets;
  for (int degrees = 10; degrees <= 70; degrees += 10) {
    const glm::vec3 offset = offsets.emplace_back(offsetOf(degrees));
    // The wave is at its peak after 1 s, the keys are at their end just before 4 s.
    pack.clips.push_back(
        {"wave" + std::to_string(degrees),
         4,
         {waveOf(1, Target::kKnotOffset, 0.5f * offset), waveOf(2, Target::kKnotOffset, offset)},
         {}});
    pack.clips.push_back(
        {"keys" + std::to_string(degrees),
         4,
         {},
         {trackOf(1, Target::kKnotOffset, 0.5f * offset), trackOf(2, Target::kKnotOffset, offset)}});
  }
  const Loaded loaded(pack);
  for (std::size_t clip = 0; clip < pack.clips.size(); ++clip) {
    SCOPED_TRACE(pack.clips[clip].name);
    for (const double seconds : {0.0, 0.3, 1.0, 2.2, std::nextafter(4.0, 0.0)}) {
      const double share = clip % 2 == 0 ? std::sin(glm::radians(90.0) * seconds) : seconds / 4;
      Pose pose = *Pose::create(*loaded.asset);
      ASSERT_TRUE(addClip(*loaded.asset, static_cast<int>(clip), seconds, 1, pose));
      expectStraight(loaded, pose, share * glm::dvec3(offsets[clip / 2]));
      // Half of it from the clip, half from the game, and a spring that nothing pushed.
      pose.reset();
      ASSERT_TRUE(addClip(*loaded.asset, static_cast<int>(clip), seconds, 0.5f, pose));
      ASSERT_TRUE(pose.move(0, 1, static_cast<float>(0.25 * share) * offsets[clip / 2]));
      ASSERT_TRUE(pose.move(0, 2, static_cast<float>(0.5 * share) * offsets[clip / 2]));
      Spring spring = *Spring::create(*loaded.asset);
      ASSERT_TRUE(spring.step(0.1f));
      ASSERT_TRUE(spring.addTo(pose));
      expectStraight(loaded, pose, share * glm::dvec3(offsets[clip / 2]));
    }
  }
}

// The middle line of the posed column is the spline of these knots.
void expectSpline(const Loaded& loaded, const Pose& pose, std::span<const Knot> knots) {
  const Instance instance{loaded.asset.get(), &pose};
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const test::SplineTruth segment(knots[k], knots[k + 1]);
    for (double t = 0; t <= 1; t += 1.0 / 32) {
      const glm::dvec3 wanted(segment.value(0, t), segment.value(1, t), segment.value(2, t));
      const glm::dvec3 at(toWorld(instance, 0, {0, static_cast<float>(wanted.y), 0}).value());
      EXPECT_LT(glm::distance(at, wanted), kTolerance) << k << ' ' << t;
    }
  }
}

// The knots of a column that leans by `offset`, with these tangents.
std::vector<Knot> leaning(const glm::vec3& offset, const std::array<glm::vec3, 3>& tangents) {
  const glm::vec3 y(0, 1, 0);
  return {
      {0, {0, 0, 0}, tangents[0]}, {0.5f, 0.5f * (y + offset), tangents[1]}, {1, y + offset, tangents[2]}};
}

// Each knot's tangent is automatic or stands upright.
TEST(Lean, OnlyAutomaticTangentsFollow) {
  const glm::vec3 y(0, 1, 0), offset = offsetOf(40);
  for (std::uint64_t automatic = 0; automatic < 8; ++automatic) {
    SCOPED_TRACE(automatic);
    RawPack pack = column(automatic);
    pack.clips.push_back({"wave",
                          4,
                          {waveOf(1, Target::kKnotOffset, 0.5f * offset)},
                          {trackOf(2, Target::kKnotOffset, offset)}});
    pack.clips[0].tracks[0].keys = {{0, glm::vec4(offset, 0), {}, {}}};
    const Loaded loaded(pack);
    Pose moved = *Pose::create(*loaded.asset), played = *Pose::create(*loaded.asset);
    ASSERT_TRUE(moved.move(0, 1, 0.5f * offset));
    ASSERT_TRUE(moved.move(0, 2, offset));
    ASSERT_TRUE(addClip(*loaded.asset, 0, 1, 1, played));
    std::array<glm::vec3, 3> tangents;
    for (std::size_t k = 0; k < 3; ++k) tangents[k] = (automatic >> k & 1) != 0 ? y + offset : y;
    expectSpline(loaded, moved, leaning(offset, tangents));
    expectSpline(loaded, played, leaning(offset, tangents));
  }
}

// A wave or a track of a clip overrides an automatic tangent in that clip, and in no other.
TEST(Lean, AClipOverridesAutomaticTangents) {
  const glm::vec3 y(0, 1, 0), offset = offsetOf(30), given(-0.4f, 0.3f, 0.7f);
  RawPack pack = column();
  const std::vector<Wave> waves{waveOf(1, Target::kKnotOffset, 0.5f * offset),
                                waveOf(2, Target::kKnotOffset, offset)};
  pack.clips = {{"follows", 4, waves, {}}, {"waves", 4, waves, {}}, {"keys", 4, waves, {}}};
  pack.clips[1].waves.push_back(waveOf(1, Target::kKnotTangent, given));
  pack.clips[1].waves.push_back(waveOf(0, Target::kKnotTangent, glm::vec3(0)));
  for (const std::uint32_t knot : {1u, 0u}) {
    pack.clips[2].tracks.push_back(trackOf(knot, Target::kKnotTangent, knot == 1 ? given : glm::vec3(0)));
    pack.clips[2].tracks.back().keys = {{0, glm::vec4(knot == 1 ? given : glm::vec3(0), 0), {}, {}}};
  }
  const Loaded loaded(pack);
  for (const int clip : {1, 2}) {
    SCOPED_TRACE(clip);
    Pose pose = *Pose::create(*loaded.asset);
    ASSERT_TRUE(addClip(*loaded.asset, clip, 1, 1, pose));
    expectSpline(loaded, pose, leaning(offset, {y, y + given, y + offset}));
    // With a layer that overrides nothing, and a movement by the game: these follow.
    pose.reset();
    ASSERT_TRUE(addClip(*loaded.asset, clip, 1, 0.5f, pose));
    ASSERT_TRUE(addClip(*loaded.asset, 0, 1, 0.25f, pose));
    ASSERT_TRUE(pose.move(0, 1, 0.125f * offset));
    ASSERT_TRUE(pose.move(0, 2, 0.25f * offset));
    expectSpline(loaded, pose,
                 leaning(offset, {y + 0.5f * offset, y + 0.5f * given + 0.5f * offset, y + offset}));
  }
  Pose pose = *Pose::create(*loaded.asset);
  ASSERT_TRUE(addClip(*loaded.asset, 0, 1, 1, pose));
  expectStraight(loaded, pose, offset);
}

}  // namespace
}  // namespace kelp::runtime
