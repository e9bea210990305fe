// SPDX-License-Identifier: MIT
// Bodies a few voxels thick: their volume, and the sides of plates that one voxel stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "shapes.h"
#include "support/all_tests.h"
#include "truth.h"

namespace kelp {
namespace {

using test::voxelizeUnit;

// The farthest of many points of a mesh from the center of a solid voxel.
double farthest(const test::Baked& baked, const test::MeshTruth& truth) {
  double most = 0;
  for (const glm::dvec3& p : truth.sample(20000, 1)) {
    double nearest = 1e30;
    for (int cell = 0; cell < 125; ++cell) {
      const glm::ivec3 v =
          glm::ivec3(glm::floor(p)) + glm::ivec3(cell % 5 - 2, cell / 5 % 5 - 2, cell / 25 - 2);
      if (glm::any(glm::lessThan(v, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(v, baked.grid().size)) || !baked.at(v.x, v.y, v.z))
        continue;
      nearest = std::min(nearest, glm::distance(glm::dvec3(v) + 0.5, p));
    }
    most = std::max(most, nearest);
  }
  return most;
}

// Rods from 2.5 voxels thick on have their volume, in any direction but along the grid, where the lines of
// their voxels change as a whole.
TEST(Slender, SlenderRodsHaveTheirs) {
  for (const glm::vec3& end : {glm::vec3(60, 0, 0), glm::vec3(60, 13, 7), glm::vec3(43, 50, 31),
                               glm::vec3(5, 60, -17), glm::vec3(41, 39, 40)}) {
    constexpr float kRadii[] = {0.8f, 1.25f, 3.0f, 0.6f, 1.0f, 1.5f, 2.0f};
    for (const float radius : std::span(kRadii).first(test::kSanitized ? 3 : 7)) {
      bake::TriangleSoup soup;
      test::addRod(soup, {0, 0, 0}, end, radius);
      const test::Baked baked = voxelizeUnit(test::makeModel(soup));
      const test::MeshTruth truth(soup, baked.frame);
      const double error = static_cast<double>(baked.solid) / truth.signedVolume() - 1;
      std::printf("to %g %g %g, radius %g: %+.1f %%\n", static_cast<double>(end.x),
                  static_cast<double>(end.y), static_cast<double>(end.z), static_cast<double>(radius),
                  100 * error);
      if (radius >= 1.25f) {
        EXPECT_LT(std::abs(error), end.y == 0 ? 0.07 : 0.01);
      }
      EXPECT_LT(farthest(baked, truth), std::sqrt(3.0));
    }
  }
}

// A flat side along the grid moves as a whole: no layer of a box is there in part.
TEST(Slender, FlatSidesGetNoSteps) {
  for (const glm::vec3& size : {glm::vec3(30, 1.5f, 20), glm::vec3(5.4f, 40, 30.3f),
                                glm::vec3(16.5f, 20, 16.5f), glm::vec3(40, 2.6f, 40)}) {
    bake::TriangleSoup soup;
    test::addBox(soup, {0, 0, 0}, size);
    const test::Baked baked = voxelizeUnit(test::makeModel(soup));
    glm::ivec3 low(1000), high(-1);
    for (int z = 0; z < baked.grid().size.z; ++z) {
      for (int y = 0; y < baked.grid().size.y; ++y) {
        for (int x = 0; x < baked.grid().size.x; ++x) {
          if (!baked.at(x, y, z)) continue;
          low = glm::min(low, glm::ivec3(x, y, z));
          high = glm::max(high, glm::ivec3(x, y, z));
        }
      }
    }
    const glm::ivec3 extent = high - low + 1;
    EXPECT_EQ(baked.solid, static_cast<std::uint64_t>(extent.x) * static_cast<std::uint64_t>(extent.y) *
                               static_cast<std::uint64_t>(extent.z))
        << size.x << " " << size.y << " " << size.z;
    // No side has moved by a voxel.
    const glm::dvec3 margin = (glm::dvec3(baked.grid().size) - glm::dvec3(size)) * 0.5;
    const glm::dvec3 off = glm::max(glm::abs(glm::dvec3(low) - margin),
                                    glm::abs(glm::dvec3(high + 1) - margin - glm::dvec3(size)));
    EXPECT_LT(std::max({off.x, off.y, off.z}), 1.0);
  }
}

// A plate thinner than a voxel shows one of its sides everywhere, whichever is nearer: the upper one, or the
// one that is seen.
TEST(Slender, ThinPlatesShowOneSide) {
  for (const float slope : {0.0f, 0.1f, 0.4f, 1.0f}) {
    for (const bool covered : {false, true}) {
      bake::TriangleSoup soup;
      test::addBox(soup, {0, 0, 0}, {40, 0.3f, 40});
      // A roof over it: only from below it is seen.
      if (covered) test::addBox(soup, {-30, 6, -30}, {70, 12, 70});
      for (glm::vec3& p : soup.positions) p.y += slope * p.x;
      const test::Baked baked = voxelizeUnit(test::makeModel(soup));
      const glm::vec3 want = glm::normalize(glm::vec3(-slope, 1, 0)) * (covered ? -1.0f : 1.0f);
      std::size_t wrong = 0, seen = 0;
      for (const bake::SurfaceSample& sample : baked.grid().surface) {
        const glm::ivec3 size = baked.grid().size;
        const glm::dvec3 voxel(static_cast<double>(sample.index % static_cast<std::uint64_t>(size.x)) + 0.5,
                               static_cast<double>(sample.index / static_cast<std::uint64_t>(size.x) %
                                                   static_cast<std::uint64_t>(size.y)) +
                                   0.5,
                               static_cast<double>(sample.index / static_cast<std::uint64_t>(size.x) /
                                                   static_cast<std::uint64_t>(size.y)) +
                                   0.5);
        const glm::dvec3 p(glm::inverse(baked.frame.node_to_voxel) * glm::dvec4(voxel, 1));
        // the plate without its rim
        if (p.x < 2 || p.x > 38 || p.z < 2 || p.z > 38 || p.y - static_cast<double>(slope) * p.x > 3 ||
            p.y - static_cast<double>(slope) * p.x < -3)
          continue;
        const int side = covered ? -1 : 1;  // where it is two thick, each voxel has its own side
        const int beyond = static_cast<int>(voxel.y) + side;
        if (beyond >= 0 && beyond < size.y &&
            baked.at(static_cast<int>(voxel.x), beyond, static_cast<int>(voxel.z)))
          continue;
        ++seen;
        wrong += glm::dot(sample.normal, want) < 0.9f;
      }
      EXPECT_GT(seen, 1000u) << "slope " << slope << (covered ? ", covered" : "");
      EXPECT_EQ(wrong, 0u) << "slope " << slope << (covered ? ", covered" : "");
    }
  }
}

// Nor has one that stands upright, exactly along a diagonal of the grid or not, a mixture of both.
TEST(Slender, UprightPlatesShowOneSide) {
  for (const glm::vec3& along :
       {glm::vec3(1, 0, 1), glm::vec3(1, 0, -1), glm::vec3(1, 0, 0.3f), glm::vec3(0.1f, 0, 1)}) {
    const glm::vec3 across = 0.5f * glm::normalize(glm::vec3(along.z, 0, -along.x));
    bake::TriangleSoup soup;
    test::addBox(soup, {0, 0, 0}, {40, 40, 1});
    for (glm::vec3& p : soup.positions) p = p.x * along + glm::vec3(0, p.y, 0) + p.z * across;
    const test::Baked baked = voxelizeUnit(test::makeModel(soup));
    std::size_t one = 0, other = 0;
    for (const bake::SurfaceSample& sample : baked.grid().surface) {
      const glm::ivec3 size = baked.grid().size;
      const int x = static_cast<int>(sample.index % static_cast<std::uint64_t>(size.x)),
                y = static_cast<int>(sample.index / static_cast<std::uint64_t>(size.x) %
                                     static_cast<std::uint64_t>(size.y)),
                z = static_cast<int>(sample.index / static_cast<std::uint64_t>(size.x) /
                                     static_cast<std::uint64_t>(size.y));
      // Where it is two thick, each voxel has its own side.
      const bool is_x = std::abs(across.x) > std::abs(across.z);
      const auto is_there = [&](int step) {
        const int a = is_x ? x + step : x, b = is_x ? z : z + step;
        return a >= 0 && b >= 0 && a < size.x && b < size.z && baked.at(a, y, b);
      };
      if (is_there(1) || is_there(-1)) continue;
      const double along_normal = glm::dot(glm::dvec3(sample.normal), glm::normalize(glm::dvec3(across)));
      one += along_normal > 0.9;
      other += along_normal < -0.9;
    }
    EXPECT_GT(one + other, 1000u) << along.x << " " << along.z;
    EXPECT_EQ(std::min(one, other), 0u) << along.x << " " << along.z << ": " << one << ", " << other;
  }
}

}  // namespace
}  // namespace kelp
