// SPDX-License-Identifier: MIT
// Cells that triangles touch, against every cell of the box asked by separating axes.
#include "kelp/voxelize/surface/touched_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace kelp::bake::test {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// No axis separates them: of the cube's faces, of the triangle's, and of their edges' cross products.
bool meet(const Corners& triangle, const glm::dvec3& centre, double edge) {
  const auto apart = [&](const glm::dvec3& axis) {
    double low = INFINITY, high = -INFINITY;
    for (const glm::dvec3& p : triangle) {
      low = std::min(low, glm::dot(axis, p - centre));
      high = std::max(high, glm::dot(axis, p - centre));
    }
    const double reach = 0.5 * edge * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return low > reach || high < -reach;
  };
  if (apart(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]))) return false;
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 axis(0);
    axis[a] = 1;
    if (apart(axis)) return false;
    for (std::size_t i = 0; i < 3; ++i)
      if (apart(glm::cross(axis, triangle[(i + 1) % 3] - triangle[i]))) return false;
  }
  return true;
}

Frame frameOf(const glm::ivec3& size, const glm::dvec3& offset = glm::dvec3(0)) {
  Frame frame;
  frame.size = size;
  frame.voxel_size = 1;
  frame.node_to_voxel[3] = glm::dvec4(offset, 1);
  return frame;
}

void add(TriangleSoup& soup, const Corners& corners) {
  TriangleSoup::Triangle& triangle = soup.triangles.emplace_back();
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.vertex[i] = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.emplace_back(corners[i]);
  }
}

Corners cornersOf(const TriangleSoup& soup, std::size_t triangle) {
  Corners out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = glm::dvec3(soup.positions[soup.triangles[triangle].vertex[i]]);
  return out;
}

TEST(SurfaceCount, IsWhatSeparatingAxesSay) {
  std::mt19937 random(7);
  // Large triangles, small ones, and slivers.
  for (const float reach : {20.0f, 1.5f, 0.2f}) {
    for (const float width : {1.0f, 1e-4f}) {
      TriangleSoup soup;
      std::uniform_real_distribution<float> place(0, 24), apart(-reach, reach);
      const auto near = [&](const glm::dvec3& p) {
        return glm::clamp(p + glm::dvec3(apart(random), apart(random), apart(random)), 0.0, 23.9);
      };
      for (int i = 0; i < 8; ++i) {
        const glm::dvec3 a(place(random), place(random), place(random)), b = near(a);
        add(soup, {a, b, glm::mix(a, near(b), double(width))});
      }
      for (const int edge : {1, 4}) {
        double expected = 0;
        for (int cell = 0; cell < (24 / edge) * (24 / edge) * (24 / edge); ++cell) {
          const int side = 24 / edge;
          const glm::dvec3 centre =
              (glm::dvec3(cell % side, cell / side % side, cell / side / side) + 0.5) * double(edge);
          bool touched = false;
          for (std::size_t t = 0; t < soup.triangles.size() && !touched; ++t)
            touched = meet(cornersOf(soup, t), centre, edge);
          expected += touched ? 1 : 0;
        }
        EXPECT_EQ(touchedCells(soup, frameOf({24, 24, 24}), edge), expected)
            << reach << " " << width << " " << edge;
      }
    }
  }
}

TEST(SurfaceCount, CountsEachCellOnceWhateverTheFrame) {
  TriangleSoup soup;
  add(soup, {{{0.5, 0.5, 0.5}, {40.5, 0.5, 0.5}, {0.5, 30.5, 0.5}}});
  const double once = touchedCells(soup, frameOf({41, 31, 1}), 1);
  for (int i = 0; i < 50; ++i) add(soup, cornersOf(soup, 0));
  EXPECT_EQ(touchedCells(soup, frameOf({41, 31, 1}), 1), once);
  EXPECT_EQ(touchedCells(soup, frameOf({2041, 2031, 2001}, {1000, 1000, 1000}), 1), once)
      << "padding is no surface";
  EXPECT_EQ(touchedCells(TriangleSoup(), frameOf({8, 8, 8}), 1), 0);
}

TEST(SurfaceCount, DrawsOutWhatIsTooLargeToCount) {
  // A parallelogram across a box, and the sum of its projections; away from the slopes at which a plane meets
  // corners of cells again and again.
  TriangleSoup plane;
  const glm::dvec3 from(3.1, 7.3, 5.7), along(3960, 130, 0), across(0, 2390, 1691);
  add(plane, {{from, from + along, from + along + across}});
  add(plane, {{from, from + along + across, from + across}});
  const glm::dvec3 area = glm::abs(glm::cross(along, across));
  EXPECT_NEAR(touchedCells(plane, frameOf({4000, 2600, 1800}), 1) / (area.x + area.y + area.z), 1, 0.02);
  // Lines: the sum of their extents along the axes.
  TriangleSoup lines;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 1000);
  double length = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 a(place(random), place(random), place(random)),
        b(place(random), place(random), place(random));
    add(lines, {a, b, a + 1e-3});
    length += std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z);
  }
  EXPECT_NEAR(touchedCells(lines, frameOf({1001, 1001, 1001}), 1) / length, 1, 0.1);
}

}  // namespace
}  // namespace kelp::bake::test
