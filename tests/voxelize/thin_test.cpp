// SPDX-License-Identifier: MIT
// Wires, blades and plates that are thinner than voxels, against what must hold of them by brute force.
#include "kelp/voxelize/fill/fill.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kelp/voxelize/surface/triangle_bvh.h"
#include "shapes.h"
#include "truth.h"

namespace kelp::bake {
namespace {

// The scanlines' voxels, and the same with the thin parts.
struct Filled {
  glm::ivec3 size{0};
  Topology mesh;
  std::vector<std::uint64_t> touched;
  std::vector<std::uint8_t> before, after;

  glm::ivec3 at(std::size_t i) const {
    const std::size_t x = static_cast<std::size_t>(size.x), y = static_cast<std::size_t>(size.y);
    return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / x / y)};
  }
  std::size_t added() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) count += before[i] == kEmpty && after[i] != kEmpty;
    return count;
  }
  // Sets of solid voxels that touch each other by corners at least: by walking from each.
  int pieces() const {
    std::vector<std::uint8_t> seen(after.size(), 0);
    int pieces = 0;
    for (std::size_t start = 0; start < after.size(); ++start) {
      if (after[start] == kEmpty || seen[start]) continue;
      ++pieces;
      std::vector<std::size_t> open{start};
      seen[start] = 1;
      while (!open.empty()) {
        const glm::ivec3 voxel = at(open.back());
        open.pop_back();
        for (int k = 0; k < 27; ++k) {
          const glm::ivec3 n = voxel + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
          if (glm::any(glm::lessThan(n, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(n, size))) continue;
          const std::size_t i = static_cast<std::size_t>(n.x + size.x * (n.y + size.y * n.z));
          if (after[i] == kEmpty || seen[i]) continue;
          seen[i] = 1;
          open.push_back(i);
        }
      }
    }
    return pieces;
  }
};

Filled fill(const TriangleSoup& soup) {
  constexpr int kThreads = 2;
  Filled filled;
  Frame frame;
  frame.size = filled.size = glm::ivec3(40);
  frame.voxel_size = 1;
  filled.mesh = analyze(soup, frame, Fill::kAuto);
  filled.before.assign(40 * 40 * 40, kEmpty);
  fillScanlines(filled.mesh, filled.size, kThreads, filled.before);
  // Touched voxels by brute force, and some beside them.
  const test::MeshTruth truth(soup, frame);
  const auto touched = [&truth](const glm::dvec3& middle) {
    glm::dvec3 weights;
    for (std::size_t t = 0; t < truth.triangles(); ++t)
      if (test::distanceToTriangle(middle, truth.corners(t), weights) <= kHalfDiagonal) return true;
    return false;
  };
  for (std::size_t i = 0; i < filled.before.size(); ++i)
    if (touched(glm::dvec3(filled.at(i)) + 0.5)) filled.touched.push_back(i);
  filled.after = filled.before;
  keepThinParts(filled.mesh, TriangleBvh(filled.mesh), filled.touched, filled.size, kThreads, filled.after,
                {});
  return filled;
}

// Wires much thinner than a voxel, in any direction: one piece, nothing beside the wire, and every point of
// it within 1.6 voxels of a solid voxel's center.
TEST(Thin, WiresHangTogether) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> place(4, 36);
  for (int round = 0; round < 12; ++round) {
    const glm::vec3 a(place(random), place(random), place(random)),
        b(place(random), place(random), place(random));
    if (glm::distance(a, b) < 12) continue;
    TriangleSoup soup;
    test::addRod(soup, a, b, round % 2 ? 0.2f : 0.02f);
    const Filled filled = fill(soup);
    EXPECT_GT(filled.added(), 0u);
    EXPECT_EQ(filled.pieces(), 1) << round;
    const glm::dvec3 way(b - a);
    double first = 1, last = 0;
    for (std::size_t i = 0; i < filled.after.size(); ++i) {
      EXPECT_LE(filled.after[i], kKept);
      if (filled.before[i] != kEmpty) {
        EXPECT_EQ(filled.after[i], filled.before[i]);
      }
      if (filled.after[i] == kEmpty) continue;
      const glm::dvec3 from = glm::dvec3(filled.at(i)) + 0.5 - glm::dvec3(a);
      const double along = glm::dot(from, way) / glm::dot(way, way);
      EXPECT_LT(glm::length(from - glm::clamp(along, 0.0, 1.0) * way), 1.1);
      first = std::min(first, along);
      last = std::max(last, along);
    }
    EXPECT_LT(first * glm::length(way), 1.6);
    EXPECT_GT(last * glm::length(way), glm::length(way) - 1.6);
  }
}

// A ribbon of a third of a voxel in width: scanlines meet it here and there.
TEST(Thin, RibbonsHangTogether) {
  for (const glm::vec3& side :
       {glm::vec3(0.3f, 0, 0), glm::vec3(0.2f, -0.1f, 0.2f), glm::vec3(0, 0, 0.05f)}) {
    TriangleSoup soup;
    const glm::vec3 a(5.2f, 6.1f, 4.7f), b(34.4f, 31.3f, 22.9f);
    test::addTriangle(soup, a, b, a + side);
    test::addTriangle(soup, b, b + side, a + side);
    const Filled filled = fill(soup);
    EXPECT_EQ(filled.pieces(), 1);
  }
}

TEST(Thin, ThickBodiesGainNothing) {
  TriangleSoup soup;
  test::addSphere(soup, {20, 20, 20}, 12.3f, 24);
  EXPECT_EQ(fill(soup).added(), 0u);
}

}  // namespace
}  // namespace kelp::bake
