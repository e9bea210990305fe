// SPDX-License-Identifier: MIT
// The proof against dense sampling in double precision: it may never accept what a sample refutes, must
// accept what is clearly fine, and its bounds hold every sampled point.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "kelp/rig/rig.h"
#include "support/all_tests.h"
#include "support/voxel_knots.h"

namespace kelp {
namespace {

// Knots and clip in voxels.
ClipReport prove(const RawClip& clip, std::uint32_t part, const std::vector<Knot>& knots,
                 const glm::ivec3& size, std::uint64_t automatic = 0) {
  const auto height = static_cast<float>(size.y);
  return proveClip(test::inHeights(clip, height), part, {test::inHeights(knots, height), automatic}, size);
}

using DVec = std::array<double, 3>;

double trackAt(const RawTrack& track, int axis, double time) {
  const auto& keys = track.keys;
  if (time <= static_cast<double>(keys.front().time)) return keys.front().value[axis];
  if (time >= static_cast<double>(keys.back().time)) return keys.back().value[axis];
  std::size_t i = 0;
  while (time >= static_cast<double>(keys[i + 1].time)) ++i;
  const double dt = static_cast<double>(keys[i + 1].time) - static_cast<double>(keys[i].time);
  const double u = (time - static_cast<double>(keys[i].time)) / dt;
  const double v0 = keys[i].value[axis], v1 = keys[i + 1].value[axis];
  if (track.interpolation == Interpolation::kStep) return v0;
  if (track.interpolation == Interpolation::kLinear) return v0 + u * (v1 - v0);
  const double h00 = 2 * u * u * u - 3 * u * u + 1, h10 = u * u * u - 2 * u * u + u,
               h01 = 3 * u * u - 2 * u * u * u, h11 = u * u * u - u * u;
  return h00 * v0 + h10 * dt * static_cast<double>(keys[i].out[axis]) + h01 * v1 +
         h11 * dt * static_cast<double>(keys[i + 1].in[axis]);
}

struct Pose {
  std::vector<DVec> position, tangent;
};

// Automatic tangents follow the offsets, unless the clip moves them itself.
void follow(const RawClip& clip, std::span<const Knot> knots, std::uint64_t automatic, Pose& pose) {
  for (const Wave& wave : clip.waves)
    if (wave.target == Target::kKnotTangent) automatic &= ~(std::uint64_t{1} << wave.knot);
  for (const RawTrack& track : clip.tracks)
    if (track.target == Target::kKnotTangent) automatic &= ~(std::uint64_t{1} << track.knot);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!(automatic >> i & 1)) continue;
    const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, knots.size() - 1);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const auto offset = [&](std::size_t k) {
        return pose.position[k][a] - static_cast<double>(knots[k].position[axis]);
      };
      pose.tangent[i][a] +=
          (offset(after) - offset(before)) / static_cast<double>(knots[after].at - knots[before].at);
    }
  }
}

Pose poseAt(const RawClip& clip, std::span<const Knot> knots, double time, std::uint64_t automatic = 0) {
  Pose pose;
  for (const Knot& knot : knots) {
    pose.position.push_back({knot.position.x, knot.position.y, knot.position.z});
    pose.tangent.push_back({knot.tangent.x, knot.tangent.y, knot.tangent.z});
  }
  for (const Wave& wave : clip.waves) {
    const double s = std::sin(2 * std::numbers::pi *
                              (time / static_cast<double>(wave.period) + static_cast<double>(wave.phase)));
    for (int axis = 0; axis < 3; ++axis)
      (wave.target == Target::kKnotOffset ? pose.position
                                          : pose.tangent)[wave.knot][static_cast<std::size_t>(axis)] +=
          static_cast<double>(wave.amplitude[axis]) * s;
  }
  for (const RawTrack& track : clip.tracks) {
    if (track.target != Target::kKnotOffset && track.target != Target::kKnotTangent) continue;
    for (int axis = 0; axis < 3; ++axis)
      (track.target == Target::kKnotOffset ? pose.position
                                           : pose.tangent)[track.knot][static_cast<std::size_t>(axis)] +=
          trackAt(track, axis, std::fmod(time, static_cast<double>(clip.duration)));
  }
  follow(clip, knots, automatic, pose);
  return pose;
}

