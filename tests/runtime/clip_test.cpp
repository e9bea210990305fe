// SPDX-License-Identifier: MIT
// Clips against their definition (kelp/formats/model.h), evaluated in long double.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "kelp/runtime/pose.h"
#include "loaded.h"

namespace kelp::runtime {
namespace {

using Exact = long double;

Exact swing(const Wave& wave, double seconds) {
  const Exact turns = std::fmod(static_cast<Exact>(seconds) / static_cast<Exact>(wave.period), 1.0L) +
                      static_cast<Exact>(wave.phase);
  return std::sin(2 * std::numbers::pi_v<Exact> * turns);
}

// Two parts, and 40 waves of 11 periods, some of which move the same vector with the same period.
RawPack waves() {
  RawPack pack = reed({0, 0.3f, 0.65f, 1});
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "second";
  RawClip clip;
  clip.name = "many";
  clip.duration = 4;
  std::mt19937 random(6);
  std::uniform_real_distribution<float> d(-1, 1);
  const float periods[] = {0.9f, 4.0f, 1.3f, 2.0f, 17.0f, 0.05f, 3.3f, 6.0f, 1.0f, 0.7f, 2.5f};
  for (std::uint32_t i = 0; i < 40; ++i) {
    clip.waves.push_back({i % 2,
                          i % 3 + i / 20,
                          i % 5 ? Target::kKnotOffset : Target::kKnotTangent,
                          {d(random), d(random), d(random)},
                          periods[i % 11],
                          3 * d(random)});
  }
  clip.waves.push_back(clip.waves[3]);
  pack.clips.push_back(clip);
  return pack;
}

// Play time does not wear the phases out: from before the start to after a thousand hours.
TEST(Clip, WavesAreSinesWheneverTheyAreAsked) {
  const RawPack pack = waves();
  Loaded loaded(pack);
  Pose pose = *Pose::create(*loaded.asset);
  std::mt19937 random(7);
  for (const double span : {1.0, 60.0, 3600.0, 3.6e5, 3.6e6}) {
    std::uniform_real_distribution<double> time(-span, span);
    for (int n = 0; n < 100; ++n) {
      const double seconds = time(random);
      pose.reset();
      ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 0.75f, pose));
      for (int part = 0; part < 2; ++part) {
        for (std::uint32_t knot = 0; knot < 4; ++knot) {
          for (const Target target : {Target::kKnotOffset, Target::kKnotTangent}) {
            Exact sum[3] = {}, most = 0;
            for (const Wave& wave : pack.clips[0].waves) {
              if (static_cast<int>(wave.part) != part || wave.knot != knot || wave.target != target) continue;
              for (int i = 0; i < 3; ++i)
                sum[i] += 0.75L * static_cast<Exact>(wave.amplitude[i]) * swing(wave, seconds);
              most += 1;
            }
            const Knot& rest = pack.parts[static_cast<std::size_t>(part)].knots[knot];
            const Knot& now = pose.knots(part)[knot];
            const glm::vec3 moved =
                target == Target::kKnotOffset ? now.position - rest.position : now.tangent - rest.tangent;
            // A millionth of each wave, and the rounding of numbers up to 40.
            for (int i = 0; i < 3; ++i)
              EXPECT_NEAR(static_cast<double>(moved[i]), static_cast<double>(sum[i]),
                          1e-6 * static_cast<double>(most) + 4e-6)
                  << seconds;
          }
        }
      }
    }
  }
}

// The sine by itself, without the rounding of where it is added: amplitudes on knots whose rest is zero.
TEST(Clip, SinesErrByLessThanAMillionth) {
  RawPack pack = reed({0, 1});
  RawClip clip;
  clip.name = "sine";
  clip.duration = 1;
  clip.waves.push_back({0, 0, Target::kKnotOffset, {1, 0, 0}, 1.0f, 0.0f});
  clip.waves.push_back({0, 0, Target::kKnotOffset, {0, 0, 1}, 1.0f, 0.25f});
  pack.clips.push_back(clip);
  Loaded loaded(pack);
  Pose pose = *Pose::create(*loaded.asset);
  double worst = 0;
  for (int i = -20000; i <= 20000; ++i) {
    const double seconds = i / 10000.0;
    pose.reset();
    ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1, pose));
    const glm::vec3 p = pose.knots(0)[0].position;
    worst = std::max(worst, std::abs(static_cast<double>(p.x) - std::sin(2 * std::numbers::pi * seconds)));
    worst = std::max(worst, std::abs(static_cast<double>(p.z) - std::cos(2 * std::numbers::pi * seconds)));
  }
  EXPECT_LT(worst, 4e-7);
}

