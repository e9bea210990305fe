// SPDX-License-Identifier: MIT
#include "kelp/runtime/spring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "loaded.h"
#include "support/edit_knots.h"
#include "support/voxel_knots.h"

namespace kelp::runtime {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kHuge = 3e38f;

// x'' = -w^2 (x - held) - 2 z w x', by Runge and Kutta's steps of 10 microseconds.
struct Reference {
  double omega, damping, held, x = 0, v = 0;

  void advance(double seconds) {
    const int steps = static_cast<int>(std::ceil(seconds / 1e-5));
    const double h = seconds / steps;
    const auto pull = [&](double p, double q) {
      return -omega * omega * (p - held) - 2 * damping * omega * q;
    };
    for (int i = 0; i < steps; ++i) {
      const double x1 = v, v1 = pull(x, v);
      const double x2 = v + h / 2 * v1, v2 = pull(x + h / 2 * x1, v + h / 2 * v1);
      const double x3 = v + h / 2 * v2, v3 = pull(x + h / 2 * x2, v + h / 2 * v2);
      const double x4 = v + h * v3, v4 = pull(x + h * x3, v + h * v3);
      x += h / 6 * (x1 + 2 * x2 + 2 * x3 + x4);
      v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
  }
};

bool isFinite(const Spring& spring) {
  for (int part = 0; part < spring.parts(); ++part) {
    for (const Swing& s : spring.knots(part)) {
      for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(s.offset[i]) || !std::isfinite(s.velocity[i])) return false;
      }
    }
  }
  return true;
}

TEST(Spring, SwingsAsTheEquationSays) {
  Loaded loaded(reed({0, 1}));
  for (const float damping : {0.0f, 0.2f, 0.9f, 0.99999f, 1.0f, 1.00001f, 1.5f, 20.0f}) {
    for (const float frequency : {0.3f, 2.0f}) {
      SCOPED_TRACE(testing::Message() << "damping " << damping << ", " << frequency << " Hz");
      Spring spring = *Spring::create(*loaded.asset, {frequency, damping, 0.6f, true});
      const double omega = 2 * std::numbers::pi * static_cast<double>(frequency);
      const float wind = 0.1f * static_cast<float>(omega * omega), blow = 0.2f * static_cast<float>(omega);
      ASSERT_TRUE(spring.setWind(0, {wind, 0, 0}));
      ASSERT_TRUE(spring.push(0, {0, 0, blow}));
      Reference x{omega, static_cast<double>(damping), 0.1}, z{omega, static_cast<double>(damping), 0};
      z.v = static_cast<double>(blow);
      for (const float seconds : {0.001f, 0.016f, 0.25f, 0.016f, 1.3f}) {
        ASSERT_TRUE(spring.step(seconds));
        x.advance(static_cast<double>(seconds));
        z.advance(static_cast<double>(seconds));
        const Swing tip = spring.knots(0)[1];
        EXPECT_NEAR(tip.offset.x, x.x, 5e-7);
        EXPECT_NEAR(tip.offset.z, z.x, 5e-7);
        EXPECT_NEAR(tip.velocity.x, x.v, 5e-7 * omega);
        EXPECT_NEAR(tip.velocity.z, z.v, 5e-7 * omega);
      }
      EXPECT_EQ(spring.knots(0)[0].offset, glm::vec3(0)) << "the root stays";
    }
  }
}

TEST(Spring, TwoHalfStepsAreOne) {
  Loaded loaded(reed({0, 0.4f, 1}));
  for (const float damping : {0.1f, 1.0f, 3.0f}) {
    Spring one = *Spring::create(*loaded.asset, {1.7f, damping});
    Spring many = *Spring::create(*loaded.asset, {1.7f, damping});
    for (Spring* spring : {&one, &many}) {
      ASSERT_TRUE(spring->setWind(0, {7.5f, 0, -2.5f}));
      ASSERT_TRUE(spring->push(0, {-1.25f, 0.5f, 0.75f}));
    }
    for (int step = 0; step < 20; ++step) {
      ASSERT_TRUE(one.step(1.0f / 16));
      for (int half = 0; half < 2; ++half) ASSERT_TRUE(many.step(1.0f / 32));
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(glm::distance(one.knots(0)[i].offset, many.knots(0)[i].offset), 1e-5f);
        EXPECT_LT(glm::distance(one.knots(0)[i].velocity, many.knots(0)[i].velocity), 1e-4f);
      }
    }
  }
}

