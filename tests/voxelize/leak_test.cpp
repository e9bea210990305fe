// SPDX-License-Identifier: MIT
// Rays that meet a sheet meet its voxels, though each voxel may be missed by 1/256 (the renderer's promise,
// DESIGN 3.5).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shapes.h"

namespace kelp {
namespace {

using glm::dvec3;

constexpr double kErosion = 1.0 / 256;

bool solidAt(const bake::VoxelGrid& grid, const dvec3& p) {
  const glm::ivec3 v(glm::floor(p));
  if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= grid.size.x || v.y >= grid.size.y || v.z >= grid.size.z)
    return false;
  return grid.solid[static_cast<std::size_t>(v.x) +
                    static_cast<std::size_t>(grid.size.x) *
                        (static_cast<std::size_t>(v.y) +
                         static_cast<std::size_t>(grid.size.y) * static_cast<std::size_t>(v.z))] != 0;
}

// True if a small cube around a point lies within solid voxels: voxels that share a face leave no slit, those
// that share an edge do.
bool wellInside(const bake::VoxelGrid& grid, const dvec3& p) {
  for (int corner = 0; corner < 8; ++corner) {
    if (!solidAt(grid, p + kErosion * (2.0 * dvec3(corner & 1, corner >> 1 & 1, corner >> 2) - 1.0)))
      return false;
  }
  return true;
}

// True if the line through p along d meets the solid voxels, as a body eroded by that much, within a few
// voxels of p.
bool meets(const bake::VoxelGrid& grid, const dvec3& p, const dvec3& d) {
  constexpr double kReach = 4;
  for (const double step : {0.25, 1.0 / 512}) {  // most are seen at once
    for (double t = -kReach; t <= kReach; t += step) {
      if (wellInside(grid, p + t * d)) return true;
    }
  }
  return false;
}

dvec3 randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  return glm::normalize(dvec3(normal(random), normal(random), normal(random)));
}

// Share of rays that slip through, of those that aim at points of the mesh.
double leaks(const bake::VoxelGrid& grid, const std::vector<dvec3>& points, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::size_t lost = 0;
  for (const dvec3& p : points) lost += !meets(grid, p, randomDirection(random));
  return static_cast<double>(lost) / static_cast<double>(points.size());
}

TEST(Leaks, NoRaySlipsThroughASheet) {
  std::mt19937 random(1);
  for (int turn = 0; turn < 12; ++turn) {
    // A square with a side of 60 voxels; the first few lie at exactly 45 degrees, where voxels touch along
    // edges most.
    dvec3 u = randomDirection(random), v = glm::normalize(glm::cross(u, randomDirection(random)));
    if (turn < 3) {
      u = dvec3(0);
      v = dvec3(0);
      u[turn] = 1;
      v[(turn + 1) % 3] = v[(turn + 2) % 3] = std::sqrt(0.5);
    }
    const dvec3 corner = dvec3(0.37, 0.11, 0.83) * static_cast<double>(turn);
    bake::TriangleSoup soup;
    const auto at = [&](double a, double b) { return glm::vec3(corner + 60.0 * (a * u + b * v)); };
    test::addTriangle(soup, at(0, 0), at(1, 0), at(1, 1));
    test::addTriangle(soup, at(0, 0), at(1, 1), at(0, 1));
    const test::Baked baked = test::voxelizeUnit(test::makeModel(soup));
    std::vector<dvec3> points;  // two voxels away from the rim
    std::uniform_real_distribution<double> inside(0.04, 0.96);
    for (int i = 0; i < 20000; ++i)
      points.push_back(
          dvec3(baked.frame.node_to_voxel * glm::dvec4(dvec3(at(inside(random), inside(random))), 1.0)));
    EXPECT_EQ(leaks(baked.grid(), points, 7), 0.0)
        << "turn " << turn << ", " << baked.solid << " voxels for 3600 of area";
    EXPECT_LT(baked.solid, 2.6 * 3600) << "turn " << turn << ": thicker than it needs to be";
  }
}

}  // namespace
}  // namespace kelp