TEST(Clip, TimesBeyondAllPhasesAreHarmless) {
  const RawPack pack = waves();
  Loaded loaded(pack);
  Pose pose = *Pose::create(*loaded.asset);
  for (const double seconds : {1e15, -1e16, 3e17, 1e300, -1.7e308}) {
    pose.reset();
    ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1, pose));
    for (const Knot& knot : pose.knots(0)) EXPECT_LT(glm::length(knot.position), 20.0f) << seconds;
  }
}

RawPack keyed(Interpolation interpolation, const std::vector<Key>& keys) {
  RawPack pack = reed({0, 1});
  RawClip clip;
  clip.name = "keys";
  clip.duration = 3;
  RawTrack track;
  track.knot = 1;
  track.target = Target::kKnotTangent;
  track.interpolation = interpolation;
  track.keys = keys;
  clip.tracks.push_back(track);
  pack.clips.push_back(clip);
  return pack;
}

TEST(Clip, TimesOfWhichTheDurationIsNoShareAreHarmless) {
  for (const float duration : {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(),
                               std::numeric_limits<float>::max()}) {
    RawPack pack =
        keyed(Interpolation::kLinear, {{0, {7, 0, 0, 0}, {}, {}}, {duration, {7, 0, 0, 0}, {}, {}}});
    pack.clips[0].duration = duration;
    Loaded loaded(pack);
    Pose pose = *Pose::create(*loaded.asset);
    const float rest = pose.knots(0)[1].tangent.x;
    for (const double seconds : {0.0, 1e-320, -1e-320, 3.0, -3.0, 1e263, 1e300, -1e300,
                                 std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()}) {
      pose.reset();
      ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1, pose));
      EXPECT_EQ(pose.knots(0)[1].tangent.x, rest + 7) << duration << ' ' << seconds;
    }
  }
}

TEST(Clip, TracksStepGoStraightAndCurve) {
  std::vector<Key> keys(4);
  const float times[] = {0.25f, 1.0f, 1.5f, 2.75f}, values[] = {1, -2, 3, 0.5f}, in[] = {0, 2, -1, 4},
              out[] = {3, -2, 0.5f, 0};
  for (std::size_t i = 0; i < 4; ++i) keys[i] = {times[i], {values[i], 0, -values[i], 0}, {}, {}};
  for (const Interpolation interpolation :
       {Interpolation::kStep, Interpolation::kLinear, Interpolation::kCubic}) {
    if (interpolation == Interpolation::kCubic) {
      for (std::size_t i = 0; i < 4; ++i) keys[i].in.x = in[i], keys[i].out.x = out[i];
    }
    Loaded loaded(keyed(interpolation, keys));
    Pose pose = *Pose::create(*loaded.asset);
    for (int n = 0; n < 300; ++n) {
      const double seconds = n / 100.0 + 3 * (n % 7) - 9;  // any repetition of the three seconds
      const double t = n / 100.0;
      std::size_t k = 0;
      while (k < 4 && static_cast<double>(times[k]) <= t) ++k;
      double expected;
      if (k == 0) {
        expected = values[0];
      } else if (k == 4) {
        expected = values[3];
      } else {
        const double dt = static_cast<double>(times[k]) - static_cast<double>(times[k - 1]),
                     u = (t - static_cast<double>(times[k - 1])) / dt;
        const double a = values[k - 1], b = values[k];
        switch (interpolation) {
          case Interpolation::kStep:
            expected = a;
            break;
          case Interpolation::kLinear:
            expected = a + u * (b - a);
            break;
          default:
            expected = (1 + 2 * u) * (1 - u) * (1 - u) * a +
                       u * (1 - u) * (1 - u) * dt * static_cast<double>(out[k - 1]) +
                       u * u * (3 - 2 * u) * b - u * u * (1 - u) * dt * static_cast<double>(in[k]);
        }
      }
      pose.reset();
      ASSERT_TRUE(addClip(*loaded.asset, 0, seconds, 1, pose));
      // At the very time of a key a step may still be to come.
      const bool at_key =
          interpolation == Interpolation::kStep && (n == 25 || n == 100 || n == 150 || n == 275);
      if (!at_key) {
        EXPECT_NEAR(pose.knots(0)[1].tangent.x, expected, 5e-5) << t;
      }
    }
    // Once, not again and again: held short of the end.
    pose.reset();
    ASSERT_TRUE(addClip(*loaded.asset, 0, std::nextafter(3.0, 0.0), 1, pose));
    EXPECT_NEAR(pose.knots(0)[1].tangent.x, 0.5f, 1e-5f);
  }
}

}  // namespace
}  // namespace kelp::runtime