TEST(Spring, LosesEnergyAndComesToRest) {
  Loaded loaded(reed({0, 0.4f, 1}));
  Spring spring = *Spring::create(*loaded.asset, {2.0f, 0.1f});
  const float omega = 2 * std::numbers::pi_v<float> * 2;
  ASSERT_TRUE(spring.push(0, {2, 0, -1.5f}));
  float before = HUGE_VALF;
  for (int step = 0; step < 600; ++step) {
    ASSERT_TRUE(spring.step(1.0f / 60));
    float energy = 0;
    for (const Swing& s : spring.knots(0))
      energy += glm::dot(s.velocity, s.velocity) + omega * omega * glm::dot(s.offset, s.offset);
    EXPECT_LE(energy, before);
    before = energy;
  }
  for (const Swing& s : spring.knots(0)) EXPECT_LT(glm::length(s.offset), 2.5e-5f);
  ASSERT_TRUE(spring.push(0, {2, 0, -1.5f}));
  spring.reset();
  EXPECT_EQ(spring.knots(0)[2].velocity, glm::vec3(0));
}

// Euler and Bernoulli: the beam's deflection under a load at its end is d (3 s^2 - s^3) / 2.
TEST(Spring, TwoKnotsBendAsABeam) {
  Loaded loaded(reed({0, 1}));
  Spring spring = *Spring::create(*loaded.asset, {1.0f, 4.0f});
  const float omega = 2 * std::numbers::pi_v<float>;
  ASSERT_TRUE(spring.setWind(0, omega * omega * glm::vec3(0.15f, 0, -0.075f)));
  ASSERT_TRUE(spring.step(1000));
  Pose pose = *Pose::create(*loaded.asset);
  ASSERT_TRUE(spring.addTo(pose));
  const Segment segment = makeSegment(pose.knots(0)[0], pose.knots(0)[1], 40);
  for (int i = 0; i <= 20; ++i) {
    const double s = i / 20.0, share = (3 * s * s - s * s * s) / 2;
    const glm::vec3 at = evaluate(segment, static_cast<float>(s));
    EXPECT_NEAR(at.x, 6 * share, 2e-5);
    EXPECT_NEAR(at.y, 40 * s, 2e-5);
    EXPECT_NEAR(at.z, -3 * share, 2e-5);
  }
}

// Six knots in wind: the even load's s^2 (s^2 - 4 s + 6) / 3, between the knots too.
TEST(Spring, ManyKnotsBendAsABeamInWind) {
  Loaded loaded(reed({0, 0.15f, 0.4f, 0.6f, 0.85f, 1}));
  Spring spring = *Spring::create(*loaded.asset, {1.0f, 4.0f});
  const float omega = 2 * std::numbers::pi_v<float>;
  ASSERT_TRUE(spring.setWind(0, omega * omega * glm::vec3(0.25f, 0, 0)));
  ASSERT_TRUE(spring.step(1000));
  Pose pose = *Pose::create(*loaded.asset);
  ASSERT_TRUE(spring.addTo(pose));
  for (std::size_t k = 0; k + 1 < 6; ++k) {
    const Segment segment = makeSegment(pose.knots(0)[k], pose.knots(0)[k + 1], 40);
    for (int i = 0; i <= 8; ++i) {
      const glm::vec3 at = evaluate(segment, static_cast<float>(i) / 8);
      const double s = static_cast<double>(at.y) / 40;
      EXPECT_NEAR(at.x, 10 * s * s * (s * s - 4 * s + 6) / 3, i % 8 == 0 ? 1e-4 : 0.05) << s;
    }
  }
  // A storm leans the tip by the reach and no more.
  ASSERT_TRUE(spring.setWind(0, {0, 0, kHuge}));
  ASSERT_TRUE(spring.step(1000));
  EXPECT_NEAR(spring.knots(0)[5].offset.z, 0.6f, 2.5e-5f);
}

TEST(Spring, WithoutARootAllKnotsMoveAlike) {
  Loaded loaded(reed({0, 0.5f, 1}));
  Spring spring = *Spring::create(*loaded.asset, {1.0f, 0.0f, 1.0f, false});
  ASSERT_TRUE(spring.push(0, {0.5f, 0, 0}));
  ASSERT_TRUE(spring.step(0.25f));  // a quarter of a swing
  const float far = 0.5f / (2 * std::numbers::pi_v<float>);
  Pose pose = *Pose::create(*loaded.asset);
  ASSERT_TRUE(spring.addTo(pose));
  for (const Knot& knot : pose.knots(0)) {
    EXPECT_NEAR(knot.position.x, far, 2e-6f);
    EXPECT_NEAR(knot.tangent.x, 0, 2e-6f);
  }
}