double hermite(double p0, double m0, double p1, double m1, double t) {
  return (2 * t * t * t - 3 * t * t + 1) * p0 + (t * t * t - 2 * t * t + t) * m0 +
         (3 * t * t - 2 * t * t * t) * p1 + (t * t * t - t * t) * m1;
}

// The results of sampling: the deepest fall of Sy, and the smallest slope, both in units of the segment's
// rise; and the box of all samples.
struct Sampled {
  double fall = 0, least_slope = 1e30;
  bool rises = true;
  Box box;
};

Sampled sample(const RawClip& clip, std::span<const Knot> knots, const glm::ivec3& size, double seconds,
               int times, std::uint64_t automatic = 0) {
  Sampled sampled;
  for (int i = 0; i < times; ++i) {
    const Pose pose = poseAt(clip, knots, seconds * i / times, automatic);
    for (std::size_t s = 0; s + 1 < knots.size(); ++s) {
      const double share = static_cast<double>(knots[s + 1].at) - static_cast<double>(knots[s].at);
      const double rise = pose.position[s + 1][1] - pose.position[s][1];
      if (rise <= 0) sampled.rises = false;
      double highest = -1e30, before = 0;
      constexpr int kSteps = 100;
      for (int k = 0; k <= kSteps; ++k) {
        const double t = static_cast<double>(k) / kSteps;
        DVec p{};
        for (std::size_t a = 0; a < 3; ++a)
          p[a] = hermite(pose.position[s][a], share * pose.tangent[s][a], pose.position[s + 1][a],
                         share * pose.tangent[s + 1][a], t);
        highest = std::max(highest, p[1]);
        sampled.fall = std::max(sampled.fall, (highest - p[1]) / std::abs(rise));
        if (k > 0)
          sampled.least_slope = std::min(sampled.least_slope, (p[1] - before) * kSteps / std::abs(rise));
        before = p[1];
        sampled.box.add(glm::vec3(p[0], p[1], p[2]));
        sampled.box.add(glm::vec3(p[0] + size.x, p[1], p[2] + size.z));
      }
    }
  }
  return sampled;
}

struct Scene {
  std::vector<Knot> knots;
  RawClip clip;
  std::uint64_t automatic = 0;
};

// `strength` scales everything that moves y.
Scene randomScene(std::mt19937& random, const glm::ivec3& size, float strength) {
  const auto uniform = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const auto vec = [&] {
    return static_cast<float>(size.y) * glm::vec3(uniform(-1, 1), strength * uniform(-1, 1), uniform(-1, 1));
  };
  constexpr std::array<float, 6> kPeriods{1, 2, 3, 0.75f, 1.41421356f, 4.1f};
  Scene scene;
  const int knots = 2 + below(3);
  const auto length = static_cast<float>(size.y);
  for (int i = 0; i < knots; ++i) {
    const float at = static_cast<float>(i) / static_cast<float>(knots - 1);
    scene.knots.push_back({at,
                           {uniform(-9, 9), at * length, uniform(-9, 9)},
                           {uniform(-50, 50), length * (below(3) ? uniform(0, 2) : 0.0f), uniform(-50, 50)}});
  }
  scene.automatic = random() & ((1u << knots) - 1);
  scene.clip = {"random", uniform(1, 3), {}, {}};
  for (int w = below(4); w > 0; --w)
    scene.clip.waves.push_back({0, static_cast<std::uint32_t>(below(knots)),
                                below(2) ? Target::kKnotOffset : Target::kKnotTangent, vec(),
                                kPeriods[static_cast<std::size_t>(below(6))], uniform(0, 1)});
  for (int t = below(3); t > 0; --t) {
    RawTrack track{0,
                   static_cast<std::uint32_t>(below(knots)),
                   below(2) ? Target::kKnotOffset : Target::kKnotTangent,
                   static_cast<Interpolation>(below(3)),
                   {}};
    float time = uniform(0, 0.5f);
    for (int k = 1 + below(4); k > 0; --k) {
      if (time > scene.clip.duration) break;
      track.keys.push_back({time, glm::vec4(vec(), 0), glm::vec4(vec(), 0), glm::vec4(vec(), 0)});
      time += uniform(0.1f, 1);
    }
    scene.clip.tracks.push_back(track);
  }
  return scene;
}

