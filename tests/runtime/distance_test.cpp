// SPDX-License-Identifier: MIT
// distance() never exceeds the distance to the bent solid, and is not much less.
#include <gtest/gtest.h>

#include "expect_bounds.h"

namespace kelp::runtime {
namespace {

// Queries of each case: 10 million in all, or some seconds' worth.
int queries() { return test::allTests() ? 400'000 : test::shareOf(6'000); }

constexpr double kAtRest[3] = {0.5, 0.8, 0.6}, kBent[3] = {0.25, 0.4, 0.3};

struct DistanceQuery : testing::Test {
  fields::Occupancy volume = test::ballClump({60, 80, 50}, 20, 2);
  test::Layers layers{volume};
  std::vector<std::byte> bytes = test::bytesOf(test::distancePackOf(volume));
  MemorySource source{bytes};
  std::unique_ptr<Asset> asset = test::loadDistances(source);
};

TEST_F(DistanceQuery, NeverExceedsTheTruthInThePosesOfFigure6) {
  for (const test::FigurePose& figure : test::kFigure6) {
    SCOPED_TRACE(figure.name);
    test::BentInstance bent(*asset, layers, test::figureKnots(figure),
                            test::turned(1, glm::vec3(2, 2, -2), {100, -20, 3}), 1);
    test::Quality quality;
    test::expectBounds(bent, queries(), &quality);
    quality.expectAtLeast(figure.name, &figure == &test::kFigure6[0] ? kAtRest : kBent);
  }
}

TEST_F(DistanceQuery, NeverExceedsTheTruthWithSeveralSegmentsAndOtherMatrices) {
  const fields::Occupancy reed = test::dust({24, 90, 30}, 60, 3);
  const std::vector<Knot> rest = test::straightStem();
  const std::vector<std::byte> reed_bytes = test::bytesOf(test::distancePackOf(reed, rest));
  const MemorySource reed_source(reed_bytes);
  const test::Layers reed_layers(reed);
  const auto loaded = test::loadDistances(reed_source);
  std::vector<Knot> squashed = test::bentStem();
  for (Knot& knot : squashed) knot.position.y *= 0.3f, knot.tangent.y *= 0.3f;
  glm::mat4 sheared = test::turned(2, {1, 0.5f, 1}, {0, 0, 5});
  sheared[0] += 0.4f * sheared[1] - 0.3f * sheared[2];
  const glm::mat4 matrices[] = {glm::mat4(1), test::turned(0.4f, {0.01f, 0.01f, 0.01f}, {1, 2, 3}),
                                test::turned(2.5f, {3, 1, 0.5f}, {-7, 0, 0}),
                                test::turned(4, {-1, 2, 1}, {1000, 20, -500}), sheared};
  unsigned seed = 10;
  for (const std::vector<Knot>& knots : {rest, test::bentStem(), squashed}) {
    for (const glm::mat4& matrix : matrices) {
      SCOPED_TRACE(seed);
      test::BentInstance bent(*loaded, reed_layers, knots, matrix, seed++);
      test::expectBounds(bent, queries());
    }
  }
}

// Matrices that squeeze two axes to a k-th, by the same factor or nearly. The point lies off a corner in the
// direction that is squeezed most, where nothing is to spare.
TEST_F(DistanceQuery, NeverExceedsTheTruthOfNeedles) {
  const glm::ivec3 size(16);
  const std::vector<std::byte> full_bytes = test::bytesOf(test::distancePackOf(test::dust(size, 1, 1)));
  const MemorySource full_source(full_bytes);
  const auto loaded = test::loadDistances(full_source);
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto turn = [&] {
    return glm::mat3_cast(
        glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
  };
  for (const double thin : {1.0, 3.0, 30.0, 100.0, 1e3, 1e4}) {
    double worst = 0, loosest = 1;
    for (int i = 0; i < 600; ++i) {
      glm::dmat3 squeeze(1);
      squeeze[1][1] = 1 / thin;
      squeeze[2][2] = 1 / (thin * (i % 3 == 0 ? 1.0 : i % 3 == 1 ? 1.0001 : 0.7));
      const glm::dmat3 after = i % 2 == 0 ? glm::dmat3(1) : turn();
      Instance instance{loaded.get()};
      instance.to_world = glm::mat4(glm::mat3(std::pow(10.0, i % 7 - 3) * after * squeeze * turn()));
      const glm::dmat4 matrix(partToWorld(instance, 0).value());
      const glm::dmat3 linear(matrix);
      glm::dmat3 power = glm::inverse(glm::transpose(linear) * linear);
      for (int step = 0; step < 24; ++step) {
        power /= power[0][0] + power[1][1] + power[2][2];
        power = power * power;
      }
      const glm::dvec3 least = glm::normalize(power * glm::dvec3(1, 0.3, 0.2));
      const glm::dvec3 corner = glm::dvec3(size) * glm::step(glm::dvec3(0), least);
      const glm::vec3 point(matrix * glm::dvec4(corner + 3000.0 * least, 1));
      const double truth = glm::distance(glm::dvec3(point), glm::dvec3(matrix * glm::dvec4(corner, 1)));
      const double ratio = double{distance(instance, point)->bound} / truth;
      worst = std::max(worst, ratio), loosest = std::min(loosest, ratio);
    }
    EXPECT_LE(worst, 1) << thin;
    EXPECT_GT(loosest, 0.99) << thin;
  }
}

TEST_F(DistanceQuery, NeverExceedsTheTruthWithCoarserLevelsOnly) {
  for (const int finest : {1, 2, 3}) {
    const auto coarse = test::loadDistances(source, finest);
    for (const int figure : {0, 1, 4}) {
      SCOPED_TRACE(finest);
      test::BentInstance bent(*coarse, layers,
                              test::figureKnots(test::kFigure6[static_cast<std::size_t>(figure)]),
                              test::turned(3, glm::vec3(2, 2, 2), {1, 2, 3}), 77);
      test::expectBounds(bent, queries());
    }
  }
}

// A step along `away` grows the distance, a step back makes it less.
TEST_F(DistanceQuery, PointsAway) {
  for (const int figure : {0, 1, 2}) {
    test::BentInstance bent(*asset, layers,
                            test::figureKnots(test::kFigure6[static_cast<std::size_t>(figure)]),
                            test::turned(3, glm::vec3(2, 2, -2), {1, 2, 3}), 5);
    int farther = 0, nearer = 0, asked = 0;
    while (asked < 2000) {
      const glm::vec3 point = bent.beside();
      const double here = bent.distanceOf(glm::dvec3(point));
      if (here < 1.5 * bent.voxel) continue;
      const Distance found = *distance(bent.instance, point);
      const glm::dvec3 step = 0.3 * here * glm::dvec3(found.away);
      ++asked;
      farther += bent.distanceOf(glm::dvec3(point) + step) > here;
      nearer += bent.distanceOf(glm::dvec3(point) - step) < here;
    }
    EXPECT_GT(farther, figure == 0 ? 1950 : 1600) << figure;
    EXPECT_GT(nearer, figure == 0 ? 1950 : 1600) << figure;
  }
}

TEST_F(DistanceQuery, AnswersErrorsToNonsense) {
  const Instance instance{asset.get()};
  const float bad[] = {NAN, INFINITY, -INFINITY};
  const glm::vec3 fine(1, 2, 3);
  for (const float b : bad) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 p(0);
      p[axis] = b;
      EXPECT_FALSE(distance(instance, p));
      EXPECT_FALSE(closestPoint(instance, p));
      EXPECT_FALSE(overlaps(instance, Sphere{p, 1}));
      EXPECT_FALSE(overlaps(instance, Capsule{p, fine, 1}));
      EXPECT_FALSE(overlaps(instance, Capsule{fine, p, 1}));
      EXPECT_FALSE(overlaps(instance, OrientedBox{p, fine}));
      EXPECT_FALSE(overlaps(instance, OrientedBox{fine, p}));
      EXPECT_FALSE(sphereCast(instance, p, fine, 1));
      EXPECT_FALSE(sphereCast(instance, fine, p, 1));
      EXPECT_FALSE(distance({&instance, 1}, p));
    }
    EXPECT_FALSE(overlaps(instance, Sphere{fine, b}));
    EXPECT_FALSE(overlaps(instance, Capsule{fine, glm::vec3(0), b}));
    EXPECT_FALSE(overlaps(instance, OrientedBox{fine, fine, glm::quat(b, 0, 0, 0)}));
    EXPECT_FALSE(sphereCast(instance, fine, glm::vec3(0), b));
  }
  EXPECT_FALSE(closestPoint(instance, fine, NAN));
  EXPECT_FALSE(closestPoint(instance, fine, 0));
  EXPECT_FALSE(overlaps(instance, Sphere{fine, -1}));
  EXPECT_FALSE(overlaps(instance, Capsule{fine, fine, 1}));
  EXPECT_FALSE(overlaps(instance, OrientedBox{fine, {1, 0, 1}}));
  EXPECT_FALSE(overlaps(instance, OrientedBox{fine, fine, glm::quat(0, 0, 0, 0)}));
  EXPECT_FALSE(sphereCast(instance, fine, fine, 1));
  EXPECT_FALSE(sphereCast(instance, glm::vec3(-3e38f), glm::vec3(3e38f), 1)) << "its length is not a number";
  EXPECT_FALSE(sphereCast(instance, fine, glm::vec3(0), -1));
  EXPECT_EQ(distance(Instance{}, fine).error().code, ErrorCode::kMisuse);
  const Box one;
  EXPECT_FALSE(distance(std::vector<Instance>(2, instance), fine, {&one, 1}));
  EXPECT_TRUE(distance(instance, glm::vec3(1e30f)));
  EXPECT_TRUE(overlaps(instance, Sphere{glm::vec3(0), 1e30f}));
}