// The distance of the middle line to a point, by many samples in double precision.
double distanceTo(const glm::vec3& point, const Pose& pose, const glm::mat4& part_to_world) {
  double least = HUGE_VAL;
  const std::vector<Knot> k = test::inVoxels(pose.knots(0), 40);
  for (std::size_t i = 0; i + 1 < k.size(); ++i) {
    const double share = static_cast<double>(k[i + 1].at) - static_cast<double>(k[i].at);
    for (int step = 0; step <= 500; ++step) {
      const double t = step / 500.0, u = 1 - t;
      const glm::dvec3 s = (1 + 2 * t) * u * u * glm::dvec3(k[i].position) +
                           t * u * u * share * glm::dvec3(k[i].tangent) +
                           t * t * (3 - 2 * t) * glm::dvec3(k[i + 1].position) -
                           t * t * u * share * glm::dvec3(k[i + 1].tangent);
      const glm::dvec3 world = glm::dmat4(part_to_world) * glm::dvec4(s + glm::dvec3(12, 0, 12), 1);
      least = std::min(least, glm::distance(world, glm::dvec3(point)));
    }
  }
  return least;
}

TEST(Spring, ASpherePushesItAway) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> d(-1, 1);
  int touched = 0;
  for (const bool two : {true, false}) {
    Loaded loaded(two ? reed({0, 1}) : reed({0, 0.3f, 0.65f, 1}));
    for (int i = 0; i < 200; ++i) {
      Pose pose = *Pose::create(*loaded.asset);
      test::edit(pose, 0, 40).back().position.x += 10 * d(random);
      Instance instance{loaded.asset.get(), &pose};
      instance.to_world = glm::translate(glm::mat4(1), glm::vec3(100, 2, -50)) *
                          glm::rotate(glm::mat4(1), 3 * d(random), glm::vec3(0.6f, 0.8f, 0)) *
                          glm::scale(glm::mat4(1), glm::vec3(1.5f, 2.0f, 1.5f));
      // Beside the upper half of the reed, one unit high before it is scaled, and touching it or nearly.
      const float height = 0.75f + 0.25f * d(random);
      const glm::vec3 place(instance.to_world * glm::vec4(0.15f * d(random), height, 0.15f * d(random), 1));
      const float radius = 0.2f;
      Spring spring = *Spring::create(*loaded.asset, {1.0f, 0.2f, 1.0f, true});
      const glm::mat4 part_to_world = partToWorld(instance, 0).value();
      const double before = distanceTo(place, pose, part_to_world);
      ASSERT_TRUE(spring.pushAway(instance, place, radius));
      EXPECT_EQ(spring.knots(0)[0].offset, glm::vec3(0));
      if (before > 0.2) {
        EXPECT_EQ(spring.knots(0).back().offset, glm::vec3(0)) << "nothing touched";
        continue;
      }
      ++touched;
      ASSERT_TRUE(spring.addTo(pose));
      EXPECT_TRUE(pose.check());
      EXPECT_GT(distanceTo(place, pose, part_to_world), 0.97 * 0.2) << before;
    }
  }
  EXPECT_GT(touched, 100);
}

TEST(Spring, ASphereStopsWhatComesTowardsIt) {
  Loaded loaded(reed({0, 1}));
  Spring spring = *Spring::create(*loaded.asset, {1.0f, 0.2f});
  const Instance instance{loaded.asset.get(), nullptr};
  ASSERT_TRUE(spring.push(0, {1, 0, 0.25f}));
  // stands on the side of +x, the reed on the origin
  ASSERT_TRUE(spring.pushAway(instance, {0.15f, 0.9f, 0}, 0.2f));
  EXPECT_LT(spring.knots(0)[1].offset.x, -0.025f);
  EXPECT_NEAR(spring.knots(0)[1].velocity.x, 0, 2.5e-5f);
  EXPECT_NEAR(spring.knots(0)[1].velocity.z, 0.25f, 2.5e-3f);
}

TEST(Spring, NothingAbsurdMakesNumbersThatAreNone) {
  Loaded loaded(reed({0, 0.3f, 1}));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto any = [&] { return unit(random) * std::pow(10.0f, 38 * unit(random)); };
  for (const float damping : {0.0f, 0.3f, 1.0f, kHuge}) {
    for (const float frequency : {1e-30f, 1.0f, 10000.0f}) {
      Spring spring = *Spring::create(*loaded.asset, {frequency, damping});
      Pose pose = *Pose::create(*loaded.asset);
      for (int i = 0; i < 300; ++i) {
        ASSERT_TRUE(spring.push(0, {any(), any(), any()}));
        ASSERT_TRUE(spring.setWind(0, {any(), any(), any()}));
        pose.reset();
        const Instance instance{loaded.asset.get(), &pose};
        ASSERT_TRUE(spring.pushAway(
            instance, i % 2 ? glm::vec3(any(), any(), any()) : glm::vec3(0.1f, 0.5f, 0), std::abs(any())));
        ASSERT_TRUE(spring.step(std::abs(any())));
        ASSERT_TRUE(isFinite(spring)) << i;
        ASSERT_TRUE(spring.addTo(pose));
        ASSERT_TRUE(pose.check()) << i;
      }
    }
  }
}