bool accepted(const Scene& scene, const glm::ivec3& size, ClipReport* report = nullptr,
              std::string* error = nullptr) {
  try {
    const ClipReport r = prove(scene.clip, 0, scene.knots, size, scene.automatic);
    if (report) *report = r;
    return true;
  } catch (const RigError& e) {
    if (error) *error = e.what();
    return false;
  }
}

TEST(ProveClip, AgreesWithDenseSampling) {
  std::mt19937 random(11);
  const glm::ivec3 size(40, 100, 60);
  int proven = 0, refused = 0, unsure = 0, rare = 0;
  constexpr int kScenes = test::shareOf(600);
  for (int i = 0; i < kScenes; ++i) {
    const Scene scene = randomScene(random, size, 0.02f * static_cast<float>(1 + i % 20));
    ClipReport report;
    std::string error;
    const bool ok = accepted(scene, size, &report, &error);
    const Sampled sampled = sample(scene.clip, scene.knots, size, 40, 1500, scene.automatic);
    if (ok) {
      ++proven;
      EXPECT_TRUE(sampled.rises) << i;
      EXPECT_LE(sampled.fall, 1e-5) << i;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(report.bounds.min[axis], sampled.box.min[axis]) << i;
        EXPECT_GE(report.bounds.max[axis], sampled.box.max[axis]) << i;
      }
      const float beyond =
          std::max({-sampled.box.min.x, -sampled.box.min.y, -sampled.box.min.z, sampled.box.max.x - 40,
                    sampled.box.max.y - 100, sampled.box.max.z - 60});
      EXPECT_GE(report.leaves_box * 100, beyond - 1e-2f) << i;
    } else {
      ++refused;
      EXPECT_EQ(error.find('\n'), std::string::npos);
      if (error.find("could not be proven") != std::string::npos) ++unsure;
      // Motions without a common period may meet badly only once in hours: not within the samples.
      if (error.find("fall together") != std::string::npos) ++rare;
      // Else not refused without cause: samples come near a turn as well.
      else
        EXPECT_TRUE(!sampled.rises || sampled.least_slope < 0.1)
            << i << ": " << error << " least slope " << sampled.least_slope;
    }
  }
  EXPECT_GT(proven, kScenes / 6);
  EXPECT_GT(refused, kScenes / 6);
  EXPECT_LE(unsure, 3);
  EXPECT_LE(rare, 6);
}

