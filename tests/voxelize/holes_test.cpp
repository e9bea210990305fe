// SPDX-License-Identifier: MIT
// Fans over holes: openings are closed where they end, and no rim is too wild.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "shapes.h"
#include "support/all_tests.h"

namespace kelp {
namespace {

using test::voxelizeUnit;

constexpr double kPi = std::numbers::pi;

glm::vec3 centerOf(const bake::TriangleSoup& soup, const bake::TriangleSoup::Triangle& t) {
  return (soup.positions[t.vertex[0]] + soup.positions[t.vertex[1]] + soup.positions[t.vertex[2]]) / 3.0f;
}

// Without the triangles whose centers are `gone`: a jagged rim.
bake::TriangleSoup torn(bake::TriangleSoup soup, const std::function<bool(const glm::vec3&)>& gone) {
  std::erase_if(soup.triangles, [&](const auto& t) { return gone(centerOf(soup, t)); });
  return soup;
}

std::function<bool(const glm::vec3&)> within(const glm::vec3& place, float distance) {
  return [=](const glm::vec3& p) { return glm::distance(p, place) < distance; };
}

// The share of the whole's voxels that differ.
double changed(const test::Baked& whole, const test::Baked& part) {
  EXPECT_EQ(whole.grid().size, part.grid().size);
  std::size_t count = 0;
  for (std::size_t i = 0; i < whole.grid().solid.size(); ++i)
    count += whole.grid().solid[i] != part.grid().solid[i];
  return static_cast<double>(count) / static_cast<double>(whole.solid);
}

// A can without its lid, of `steps` sides that end in `fine` edges each. The rim stands at height + wave(in
// turns), give or take `jag`.
bake::TriangleSoup can(int steps, int fine, float foot, float mouth, float height,
                       const std::function<float(float)>& wave, float jag = 0) {
  bake::TriangleSoup soup;
  const auto at = [](float turns, float radius, float y) {
    return glm::vec3(radius * std::cos(2 * static_cast<float>(kPi) * turns), y,
                     radius * std::sin(2 * static_cast<float>(kPi) * turns));
  };
  const int edges = steps * fine;
  const auto rim = [&](int i) {
    const float turns = static_cast<float>(i % edges) / static_cast<float>(edges);
    return at(turns, mouth, height + wave(turns) + (i % 2 ? jag : -jag));
  };
  const auto wall = [&](int i, bool top) {
    const float turns = static_cast<float>(i % steps) / static_cast<float>(steps);
    constexpr float kTop = 0.95f;
    return top ? glm::mix(at(turns, foot, 0), at(turns, mouth, height + wave(turns)), kTop)
               : at(turns, foot, 0);
  };
  for (int i = 0; i < steps; ++i) {
    const glm::vec3 a = wall(i, false), b = wall(i + 1, false), c = wall(i + 1, true), d = wall(i, true);
    test::addTriangle(soup, a, c, b);
    test::addTriangle(soup, a, d, c);
    test::addTriangle(soup, {0, 0, 0}, a, b);
    for (int k = i * fine; k < (i + 1) * fine; ++k) test::addTriangle(soup, d, rim(k), rim(k + 1));
    test::addTriangle(soup, d, rim((i + 1) * fine), c);
  }
  return soup;
}

TEST(Holes, ASleeveEndsWhereItEnds) {
  const auto wave = [](float turns) { return 2 * std::sin(6 * static_cast<float>(kPi) * turns); };
  bake::TriangleSoup sleeve = can(60, 1, 15, 15, 60, wave);
  test::addBox(sleeve, {-1, 75, -1}, {1, 77, 1});  // so that the box has room for what must not be there
  const test::Baked baked = voxelizeUnit(test::makeModel(sleeve));
  EXPECT_EQ(baked.result.counts.capped, 1u) << baked.result.fill;
  const double volume = kPi * 15 * 15 * 60;
  EXPECT_NEAR(static_cast<double>(baked.solid), volume, 0.02 * volume);
}

// 100,000 edges that go up and down on a wave.
TEST(Holes, ARimOf100000Edges) {
  const auto wave = [](float turns) { return std::sin(6 * static_cast<float>(kPi) * turns); };
  constexpr int kFine = test::kSanitized ? 40 : 200;
  const test::Baked baked = voxelizeUnit(test::makeModel(can(500, kFine, 40, 20, 20, wave, 1e-4f)));
  EXPECT_EQ(baked.result.counts.capped, 1u) << baked.result.fill;
  const double frustum = kPi * 20 / 3 * (40.0 * 40 + 40 * 20 + 20 * 20);
  EXPECT_NEAR(static_cast<double>(baked.solid), frustum, 0.01 * frustum);
}

TEST(Holes, HolesByTheThousand) {
  bake::TriangleSoup sphere;
  test::addSphere(sphere, {0, 0, 0}, 40, 150);
  const test::Baked whole = voxelizeUnit(test::makeModel(sphere));
  int at = 0;
  const test::Baked part =
      voxelizeUnit(test::makeModel(torn(sphere, [&](const glm::vec3&) { return ++at % 9 == 0; })));
  EXPECT_GT(part.result.counts.cap_triangles, 25000u);
  EXPECT_LT(changed(whole, part), 0.0005);
}

// Whatever is left of a sphere: rims that touch themselves and each other, edges of three faces, turned and
// doubled faces, corners off their places.
TEST(Holes, NoRimIsTooWild) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(test::shareOf(30)); ++seed) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<float>(random() & 0xffff) / 65536.0f; };
    bake::TriangleSoup soup;
    const int rings = 4 + static_cast<int>(random() % 16);
    test::addSphere(soup, {0, 0, 0}, 12, rings);
    for (int hole = static_cast<int>(random() % 5); hole >= 0; --hole) {
      const float x = unit() - 0.5f, y = unit() - 0.5f, z = unit() - 0.4f, size = 12 * unit();
      soup = torn(soup, within(12.0f * glm::normalize(glm::vec3(x, y, z) + 1e-3f), size));
    }
    const float drop = seed % 3 == 0 ? 0.2f * unit() : 0.0f, noise = seed % 2 == 0 ? 3 * unit() : 0.0f;
    soup = torn(soup, [&](const glm::vec3&) { return unit() < drop; });
    for (glm::vec3& p : soup.positions) {
      // Corners of one place stay together.
      const glm::vec3 q = p * 1000.0f;
      p += noise * glm::vec3(std::sin(q.x), std::sin(q.y + q.z), std::sin(q.z - q.x));
    }
    for (std::size_t i = 0, count = soup.triangles.size(); i < count; ++i) {
      if (seed % 4 == 1 && unit() < 0.3f) std::swap(soup.triangles[i].vertex[0], soup.triangles[i].vertex[1]);
      if (seed % 5 == 1 && unit() < 0.1f) {
        const auto triangle = soup.triangles[i];
        const glm::vec3 tip = 1.5f * centerOf(soup, triangle);
        test::addTriangle(soup, soup.positions[triangle.vertex[0]], soup.positions[triangle.vertex[1]], tip);
      }
    }
    if (soup.triangles.empty()) continue;
    const bake::Fill fill = seed % 2 == 0 ? bake::Fill::kSolid : bake::Fill::kAuto;
    const test::Baked one = voxelizeUnit(test::makeModel(soup), fill, 1),
                      three = voxelizeUnit(test::makeModel(soup), fill, 3);
    EXPECT_EQ(one.grid().solid, three.grid().solid) << seed;
    EXPECT_GT(one.solid, 0u) << seed;
  }
}

}  // namespace
}  // namespace kelp
