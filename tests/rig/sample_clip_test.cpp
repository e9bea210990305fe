// SPDX-License-Identifier: MIT
// Clips of swept parts: what proveClip() finds against arcs made at other moments of the same motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "kelp/formats/sweep.h"
#include "kelp/rig/rig.h"

namespace kelp {
namespace {

const glm::ivec3 kSize(16, 128, 16);

RawRig straight() {
  RawRig rest;
  rest.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  rest.bend = Bend::kSweep;
  return rest;
}

std::string errorOf(const RawClip& clip, const RawRig& rest, const glm::ivec3& size = kSize) {
  try {
    proveClip(clip, 2, rest, size);
  } catch (const RigError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

bool says(const std::string& error, const char* words) { return error.find(words) != std::string::npos; }

// The tip swings to the side and down, until it points down, and to the other side and up. A period of 4 s.
RawClip curl() {
  return {
      "curl",
      4,
      {{2, 1, Target::kKnotOffset, {0.7f, -0.95f, 0}, 4, 0}, {2, 1, Target::kKnotTangent, {1, -2, 0}, 4, 0}},
      {}};
}

std::vector<Knot> curledAt(double time) {
  const auto s = static_cast<float>(std::sin(2 * std::numbers::pi * time / 4));
  return {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0.7f * s, 1 - 0.95f * s, 0}, {s, 1 - 2 * s, 0}}};
}

TEST(SampleClip, ASweptPartMayTurnBack) {
  // At its widest the tip is beside the root and points down.
  EXPECT_EQ(errorOf(curl(), straight()), "");
  RawRig sheared = straight();
  sheared.bend = Bend::kShear;
  EXPECT_TRUE(says(errorOf(curl(), sheared), "turns back"));
}

TEST(SampleClip, NamesTheFirstMomentThatFolds) {
  const glm::ivec3 thick(80, 128, 80);
  double folds = 0;
  while (folds < 4 && checkSweep(curledAt(folds), thick)) folds += 1e-4;
  ASSERT_GT(folds, 0.1);
  ASSERT_LT(folds, 1);
  const std::string error = errorOf(curl(), straight(), thick);
  EXPECT_TRUE(says(error, "clip 'curl', part 2: at ")) << error;
  EXPECT_TRUE(says(error, " s, knot 0 (at 0): ")) << error;
  EXPECT_TRUE(says(error, "may not fold")) << error;
  const double said = std::stod(error.substr(error.find(": at ") + 5));
  EXPECT_GE(said, folds - 1e-4);
  EXPECT_LE(said, folds + 4.0 / 64);
}

TEST(SampleClip, LooksAtEveryKeyAndBetween) {
  // Bent for a thousandth of a second, far from any 64th of the clip.
  RawTrack jerk{2, 1, Target::kKnotTangent, Interpolation::kStep, {}};
  jerk.keys = {{0, {0, 0, 0, 0}, {}, {}}, {1.005f, {0, -30, 0, 0}, {}, {}}, {1.006f, {0, 0, 0, 0}, {}, {}}};
  RawClip clip{"jerk", 2, {}, {jerk}};
  EXPECT_TRUE(says(errorOf(clip, straight()), "at 1.005 s, knot 0 (at 0): ")) << errorOf(clip, straight());
  for (Key& key : clip.tracks[0].keys) key.value = glm::vec4(0);
  EXPECT_EQ(errorOf(clip, straight()), "");
  // A spike that is highest between two keys.
  clip.tracks[0].interpolation = Interpolation::kCubic;
  clip.tracks[0].keys = {{1.005f, {}, {}, {0, -1e5f, 0, 0}}, {1.006f, {}, {0, 1e5f, 0, 0}, {}}};
  EXPECT_TRUE(says(errorOf(clip, straight()), "at 1.0055 s")) << errorOf(clip, straight());
}

TEST(SampleClip, LooksAtTheEndOfTheClip) {
  // The tip's tangent tilts; the part folds in the last hundredth of the clip alone.
  const auto tilted = [](float by) {
    return checkSweep(std::array<Knot, 2>{{{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {by, 1, 0}}}}, kSize);
  };
  float fine = 0, folds = 100;
  for (int i = 0; i < 40; ++i) (tilted(0.5f * (fine + folds)) ? fine : folds) = 0.5f * (fine + folds);
  ASSERT_LT(folds, 50);
  RawTrack tilt{2, 1, Target::kKnotTangent, Interpolation::kLinear, {}};
  tilt.keys = {{0, {}, {}, {}}, {2, {1.005f * folds, 0, 0, 0}, {}, {}}};
  EXPECT_TRUE(says(errorOf({"tilt", 2, {}, {tilt}}, straight()), "at 2 s"));
  tilt.keys[1].value.x = 0.995f * folds;
  EXPECT_EQ(errorOf({"tilt", 2, {}, {tilt}}, straight()), "");
}

TEST(SampleClip, TangentsFollowAndTheRollCounts) {
  // All knots stay on a line. If their tangents follow, the part leans and is straight; else it bends twice.
  RawRig rest;
  rest.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0, 0.5f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  rest.bend = Bend::kSweep;
  const RawClip clip{
      "lean",
      1,
      {{2, 1, Target::kKnotOffset, {0.6f, 0, 0}, 1, 0}, {2, 2, Target::kKnotOffset, {1.2f, 0, 0}, 1, 0}},
      {}};
  const glm::ivec3 thick(100, 128, 100);
  EXPECT_NE(errorOf(clip, rest, thick), "");
  rest.automatic_tangents = 7;
  EXPECT_EQ(errorOf(clip, rest, thick), "");

  // A board that bends about its thin side; on its edge it folds.
  EXPECT_EQ(errorOf(curl(), straight(), {2, 128, 120}), "");
  RawRig turned = straight();
  turned.roll = 1.5708f;
  EXPECT_TRUE(says(errorOf(curl(), turned, {2, 128, 120}), "folds") ||
              says(errorOf(curl(), turned, {2, 128, 120}), "may not fold"));
}

TEST(SampleClip, BoundsHoldThePartAtTheMomentsLookedAt) {
  const ClipReport report = proveClip(curl(), 2, straight(), kSize);
  Box box;
  for (int i = 0; i <= 64; ++i) {
    ArcChain chain;
    ASSERT_TRUE(makeArcs(curledAt(i / 16.0), kSize, 0, kArcTolerance, chain));
    for (int y = 0; y <= 128; ++y)
      for (const float x : {0.0f, 16.0f})
        for (const float z : {0.0f, 16.0f}) box.add(sweepPoint(chain, kSize, {x, static_cast<float>(y), z}));
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(report.bounds.min[axis], box.min[axis]);
    EXPECT_GE(report.bounds.min[axis], box.min[axis] - 8);
    EXPECT_GE(report.bounds.max[axis], box.max[axis]);
    EXPECT_LE(report.bounds.max[axis], box.max[axis] + 8);
  }
  EXPECT_NEAR(report.leaves_box * 128,
              std::max({-report.bounds.min.x, -report.bounds.min.y, report.bounds.max.x - 16,
                        report.bounds.max.y - 128}),
              0.1);

  RawTrack hop{2, 0, Target::kPartTranslation, Interpolation::kLinear, {}};
  hop.keys = {{0, {}, {}, {}}, {1, {0, 9, 0, 0}, {}, {}}};
  EXPECT_EQ(proveClip({"hop", 1, {}, {hop}}, 2, straight(), kSize).leaves_box, 0.0f);
}

TEST(SampleClip, WhatWouldTakeTooLongIsRefused) {
  RawClip clip = curl();
  clip.waves[0].period = 0.001f;
  clip.waves[1].period = 9e5f;
  EXPECT_TRUE(says(errorOf(clip, straight()), "too many moments"));
  // Many keys in a clip that repeats often beside a long wave.
  clip = curl();
  clip.duration = 0.01f;
  clip.waves[0].period = 1e5f;
  RawTrack track{2, 0, Target::kKnotOffset, Interpolation::kLinear, {}};
  for (int i = 0; i < 100; ++i) track.keys.push_back({static_cast<float>(i) * 1e-4f, {}, {}, {}});
  clip.tracks = {track};
  EXPECT_TRUE(says(errorOf(clip, straight()), "too many moments"));
}

}  // namespace
}  // namespace kelp