TEST_F(DistanceQuery, SaysWhatIsMissing) {
  const glm::vec3 point(0);
  AssetOptions options;
  const auto unasked = Asset::open(source.source(), options).value();
  EXPECT_EQ(distance(Instance{unasked.get()}, point).error().code, ErrorCode::kMisuse);
  options.distance_level = 0;
  const auto waiting = Asset::open(source.source(), options).value();
  EXPECT_EQ(distance(Instance{waiting.get()}, point).error().code, ErrorCode::kNotYet);
  const std::vector<Instance> list = {Instance{asset.get()}, Instance{waiting.get()}};
  const Error error = distance(list, point).error();
  EXPECT_EQ(error.code, ErrorCode::kNotYet);
  EXPECT_EQ(error.offset, 1u);
  EXPECT_EQ(error.unit, Error::Unit::kInstance);
  const std::vector<std::byte> plain = test::bytesOf(test::packOf(volume));
  MemorySource plain_source(plain);
  const auto without = Asset::open(plain_source.source(), options).value();
  EXPECT_TRUE(without->loadAll());
  EXPECT_EQ(distance(Instance{without.get()}, point).error().code, ErrorCode::kUnsupportedFeature);
}

// The first byte of every distance chunk is wrong: waiting would not help, and the answer says why.
TEST_F(DistanceQuery, SaysWhyDistancesDidNotLoad) {
  const Pack pack = Pack::open(source.source()).value();
  std::vector<std::byte> damaged = bytes;
  for (const Pack::ChunkInfo& chunk : pack.chunks()) {
    if (chunk.fourcc == ('D' | 'G' << 8 | 'R' << 16 | std::uint32_t{'D'} << 24))
      damaged[chunk.offset] ^= std::byte{1};
  }
  MemorySource damaged_source(damaged);
  AssetOptions options;
  options.distance_level = 0;
  const auto loaded = Asset::open(damaged_source.source(), options).value();
  EXPECT_EQ(distance(Instance{loaded.get()}, glm::vec3(0)).error().code, ErrorCode::kNotYet);
  const ErrorCode why = loaded->loadAll().error().code;
  const Error error = distance(Instance{loaded.get()}, glm::vec3(0)).error();
  EXPECT_EQ(error.code, why) << error.detail;
  EXPECT_NE(error.code, ErrorCode::kNotYet);
  EXPECT_EQ(error.unit, Error::Unit::kPart);
  loaded->retry();
  EXPECT_EQ(distance(Instance{loaded.get()}, glm::vec3(0)).error().code, ErrorCode::kNotYet);
}

