// SPDX-License-Identifier: MIT
// Normals of caged parts, from cage_tree.glsl compiled as C++, at hits of rays, beside the derivative of the
// map that their nodes sample.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "reference/cage_trials.h"
#include "reference/posed_trial.h"
#include "support/all_tests.h"
#include "support/poses.h"

namespace kelp {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr double kPi = std::numbers::pi;
const glm::ivec3 kClumpSize(96, 128, 80);

// A map, and its derivative in the columns of a matrix.
struct SmoothMap {
  const char* name;
  dvec3 (*at)(const dvec3& rest);
  dmat3 (*derivative)(const dvec3& rest);
};
constexpr double kBend = 0.5 * kPi / 128, kRadius = 128 / (0.5 * kPi), kTwist = 2 * kPi / 128;
const SmoothMap kSmoothMaps[] = {
    {"bent by 90 degrees",
     [](const dvec3& p) {
       const double out = kRadius + 48 - p.x, a = kBend * p.y;
       return dvec3(kRadius - out * std::cos(a), out * std::sin(a), p.z);
     },
     [](const dvec3& p) {
       const double out = kRadius + 48 - p.x, a = kBend * p.y, c = std::cos(a), s = std::sin(a);
       return dmat3(dvec3(c, -s, 0), kBend * out * dvec3(s, c, 0), dvec3(0, 0, 1));
     }},
    {"twisted by 360 degrees",
     [](const dvec3& p) {
       const double x = p.x - 48, z = p.z - 40, c = std::cos(kTwist * p.y), s = std::sin(kTwist * p.y);
       return dvec3(c * x - s * z, p.y, s * x + c * z);
     },
     [](const dvec3& p) {
       const double x = p.x - 48, z = p.z - 40, c = std::cos(kTwist * p.y), s = std::sin(kTwist * p.y);
       return dmat3(dvec3(c, 0, s), dvec3(-kTwist * (s * x + c * z), 1, kTwist * (c * x - s * z)),
                    dvec3(-s, 0, c));
     }}};

double degreesBetween(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / kPi;
}

// The mean angle between kelp's normals and the map's, of surfaces that face anywhere.
double normalsOff(const reference::CagedVolume& volume, const SmoothMap& map) {
  const reference::PosedTrial posed(volume, {map.name, map.at}, 1);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    dvec3 d;
    for (int axis = 0; axis < 3; ++axis) d[axis] = normal(random);
    return glm::normalize(d);
  };
  double sum = 0;
  int hits = 0;
  const int rays = test::shareOf(20000);
  for (int i = 0; i < rays; ++i) {
    const dvec3 target = posed.node(static_cast<std::uint32_t>(random() % volume.cage().nodes())),
                r = direction();
    const trace::KelpHit hit =
        trace::kelpTraceCaged(posed.context(), glm::vec3(target - 300.0 * r), glm::vec3(r), 0.0f, 600.0f);
    if (!hit.found) continue;
    const dvec3 n = direction();
    const dvec3 drawn(trace::kelpCageNormal(posed.context(), hit, glm::vec3(n)));
    sum += degreesBetween(drawn, glm::transpose(glm::inverse(map.derivative(dvec3(hit.rest)))) * n);
    ++hits;
  }
  EXPECT_GT(hits, rays / 2);
  return sum / hits;
}

TEST(CageNormals, AreThoseOfTheMap) {
  const fields::Occupancy clump = test::ballClump(kClumpSize, 30, 1);
  for (const int cell : {8, 4}) {
    const reference::CagedVolume volume = reference::cagedVolume("clump", clump, cell);
    for (const SmoothMap& map : kSmoothMaps) {
      const double off = normalsOff(volume, map);
      // Goal: 2. Without the neighbors' part the twist would be 3.4 off in cells of 8, 1.7 in cells of 4.
      EXPECT_LT(off, 1.5 * cell / 8) << map.name << ", cells of " << cell;
    }
  }
}

}  // namespace
}  // namespace kelp
