// SPDX-License-Identifier: MIT
// Points found by their coordinates against std::map, and edges sorted by vertex against std::sort.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "edges.h"
#include "kelp/common/point_index.h"

namespace kelp::bake {
namespace {

// Small boxes give many equal points, long ones rows of points that lie in steps, as on grids.
TEST(PointIndex, NumbersPointsInTheOrderOfTheirFirstUse) {
  std::mt19937 random(1);
  for (const glm::i64vec3& box :
       {glm::i64vec3(9, 9, 9), glm::i64vec3(100000, 1, 1), glm::i64vec3(1, 2, 5000)}) {
    PointIndex<glm::i64vec3> index;
    std::vector<glm::i64vec3> points;
    std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::uint32_t> truth;
    for (int i = 0; i < 20000; ++i) {
      glm::i64vec3 p;
      for (int axis = 0; axis < 3; ++axis)
        p[axis] =
            (std::uniform_int_distribution<std::int64_t>(0, box[axis] - 1)(random) - box[axis] / 2) * 4096;
      const auto [at, fresh] = truth.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(points.size()));
      ASSERT_EQ(index.of(p, points), at->second);
      ASSERT_EQ(points.size(), truth.size());
      ASSERT_EQ(points[at->second], p);
    }
  }
}

// Few vertices, so that edges have many triangles; one that is a corner of all; and so many that several
// threads share them.
TEST(SortedEdges, AreThoseOfTheTrianglesInOrder) {
  std::mt19937 random(2);
  for (const std::uint32_t vertices : {1u, 4u, 60u, 3000u, 200000u}) {
    for (const bool hub : {false, true}) {
      Topology mesh;
      mesh.lattice.resize(vertices);
      std::uniform_int_distribution<std::uint32_t> any(0, vertices - 1);
      for (std::uint32_t i = 0; i < std::max(2000u, vertices / 2); ++i) {
        SolidTriangle t;
        for (std::uint32_t& v : t.vertex) v = any(random);
        if (hub) t.vertex[random() % 3] = vertices / 2;
        t.wall = random() % 3 == 0;
        mesh.triangles.push_back(t);
      }
      for (const bool separate : {false, true}) {
        using Row = std::tuple<std::uint32_t, std::uint32_t, bool, std::uint32_t, std::uint32_t, bool>;
        std::vector<Row> truth, found;
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
          for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[i].vertex[k], b = mesh.triangles[i].vertex[(k + 1) % 3];
            truth.emplace_back(std::min(a, b), std::max(a, b), separate && mesh.triangles[i].wall, i, k,
                               a < b);
          }
        }
        std::sort(truth.begin(), truth.end());
        for (const int threads : {0, 1, 2, 7, 1000}) {
          found.clear();
          for (const Edge& e : sortedEdges(mesh, separate, threads))
            found.emplace_back(e.low, e.high, e.wall, e.triangle, e.side, e.forward);
          EXPECT_TRUE(found == truth) << vertices << " vertices, " << threads << " threads";
        }
      }
    }
  }
}

}  // namespace
}  // namespace kelp::bake