// Boxes spare an instance that is far the questions, so nothing is said of it.
TEST_F(DistanceQuery, ErrorsOfWhatIsFarAreFoundWithoutBoxesOnly) {
  const std::vector<Instance> list = {Instance{asset.get()}, Instance{}};
  const std::vector<Box> boxes = {bounds(list[0]), Box{glm::vec3(1000), glm::vec3(1001)}};
  const Sphere shape{glm::vec3(5), 1};
  EXPECT_EQ(overlaps(list, shape, boxes).value(), std::nullopt);
  EXPECT_EQ(overlaps(list, shape).error().offset, 1u);
}

// The same box, whatever the length of its quaternion.
TEST_F(DistanceQuery, ABoxMayHaveAnyQuaternion) {
  const Box around = bounds(Instance{asset.get()});
  const std::vector<Instance> list = {Instance{asset.get()}};
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> unit(0, 1);
  int touched = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::quat turn =
        glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
    const glm::vec3 at(0.9f + 0.3f * unit(random), unit(random), unit(random));
    const glm::vec3 center = glm::mix(around.min, around.max, at);
    const OrientedBox box{center, glm::vec3(0.1f, 0.2f, 0.3f), turn};
    const std::optional<int> truth = overlaps(list, box).value();
    touched += truth == 0;
    for (const float length : {1e-30f, 5e-23f, 1e-21f, 1e18f, 1e30f})
      EXPECT_EQ(overlaps(list, OrientedBox{center, box.half_size, turn * length}).value(), truth) << length;
  }
  EXPECT_GT(touched, 50);
  EXPECT_LT(touched, 250);
}

TEST_F(DistanceQuery, WhatIsNotDrawnHasNoSolid) {
  const glm::vec3 point(0, 0.5f, 0);
  Instance instance{asset.get()};
  Pose pose = *Pose::create(*asset);
  ASSERT_TRUE(pose.move(0, 1, {0, -2, 0}));
  const auto expectNone = [&] {
    EXPECT_EQ(distance(instance, point)->bound, kFarAway);
    EXPECT_EQ(distance(instance, point)->part, std::nullopt);
    EXPECT_EQ(closestPoint(instance, point)->distance, kFarAway);
    EXPECT_FALSE(*overlaps(instance, Sphere{point, 1}));
    EXPECT_FALSE(sphereCast(instance, point, glm::vec3(1), 1)->hit);
  };
  instance.pose = &pose;
  expectNone();
  instance.pose = nullptr;
  EXPECT_LT(distance(instance, point)->bound, kFarAway);
  instance.to_world = glm::mat4(0);
  expectNone();
  instance.to_world = glm::mat4(NAN);
  expectNone();
}

}  // namespace
}  // namespace kelp::runtime
