// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <random>

#include "every_target.h"
#include "kelp/fields/fields.h"
#include "reference_fields.h"
#include "support/all_tests.h"
#include "volumes.h"

namespace kelp::test {
namespace {

std::vector<std::uint32_t> squaredDistanceOf(const std::vector<std::uint8_t>& set, const glm::ivec3& size,
                                             int threads) {
  std::vector<std::uint32_t> squared(set.size(), 12345);
  fields::squaredDistance(set, size, squared, threads);
  return squared;
}

TEST(SquaredDistance, EqualsBruteForceOnEveryTarget) {
  for (const NamedVolume& volume : hardVolumes()) {
    const auto expected = bruteSquaredDistance(volume.occupancy.solid, volume.occupancy.size);
    forEveryTarget([&](const char* target) {
      ASSERT_EQ(squaredDistanceOf(volume.occupancy.solid, volume.occupancy.size, 1), expected)
          << volume.name << " on " << target;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(SquaredDistance, EqualsBruteForceOnRandomSizes) {
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    const glm::ivec3 size(1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 40),
                          1 + static_cast<int>(random() % 20));
    const double density = std::pow(0.5, static_cast<double>(random() % 12));
    const auto volume = randomVolume(size, density, random());
    ASSERT_EQ(squaredDistanceOf(volume.solid, size, 2), bruteSquaredDistance(volume.solid, size))
        << nameOf(size) << " at density " << density;
  }
}

TEST(SquaredDistance, AnyValueButZeroIsSet) {
  std::vector<std::uint8_t> set(200, 0);
  set[20] = 255;
  set[130] = 2;
  EXPECT_EQ(squaredDistanceOf(set, {200, 1, 1}, 1), bruteSquaredDistance(set, {200, 1, 1}));
  EXPECT_EQ(squaredDistanceOf(set, {10, 20, 1}, 1), bruteSquaredDistance(set, {10, 20, 1}));
}

// Volumes too large for all pairs, against the printed algorithm: parabolas that pop in long runs, and sides
// past one tile.
TEST(SquaredDistance, EqualsTheScalarTransformOnLargerShapes) {
  const glm::ivec3 size(131, 150, 97);
  const auto center = glm::vec3(size) * 0.5f;
  const auto length2 = [](const glm::vec3& v) { return v.x * v.x + v.y * v.y + v.z * v.z; };
  const NamedVolume volumes[] = {
      {"ball",
       volumeWhere(size,
                   [&](const glm::ivec3& v) { return length2(glm::vec3(v) - center) < 40.0f * 40.0f; })},
      {"shell", volumeWhere(size,
                            [&](const glm::ivec3& v) {
                              return std::abs(std::sqrt(length2(glm::vec3(v) - center)) - 45.0f) < 0.6f;
                            })},
      {"cone",
       volumeWhere(size,
                   [&](const glm::ivec3& v) { return v.x == std::abs(v.y - 75) + std::abs(v.z - 48); })},
      {"parabola", volumeWhere(size,
                               [&](const glm::ivec3& v) {
                                 return v.x == 130 - (v.y - 75) * (v.y - 75) / 43 && v.z == 96;
                               })},
      {"sparse noise", randomVolume(size, 0.00003, 5)},
      {"noise", randomVolume(size, 0.01, 6)},
  };
  constexpr std::size_t kStep = kSanitized ? 3 : 1;
  for (std::size_t i = 0; i < std::size(volumes); i += kStep) {
    const NamedVolume& volume = volumes[i];
    const auto expected = naiveSeparable(volume.occupancy.solid, size);
    forEveryTarget([&](const char* target) {
      ASSERT_EQ(squaredDistanceOf(volume.occupancy.solid, size, 2), expected)
          << volume.name << " on " << target;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(SquaredDistance, IsTheSameForAnyNumberOfThreads) {
  const glm::ivec3 size(70, 41, 53);
  for (const double density : {0.0001, 0.01, 0.5}) {
    const auto volume = randomVolume(size, density, 11);
    const auto one = squaredDistanceOf(volume.solid, size, 1);
    for (const int threads : {0, 2, 3, 4, 9})
      EXPECT_EQ(squaredDistanceOf(volume.solid, size, threads), one) << threads << " threads";
  }
}

// The longest sides there may be: squared distances need all 30 bits, and the vectors hand over to the plain
// kernels on the way.
TEST(SquaredDistance, IsExactOnTheLongestSides) {
  for (const int length : {4096, 20724, 20725, 32767, 32768}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 size(1);
      size[axis] = length;
      size[(axis + 1) % 3] = 3;
      for (const bool both : {false, true}) {
        const auto volume = volumeWhere(
            size, [&](const glm::ivec3& v) { return v == glm::ivec3(0) || (both && v == size - 1); });
        const auto squared = squaredDistanceOf(volume.solid, size, 2);
        glm::ivec3 v{0};
        std::int64_t wrong = 0;
        for (v.z = 0; v.z < size.z; ++v.z) {
          for (v.y = 0; v.y < size.y; ++v.y) {
            for (v.x = 0; v.x < size.x; ++v.x) {
              const auto square = [](std::int64_t a, std::int64_t b, std::int64_t c) {
                return a * a + b * b + c * c;
              };
              std::int64_t expected = square(v.x, v.y, v.z);
              if (both)
                expected = std::min(expected, square(v.x - size.x + 1, v.y - size.y + 1, v.z - size.z + 1));
              wrong += squared[volume.index(v)] != expected;
            }
          }
        }
        EXPECT_EQ(wrong, 0) << nameOf(size) << (both ? " two corners" : " one corner");
      }
    }
  }
}

TEST(SquaredDistance, RefusesSizesThatDoNotFit) {
  std::vector<std::uint8_t> set(60);
  std::vector<std::uint32_t> squared(60);
  EXPECT_NO_THROW(fields::squaredDistance(set, {3, 4, 5}, squared, 1));
  EXPECT_THROW(fields::squaredDistance(set, {3, 4, 4}, squared, 1), std::invalid_argument);
  EXPECT_THROW(fields::squaredDistance(set, {3, 4, 5}, std::span(squared).first(59), 1),
               std::invalid_argument);
  EXPECT_THROW(fields::squaredDistance({}, {0, 4, 5}, {}, 1), std::invalid_argument);
  EXPECT_THROW(fields::squaredDistance(set, {-3, -4, 5}, squared, 1), std::invalid_argument);
  set.resize(32769);
  squared.resize(32769);
  EXPECT_THROW(fields::squaredDistance(set, {32769, 1, 1}, squared, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test