// One push carries no knot farther than its reach.
TEST(Spring, PushesStayWithinReach) {
  Loaded loaded(reed({0, 0.5f, 1}));
  Spring spring = *Spring::create(*loaded.asset, {1.0f, 0.0f, 0.5f, true});
  for (int i = 0; i < 400; ++i) {
    if (i % 40 == 0) {
      ASSERT_TRUE(spring.push(0, {25, 0, 0}));
    }
    ASSERT_TRUE(spring.step(0.01f));
    EXPECT_LT(glm::length(spring.knots(0)[2].offset), 0.5f * 1.0001f);
    EXPECT_LT(glm::length(spring.knots(0)[1].offset), 0.5f * 0.5f);
  }
}

// Nor does a body, however large.
TEST(Spring, SpheresPushNoFartherThanReach) {
  Loaded loaded(reed({0, 0.5f, 1}));
  for (const float radius : {1.0f, 100.0f, 1e20f}) {
    Spring spring = *Spring::create(*loaded.asset, {1.0f, 0.2f, 0.5f, true});
    ASSERT_TRUE(spring.pushAway({loaded.asset.get(), nullptr}, {0.02f, 0.8f, 0}, radius));
    const float far = glm::length(spring.knots(0)[2].offset);
    EXPECT_LT(far, 0.5f * 1.0001f);
    EXPECT_GT(far, 0.5f * 0.9f);
  }
}

TEST(Spring, MisuseIsAnswered) {
  Loaded loaded(reed({0, 1}));
  Loaded other(reed({0, 0.5f, 1}));
  Spring spring = *Spring::create(*loaded.asset);
  Pose foreign = *Pose::create(*other.asset);
  EXPECT_EQ(spring.addTo(foreign).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.pushAway({other.asset.get(), nullptr}, {0, 0, 0}, 1).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.pushAway({loaded.asset.get(), &foreign}, {0, 0, 0}, 1).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.pushAway({nullptr, nullptr}, {0, 0, 0}, 1).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.pushAway({loaded.asset.get(), nullptr}, {0, kNan, 0}, 1).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.pushAway({loaded.asset.get(), nullptr}, {0, 0, 0}, kNan).error().code, ErrorCode::kMisuse);
  for (const int part : {-1, 1}) {
    EXPECT_EQ(spring.push(part, {1, 0, 0}).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(spring.setWind(part, {1, 0, 0}).error().code, ErrorCode::kMisuse);
    EXPECT_TRUE(spring.knots(part).empty());
  }
  EXPECT_EQ(spring.push(0, {0, kNan, 0}).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(spring.setWind(0, {0, 0, HUGE_VALF}).error().code, ErrorCode::kMisuse);
  for (const float seconds : {-1e-3f, kNan, HUGE_VALF})
    EXPECT_EQ(spring.step(seconds).error().code, ErrorCode::kMisuse);
  EXPECT_TRUE(spring.step(0));
  EXPECT_EQ(spring.knots(0)[1].velocity, glm::vec3(0)) << "nothing of all that was done";
  for (const SpringOptions& bad :
       {SpringOptions{0}, SpringOptions{-1}, SpringOptions{kNan}, SpringOptions{1e6f},
        SpringOptions{1, -0.1f}, SpringOptions{1, kNan}, SpringOptions{1, HUGE_VALF}, SpringOptions{1, 1, 0},
        SpringOptions{1, 1, kNan}}) {
    EXPECT_EQ(Spring::create(*loaded.asset, bad).error().code, ErrorCode::kMisuse);
  }
}

TEST(Spring, AllocatesOnlyWhereItIsCreated) {
  Loaded loaded(reed({0, 0.5f, 1}));
  int calls = 0;
  Allocator counting;
  counting.user = &calls;
  counting.allocate = [](void* user, std::size_t bytes) {
    ++*static_cast<int*>(user);
    return std::malloc(bytes);
  };
  Spring spring = *Spring::create(*loaded.asset, {}, counting);
  Pose pose = *Pose::create(*loaded.asset, counting);
  const int created = calls;
  EXPECT_GT(created, 1);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(spring.push(0, {1, 0, 0}));
    ASSERT_TRUE(spring.step(0.1f));
    ASSERT_TRUE(spring.pushAway({loaded.asset.get(), &pose}, {0, 0.5f, 0}, 1));
    ASSERT_TRUE(spring.addTo(pose));
  }
  EXPECT_EQ(calls, created);
  Allocator none;
  none.allocate = [](void*, std::size_t) -> void* { return nullptr; };
  EXPECT_EQ(Spring::create(*loaded.asset, {}, none).error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(Pose::create(*loaded.asset, none).error().code, ErrorCode::kOutOfMemory);
}

}  // namespace
}  // namespace kelp::runtime
