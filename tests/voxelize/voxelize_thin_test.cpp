// SPDX-License-Identifier: MIT
// Meshes thinner than a voxel: plates, wires, tips and specks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shapes.h"

namespace kelp {
namespace {

using test::voxelizeUnit;

// A plate of any thickness and tilt has no pinhole along the three axes and keeps to its place.
TEST(VoxelizeThin, ThinPlatesHaveNoHoles) {
  for (const float thickness : {0.05f, 0.3f, 0.6f, 0.9f}) {
    for (const float slope : {0.0f, 0.05f, 0.5f}) {
      bake::TriangleSoup soup;
      test::addBox(soup, {0, 0, 0}, {40, thickness, 40});
      for (glm::vec3& p : soup.positions) p.y += slope * p.x;
      const test::Baked baked = voxelizeUnit(test::makeModel(soup));
      const glm::ivec3 size = baked.grid().size;
      for (int z = 0; z < size.z; ++z) {
        for (int x = 0; x < size.x; ++x) {
          int hits = 0;
          for (int y = 0; y < size.y; ++y) hits += baked.at(x, y, z);
          ASSERT_GE(hits, 1) << "thickness " << thickness << " slope " << slope << " at " << x << " " << z;
          ASSERT_LE(hits, 2) << "thickness " << thickness << " slope " << slope << " at " << x << " " << z;
        }
      }
    }
  }
}

// Parallel plates stay apart: each is its own row of voxels (or two where it straddles), and a row that no
// plate owns is empty.
TEST(VoxelizeThin, ThinPlatesDoNotFuse) {
  struct Case {
    float thickness, gap, inset;
  };
  for (const Case& its : {Case{0.7f, 1.0f, 0}, Case{0.7f, 1.6f, 0}, Case{0.5f, 1.0f, 0},
                          Case{0.7f, 1.0f, 0.3f}, Case{0.7f, 1.6f, 0.3f}, Case{0.5f, 1.0f, 0.3f}}) {
    const std::string what = testing::PrintToString(its.thickness) + " / " + testing::PrintToString(its.gap) +
                             " inset " + testing::PrintToString(its.inset);
    bake::TriangleSoup soup;
    for (int k = 0; k < 12; ++k) {
      // so that some end within a voxel
      const float y = static_cast<float>(k) * (its.thickness + its.gap), inset = k % 2 ? its.inset : 0.0f;
      test::addBox(soup, {inset, y, inset}, {20 - inset, y + its.thickness, 20 - inset});
    }
    const test::Baked baked = voxelizeUnit(test::makeModel(soup));
    const glm::ivec3 size = baked.grid().size;
    std::vector<int> filled(static_cast<std::size_t>(size.y), 0);
    for (int y = 0; y < size.y; ++y) {
      for (int z = 0; z < size.z; ++z) {
        for (int x = 0; x < size.x; ++x) filled[static_cast<std::size_t>(y)] += baked.at(x, y, z);
      }
    }
    std::vector<int> owned(static_cast<std::size_t>(size.y), 0);
    for (int k = 0; k < 12; ++k) {
      // Voxels are cubes, and the box is centered in whole ones.
      const auto row = [&](float y) {
        return static_cast<int>(
            std::floor((baked.frame.node_to_voxel * glm::dvec4(0, static_cast<double>(y), 0, 1)).y));
      };
      const float y = static_cast<float>(k) * (its.thickness + its.gap);
      int whole = 0;
      for (int r = row(y); r <= std::min(row(y + its.thickness), size.y - 1); ++r) {
        owned[static_cast<std::size_t>(r)] = 1;
        whole += filled[static_cast<std::size_t>(r)] == size.x * size.z;
      }
      EXPECT_GE(whole, 1) << what << ": plate " << k;
    }
    int rows = 0;
    for (int y = 0; y < size.y; ++y) {
      rows += filled[static_cast<std::size_t>(y)] > 0;
      EXPECT_TRUE(owned[static_cast<std::size_t>(y)] || filled[static_cast<std::size_t>(y)] == 0)
          << what << ": row " << y << " has " << filled[static_cast<std::size_t>(y)];
    }
    EXPECT_EQ(rows, 12) << what;
  }
}

// Solid voxels of the grid that hang together with the first one.
std::size_t connectedCount(const test::Baked& baked) {
  const glm::ivec3 size = baked.grid().size;
  std::vector<std::uint8_t> seen(baked.grid().solid.size(), 0);
  std::vector<glm::ivec3> stack;
  const auto index = [&](const glm::ivec3& v) {
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(size.x) *
               (static_cast<std::size_t>(v.y) +
                static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z));
  };
  for (int z = 0; z < size.z && stack.empty(); ++z) {
    for (int y = 0; y < size.y && stack.empty(); ++y) {
      for (int x = 0; x < size.x && stack.empty(); ++x) {
        if (baked.at(x, y, z)) stack.push_back({x, y, z});
      }
    }
  }
  std::size_t count = 0;
  seen[index(stack.front())] = 1;
  while (!stack.empty()) {
    const glm::ivec3 v = stack.back();
    stack.pop_back();
    ++count;
    for (int cell = 0; cell < 27; ++cell) {
      const glm::ivec3 n = v + glm::ivec3(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1);
      if (n.x < 0 || n.y < 0 || n.z < 0 || n.x >= size.x || n.y >= size.y || n.z >= size.z ||
          !baked.at(n.x, n.y, n.z) || seen[index(n)])
        continue;
      seen[index(n)] = 1;
      stack.push_back(n);
    }
  }
  return count;
}

TEST(VoxelizeThin, TipsOfThickBodiesStay) {
  bake::TriangleSoup soup;  // a spike of 3 x 3 voxels that ends in a point 60 away
  const glm::vec3 base[4] = {{0, 0, 0}, {3, 0, 0}, {3, 0, 3}, {0, 0, 3}};
  const glm::vec3 tip(1.9f, 60.0f, 1.2f);
  for (int k = 0; k < 4; ++k) test::addTriangle(soup, base[k], tip, base[(k + 1) % 4]);
  test::addTriangle(soup, base[0], base[1], base[2]);
  test::addTriangle(soup, base[0], base[2], base[3]);
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(connectedCount(baked), baked.solid);
  int top = 0;
  for (int z = 0; z < baked.grid().size.z; ++z) {
    for (int x = 0; x < baked.grid().size.x; ++x) top += baked.at(x, 59, z);
  }
  EXPECT_GE(top, 1);
}

TEST(VoxelizeThin, SpecksLeaveAVoxel) {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {20, 20, 20});
  test::addBox(soup, {30.6f, 10.6f, 10.6f}, {30.7f, 10.7f, 10.7f});
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(baked.solid, 8001u);
}

}  // namespace
}  // namespace kelp
