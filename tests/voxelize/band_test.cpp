// SPDX-License-Identifier: MIT
// The voxels near triangles, against the distance of every voxel from every triangle.
#include "kelp/voxelize/surface/band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "truth.h"

namespace kelp::bake {
namespace {

constexpr int kSide = 20;

// Triangles that reach beyond the volume too, and one cap, which does not count.
Topology someTriangles() {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::int64_t> place(-(4 << kLatticeBits), (kSide + 4) << kLatticeBits);
  Topology mesh;
  mesh.components.emplace_back();
  for (std::uint32_t i = 0; i < 12; ++i) {
    SolidTriangle t;
    t.source = i < 11 ? i : kCap;
    for (std::uint32_t& vertex : t.vertex) {
      vertex = static_cast<std::uint32_t>(mesh.lattice.size());
      mesh.lattice.emplace_back(place(random), place(random), place(random));
    }
    // A small one, and a needle.
    if (i % 4 == 1) mesh.lattice.back() = mesh.lattice[mesh.lattice.size() - 2] + glm::i64vec3(9, 5, -7);
    mesh.triangles.push_back(t);
  }
  mesh.caps = 1;
  return mesh;
}

TEST(Band, HoldsTheVoxelsWithinHalfADiagonal) {
  const Topology mesh = someTriangles();
  const glm::ivec3 size(kSide);
  const std::vector<std::uint64_t> touched = touchedVoxels(mesh, size, 2);
  EXPECT_TRUE(std::is_sorted(touched.begin(), touched.end()));
  EXPECT_EQ(std::adjacent_find(touched.begin(), touched.end()), touched.end());
  std::size_t near = 0;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(kSide * kSide * kSide); ++i) {
    const glm::dvec3 centre = glm::dvec3(i % kSide, i / kSide % kSide, i / (kSide * kSide)) + 0.5;
    double least = 1e9;
    for (std::size_t t = 0; t + 1 < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t].vertex;
      glm::dvec3 weights;
      least = std::min(least,
                       test::distanceToTriangle(
                           centre, {mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])}, weights));
    }
    const bool is_touched = std::binary_search(touched.begin(), touched.end(), i);
    near += is_touched;
    if (least < std::sqrt(0.75)) {
      EXPECT_TRUE(is_touched) << least;
    } else if (least > std::sqrt(0.75) + 1e-3) {
      EXPECT_FALSE(is_touched) << least;
    }
  }
  EXPECT_GT(near, 500u);
  EXPECT_LT(near, static_cast<std::size_t>(kSide * kSide * kSide) * 3 / 4);
}

TEST(Band, IsTheSameOnAnyNumberOfThreads) {
  const Topology mesh = someTriangles();
  EXPECT_EQ(touchedVoxels(mesh, glm::ivec3(kSide), 1), touchedVoxels(mesh, glm::ivec3(kSide), 4));
}

}  // namespace
}  // namespace kelp::bake
