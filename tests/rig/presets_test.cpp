// SPDX-License-Identifier: MIT
// Presets keep their promises on every axis: sideways motion only, provably monotone, seamless, and round
// trips.
#include <gtest/gtest.h>

#include <cmath>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

TEST(Presets, AreMonotoneSidewaysAndSeamless) {
  EXPECT_EQ(presetNames(), (std::vector<std::string>{"none", "sway", "swim", "breathe", "twist"}));
  EXPECT_FALSE(presetRig("walk"));
  for (const std::string& name : presetNames()) {
    for (const auto axis : {std::optional<Axis>{}, std::optional(Axis::kPlusX), std::optional(Axis::kMinusY),
                            std::optional(Axis::kPlusZ)}) {
      const auto rig = presetRig(name, axis);
      ASSERT_TRUE(rig) << name;
      if (axis) {
        EXPECT_EQ(rig->axis, axis);
      }
      EXPECT_EQ(parseRig(printRig(*rig)), *rig);
      const glm::ivec3 size(30, 100, 40);
      const RawRig rest{realizeKnots(*rig), automaticTangents(*rig)};
      const auto clips = realizeClips(*rig, 0);
      EXPECT_EQ(hasSections(*rig), name == "breathe" || name == "twist");
      EXPECT_EQ(clips.empty(), name == "none");
      for (const RawClip& clip : clips) {
        EXPECT_EQ(clip.name, name);
        EXPECT_EQ(clip.waves.empty(), hasSections(*rig));
        if (hasSections(*rig)) continue;
        for (const Wave& wave : clip.waves) {
          EXPECT_NEAR(wave.amplitude.y, 0, 1e-6);
          const float swings = clip.duration / wave.period;
          EXPECT_NEAR(swings, std::round(swings), 1e-4) << "the clip does not end where it began";
        }
        const ClipReport report = proveClip(clip, 0, rest, size);
        EXPECT_GT(report.leaves_box, 0.05f);
        EXPECT_LT(report.leaves_box, 0.35f);
      }
    }
  }
}

}  // namespace
}  // namespace kelp