// The refusal names a time at which the spline does turn back.
TEST(ProveClip, NamesATimeThatCanBeChecked) {
  std::mt19937 random(5);
  const glm::ivec3 size(40, 100, 60);
  int checked = 0;
  for (int i = 0; i < 300; ++i) {
    const Scene scene = randomScene(random, size, 0.3f);
    std::string error;
    if (accepted(scene, size, nullptr, &error)) continue;
    const std::size_t at = error.find("axis at ");
    if (at == std::string::npos || error.find("at rest") != std::string::npos ||
        error.find("fall together") != std::string::npos)
      continue;
    const double time = std::stod(error.substr(at + 8));
    double worst = 1e30;
    for (const double nudge : {-1e-5, 0.0, 1e-5}) {  // the message rounds to six digits
      const double t = time * (1 + nudge);
      const Pose pose = poseAt(scene.clip, scene.knots, t, scene.automatic);
      for (std::size_t s = 0; s + 1 < scene.knots.size(); ++s) {
        const double share =
            static_cast<double>(scene.knots[s + 1].at) - static_cast<double>(scene.knots[s].at);
        const double rise = pose.position[s + 1][1] - pose.position[s][1];
        const double m0 = share * pose.tangent[s][1], m1 = share * pose.tangent[s + 1][1];
        for (int k = 0; k <= 1000; ++k) {
          const double u = k / 1000.0;
          worst = std::min(
              {worst, rise, (1 - u) * (1 - u) * m0 + 2 * u * (1 - u) * (3 * rise - m0 - m1) + u * u * m1});
        }
      }
    }
    EXPECT_LT(worst, 1e-3) << error;
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

std::vector<Knot> straight(float length) {
  return {{0, {0, 0, 0}, {0, length, 0}}, {1, {0, length, 0}, {0, length, 0}}};
}

TEST(ProveClip, ExtremePosesOfThePaperAreFine) {
  // Tangents without any y part: the slope is exactly 0 at both ends, at all times.
  const std::vector<Knot> knots{{0, {0, 0, 0}, {300, 0, 100}}, {1, {0, 100, 0}, {300, 0, 200}}};
  const RawClip clip{"wild",
                     3,
                     {{0, 0, Target::kKnotTangent, {-4000, 0, 0}, 1, 0},
                      {0, 1, Target::kKnotTangent, {2000, 0, -1300}, 2.7182818f, 0.3f}},
                     {}};
  EXPECT_NO_THROW(prove(clip, 0, knots, {64, 100, 64}));
}

TEST(ProveClip, KnotsThatRiseTogetherAreFine) {
  // Both ends bob by five lengths, in step: their distance never changes. Bounds of each alone would refuse
  // it.
  const RawClip clip{
      "bob",
      2,
      {{0, 0, Target::kKnotOffset, {0, 500, 0}, 2, 0.1f}, {0, 1, Target::kKnotOffset, {0, 500, 0}, 2, 0.1f}},
      {}};
  EXPECT_NO_THROW(prove(clip, 0, straight(100), {64, 100, 64}));
  // Step tracks that jump together, likewise.
  RawClip jump{"jump", 2, {}, {}};
  for (const std::uint32_t knot : {0u, 1u})
    jump.tracks.push_back({0,
                           knot,
                           Target::kKnotOffset,
                           Interpolation::kStep,
                           {{0, {0, 0, 0, 0}, {}, {}}, {0.7f, {0, 900, 0, 0}, {}, {}}}});
  EXPECT_NO_THROW(prove(jump, 0, straight(100), {64, 100, 64}));
}

TEST(ProveClip, ExactlyAtTheLimit) {
  // The tip dips to the foot: refused from an amplitude of the whole length on, by name and at the right
  // time.
  const auto dip = [](float amplitude) {
    return RawClip{"dip", 4, {{0, 1, Target::kKnotOffset, {0, amplitude, 0}, 4, 0}}, {}};
  };
  // With tangents of one length, 3 (p1 - p0) - m0 - m1 + sqrt(m0 m1) >= 0 needs p1 - p0 >= length / 3.
  EXPECT_NO_THROW(prove(dip(66.6f), 0, straight(100), {8, 100, 8}));
  try {
    prove(dip(66.9f), 0, straight(100), {8, 100, 8});
    FAIL() << "accepted";
  } catch (const RigError& error) {
    const std::string what = error.what();
    for (const char* words : {"clip 'dip'", "part 0", "knot 0 (at 0) to knot 1 (at 1)", "at 3",
                              "too long for the distance", "smaller"})
      EXPECT_NE(what.find(words), std::string::npos) << "'" << words << "' is not in: " << what;
  }
}

TEST(ProveClip, CubicKeysAtTheLimit) {
  // Two keys, none too deep; what dips between them is the overshoot, whose depth the slope sets. The limit
  // is 66.7 voxels, as above.
  const auto swing = [](float slope) {
    RawClip clip{"swing", 2, {}, {{0, 1, Target::kKnotOffset, Interpolation::kCubic, {}}}};
    clip.tracks[0].keys = {{0.25f, {0, 10, 0, 0}, {}, {0, -slope, 0, 0}},
                           {1.5f, {0, -30, 0, 0}, {0, 0.5f * slope, 0, 0}, {}}};
    return clip;
  };
  const auto depth = [&](float slope) {
    const RawClip clip = swing(slope);
    double lowest = 0;
    for (int i = 0; i <= 20000; ++i) lowest = std::min(lowest, trackAt(clip.tracks[0], 1, 2.0 * i / 20000));
    return -lowest;
  };
  float slope = 0;
  while (depth(slope) < 66.3) slope += 0.25f;
  ASSERT_LT(depth(slope), 66.6);
  EXPECT_NO_THROW(prove(swing(slope), 0, straight(100), {8, 100, 8}));
  while (depth(slope) < 66.8) slope += 0.25f;
  EXPECT_THROW(prove(swing(slope), 0, straight(100), {8, 100, 8}), RigError);
  // Bounds hold the overshoot, and not much more.
  while (depth(slope) > 60) slope -= 0.25f;
  RawClip sideways = swing(slope);
  for (Key& key : sideways.tracks[0].keys) {
    for (glm::vec4* v : {&key.value, &key.in, &key.out}) *v = {v->y, 0, 0, 0};
  }
  const ClipReport report = prove(sideways, 0, straight(100), {8, 100, 8});
  EXPECT_LE(report.bounds.min.x, static_cast<float>(-depth(slope)));
  EXPECT_GE(report.bounds.min.x, static_cast<float>(-1.6 * depth(slope)));
}

TEST(ProveClip, UnrelatedPeriodsAreTakenAtTheirWorst) {
  // 40 + 40 of 66.7 voxels: each wave alone is fine, together they are not, at times far from the start.
  RawClip clip{"beat",
               2,
               {{0, 1, Target::kKnotOffset, {0, 40, 0}, 1, 0.5f},
                {0, 1, Target::kKnotOffset, {0, 40, 0}, 1.4142135f, 0.5f}},
               {}};
  EXPECT_THROW(prove(clip, 0, straight(100), {8, 100, 8}), RigError);
  clip.waves.pop_back();
  EXPECT_NO_THROW(prove(clip, 0, straight(100), {8, 100, 8}));
  // Commensurate and never low together: one of 1 s and one of 2 s whose lows do not meet.
  const RawClip apart{
      "apart",
      2,
      {{0, 1, Target::kKnotOffset, {0, 40, 0}, 2, 0}, {0, 1, Target::kKnotOffset, {0, 40, 0}, 1, 0.25f}},
      {}};
  const Sampled sampled = sample(apart, straight(100), {8, 100, 8}, 2, 2000);
  EXPECT_EQ(sampled.fall > 1e-5, [&] {
    try {
      prove(apart, 0, straight(100), {8, 100, 8});
      return false;
    } catch (const RigError&) {
      return true;
    }
  }());
}

// The proof's cost grows with the periods that have no common multiple, so their number is limited.
TEST(ProveClip, ManyUnrelatedPeriodsAreRefused) {
  const glm::ivec3 size(8, 100, 8);
  const std::vector<Knot> knots = straight(100);
  const auto refusal = [&](int waves, const glm::vec3& amplitude) -> std::string {
    RawClip clip{"c", 1, {}, {}};
    for (int i = 0; i < waves; ++i)
      clip.waves.push_back(
          {0, 1, Target::kKnotOffset, amplitude, 1 + std::sqrt(static_cast<float>(2 * i + 3)) / 50, 0});
    try {
      prove(clip, 0, knots, size);
    } catch (const RigError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refusal(50, {0, 0.001f, 0}), "");
  EXPECT_NE(refusal(2000, {0, 0.001f, 0}).find("more than"), std::string::npos);
  EXPECT_NE(refusal(200, {0, 0.001f, 0}).find("more than 64 periods that have no common multiple"),
            std::string::npos);
  EXPECT_EQ(refusal(1000, {0.001f, 0, 0}), "");
  EXPECT_NE(refusal(1100, {0.001f, 0, 0}).find("more than 1024 periods move one segment"), std::string::npos);
}

// A count of spans alone does not bound the time: each span costs as much as it has waves.
TEST(ProveClip, ProofsEndAfterSoMuchWork) {
  RawClip clip{"c", 1, {}, {}};
  for (int period = 0; period < 60; ++period) {
    for (int harmonic = 1; harmonic <= 16; ++harmonic)
      clip.waves.push_back(
          {0,
           1,
           Target::kKnotOffset,
           {0, 0.5f / static_cast<float>(harmonic), 0},
           (10 + std::sqrt(static_cast<float>(2 * period + 3))) / static_cast<float>(harmonic),
           0});
  }
  try {
    prove(clip, 0, straight(100), {8, 100, 8});
    FAIL() << "proven";
  } catch (const RigError& error) {
    EXPECT_NE(std::string(error.what()).find("takes too long"), std::string::npos) << error.what();
  }
}

TEST(ProveClip, ManyTracksOfOneThingAreRefused) {
  RawClip clip{"c", 1, {}, {}};
  const RawTrack track{0,
                       1,
                       Target::kKnotOffset,
                       Interpolation::kLinear,
                       {{0, glm::vec4(0), {}, {}}, {1, glm::vec4(0.01f), {}, {}}}};
  clip.tracks.assign(64, track);
  EXPECT_NO_THROW(prove(clip, 0, straight(100), {8, 100, 8}));
  clip.tracks.push_back(track);
  EXPECT_THROW(prove(clip, 0, straight(100), {8, 100, 8}), RigError);
}

// A part's share says the same as the whole clip does of it.
TEST(ProveClip, ClipsAreSplitByPart) {
  RawClip clip{"c",
               2,
               {{3, 1, Target::kKnotOffset, {5, 1, 0}, 1, 0},
                {1, 1, Target::kKnotTangent, {0, 2, 0}, 2, 0.5f},
                {3, 0, Target::kKnotTangent, {0, 0, 4}, 0.5f, 0}},
               {}};
  clip.tracks.push_back({1, 0, Target::kPartTranslation, Interpolation::kStep, {{0, glm::vec4(1), {}, {}}}});
  const auto shares = splitByPart(clip);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_EQ(shares[0].first, 1u);
  EXPECT_EQ(shares[1].first, 3u);
  EXPECT_EQ(shares[0].second.waves.size(), 1u);
  EXPECT_EQ(shares[0].second.tracks.size(), 1u);
  EXPECT_EQ(shares[1].second.waves.size(), 2u);
  EXPECT_TRUE(shares[1].second.tracks.empty());
  for (const auto& [part, share] : shares) {
    EXPECT_EQ(share.name, "c");
    EXPECT_EQ(share.duration, 2);
    const ClipReport whole = prove(clip, part, straight(100), {8, 100, 8}),
                     alone = prove(share, part, straight(100), {8, 100, 8});
    EXPECT_EQ(whole.bounds.min, alone.bounds.min);
    EXPECT_EQ(whole.bounds.max, alone.bounds.max);
  }
}

TEST(ProveClip, RestRigThatTurnsBackIsRefused) {
  std::vector<Knot> knots = straight(100);
  knots[1].tangent.y = -10;
  try {
    prove({"still", 1, {}, {}}, 4, knots, {8, 100, 8});
    FAIL() << "accepted";
  } catch (const RigError& error) {
    EXPECT_NE(std::string(error.what()).find("at rest"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("tangent of knot 1"), std::string::npos) << error.what();
  }
}

TEST(ProveClip, OtherPartsDoNotMatter) {
  const RawClip clip{"other", 1, {{1, 1, Target::kKnotOffset, {0, 1e5f, 0}, 1, 0}}, {}};
  const ClipReport report = prove(clip, 0, straight(100), {8, 100, 8});
  EXPECT_EQ(report.leaves_box, 0.0f);
  EXPECT_THROW(prove(clip, 1, straight(100), {8, 100, 8}), RigError);
}

TEST(ProveClip, BoundsByHand) {
  // Tip 20 to and fro along x: the box [0,8] x [0,100] x [0,6] leaves by 20 on both sides of x.
  const RawClip clip{"side", 1, {{0, 1, Target::kKnotOffset, {20, 0, 0}, 1, 0}}, {}};
  const ClipReport report = prove(clip, 0, straight(100), {8, 100, 6});
  EXPECT_NEAR(report.bounds.min.x, -20, 0.01);
  EXPECT_NEAR(report.bounds.max.x, 28, 0.01);
  EXPECT_NEAR(report.bounds.min.y, 0, 0.01);
  EXPECT_NEAR(report.bounds.max.y, 100, 0.01);
  EXPECT_NEAR(report.bounds.max.z, 6, 0.01);
  EXPECT_NEAR(report.leaves_box, 0.2, 1e-4);
}

}  // namespace
}  // namespace kelp
