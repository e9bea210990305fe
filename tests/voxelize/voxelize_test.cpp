// SPDX-License-Identifier: MIT
// Fill and normals against shapes whose volume, surface and normals are known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "kelp/fields/fields.h"
#include "shapes.h"
#include "support/all_tests.h"

namespace kelp {
namespace {

using test::voxelizeUnit;

constexpr double kHalfTurn = std::numbers::pi;

glm::dvec3 centerOf(const bake::VoxelGrid& grid, std::uint64_t index) {
  const std::uint64_t x = static_cast<std::uint64_t>(grid.size.x),
                      y = static_cast<std::uint64_t>(grid.size.y);
  return glm::dvec3(static_cast<double>(index % x), static_cast<double>(index / x % y),
                    static_cast<double>(index / (x * y))) +
         0.5;
}

// Mean angle, in degrees, between the samples' normals and the exact ones.
double meanNormalError(const bake::VoxelGrid& grid,
                       const std::function<glm::dvec3(const glm::dvec3&)>& exact) {
  double sum = 0;
  for (const bake::SurfaceSample& sample : grid.surface) {
    const glm::dvec3 node(grid.to_node * glm::vec4(glm::vec3(centerOf(grid, sample.index)), 1.0f));
    sum += std::acos(std::min(1.0, glm::dot(glm::dvec3(sample.normal), exact(node)))) * 180.0 / kHalfTurn;
  }
  return sum / static_cast<double>(grid.surface.size());
}

TEST(Voxelize, SphereHasItsVolumeAndItsNormals) {
  constexpr int kSide = test::kSanitized ? 128 : 256;
  bake::TriangleSoup soup;
  test::addSphere(soup, {3, -7, 11}, kSide / 2.0f, 300);
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(baked.grid().size, glm::ivec3(kSide));
  EXPECT_TRUE(baked.result.closed);
  EXPECT_EQ(baked.result.fill, "solid: 1 of 1 component closed");
  const double volume = kHalfTurn / 6.0 * kSide * kSide * kSide;
  EXPECT_NEAR(static_cast<double>(baked.solid), volume, 0.005 * volume);
  EXPECT_LT(meanNormalError(baked.grid(),
                            [](const glm::dvec3& p) { return glm::normalize(p - glm::dvec3(3, -7, 11)); }),
            1.0);
}

TEST(Voxelize, TorusHasItsVolumeAndItsNormals) {
  constexpr int kRing = test::kSanitized ? 46 : 92, kTube = test::kSanitized ? 18 : 36;
  bake::TriangleSoup soup;
  test::addTorus(soup, kRing, kTube, 300);
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(baked.grid().size, 2 * glm::ivec3(kRing + kTube, kTube, kRing + kTube));
  const double volume = 2.0 * kHalfTurn * kHalfTurn * kRing * kTube * kTube;
  EXPECT_NEAR(static_cast<double>(baked.solid), volume, 0.005 * volume);
  const auto exact = [](const glm::dvec3& p) {
    return glm::normalize(p - double{kRing} * glm::normalize(glm::dvec3(p.x, 0, p.z)));
  };
  EXPECT_LT(meanNormalError(baked.grid(), exact), 1.0);
}

// Scanlines that run exactly through edges and vertices count each face once, however it is cut into
// triangles.
TEST(Voxelize, ScanlinesOnEdgesAndVerticesCountOnce) {
  for (int face = 0; face < 6; ++face) {
    bake::TriangleSoup soup;
    test::addBox(soup, {0, 0, 0}, {11, 11, 11}, face);
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    // the middle of a voxel's face: four triangles meet there, and their edges run through voxel centers
    glm::vec3 center(5.5f);
    center[axis] = face % 2 ? 11.0f : 0.0f;
    const glm::vec2 ring[5] = {{0, 0}, {11, 0}, {11, 11}, {0, 11}, {0, 0}};
    for (int k = 0; k < 4; ++k) {
      glm::vec3 a(center), b(center);
      a[u] = ring[k].x;
      a[v] = ring[k].y;
      b[u] = ring[k + 1].x;
      b[v] = ring[k + 1].y;
      test::addTriangle(soup, center, face % 2 ? a : b, face % 2 ? b : a);
    }
    EXPECT_EQ(voxelizeUnit(test::makeModel(soup)).solid, 11u * 11u * 11u) << "face " << face;
  }
}

TEST(Voxelize, SurfaceIsExactlyTheSurfaceVoxelsWithUnitNormals) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 12.0f, 24);
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  const std::vector<std::uint64_t> expected =
      fields::surfaceVoxels({baked.grid().size, baked.grid().solid}, 1);
  ASSERT_EQ(baked.grid().surface.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(baked.grid().surface[i].index, expected[i]);
    EXPECT_NEAR(glm::length(baked.grid().surface[i].normal), 1.0f, 1e-5f);
  }
}

TEST(Voxelize, InsideOutIsTheSameSolid) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 20.0f, 40);
  const test::Baked outward = voxelizeUnit(test::makeModel(soup));
  test::turnInsideOut(soup);
  const test::Baked inward = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(outward.grid().solid, inward.grid().solid);
  for (std::size_t i = 0; i < outward.grid().surface.size(); ++i) {
    EXPECT_GT(glm::dot(outward.grid().surface[i].normal, inward.grid().surface[i].normal), 0.999f);
  }
}

TEST(Voxelize, MixedWindingIsTheSameSolid) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 20.0f, 40);
  const test::Baked consistent = voxelizeUnit(test::makeModel(soup));
  std::mt19937 random(1);
  for (bake::TriangleSoup::Triangle& triangle : soup.triangles) {
    if (random() % 2 == 0) std::swap(triangle.vertex[0], triangle.vertex[1]);
  }
  const test::Baked mixed = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(consistent.grid().solid, mixed.grid().solid);
}

TEST(Voxelize, FacesModeledTwiceAreOne) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 20.0f, 40);
  const test::Baked once = voxelizeUnit(test::makeModel(soup));
  bake::TriangleSoup back = soup;
  test::turnInsideOut(back);
  soup.triangles.insert(soup.triangles.end(), back.triangles.begin(), back.triangles.end());
  const test::Baked twice = voxelizeUnit(test::makeModel(soup));
  EXPECT_EQ(once.grid().solid, twice.grid().solid);
}

// Blocks side by side, as building kits and voxel editors export them: each closed, with both of their faces
// where two meet.
bake::TriangleSoup blocks(float edge) {
  bake::TriangleSoup soup;
  for (int i = 0; i < 27; ++i) {
    const glm::vec3 low =
        edge * glm::vec3(static_cast<float>(i % 3), static_cast<float>(i / 3 % 3), static_cast<float>(i / 9));
    test::addBox(soup, low, low + edge);
  }
  return soup;
}

// How many voxels of the skin of a box, two or more away from its edges, have another normal than its face.
int normalsAside(const bake::VoxelGrid& grid) {
  int wrong = 0;
  for (const bake::SurfaceSample& sample : grid.surface) {
    const glm::dvec3 p = centerOf(grid, sample.index);
    glm::dvec3 face(0);
    int near = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = p[axis], high = grid.size[axis] - p[axis];
      near += std::min(low, high) < 3.0;
      if (low < 1.0) face[axis] = -1;
      if (high < 1.0) face[axis] = 1;
    }
    if (near == 1) wrong += glm::dot(face, glm::dvec3(sample.normal)) < 0.99;
  }
  return wrong;
}

TEST(Voxelize, BlocksThatTouchAreOneBody) {
  const test::Baked baked = voxelizeUnit(test::makeModel(blocks(6.0f)));
  EXPECT_EQ(baked.solid, 18u * 18u * 18u) << baked.result.fill;
  EXPECT_TRUE(baked.result.closed) << baked.result.fill;
  for (const float edge : {5.5f, 6.0f, 6.3f, 6.8f}) {
    const test::Baked seams = voxelizeUnit(test::makeModel(blocks(edge)));
    EXPECT_EQ(normalsAside(seams.grid()), 0) << "the walls of blocks of " << edge << " show";
  }
}

TEST(Voxelize, LeavesModeledFromBothSidesStayOnTheirStem) {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {6, 30, 6});
  for (const bool back : {false, true}) {
    // It shares its edge with two of the stem's faces.
    const glm::vec3 a(6, 0, 0), b(6, 30, 0), c(20.5f, 15, -10);
    back ? test::addTriangle(soup, a, c, b) : test::addTriangle(soup, a, b, c);
  }
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_TRUE(baked.result.closed) << baked.result.fill;
  EXPECT_TRUE(baked.at(3, 15, 13)) << "inside of the stem";
  EXPECT_TRUE(baked.at(18, 15, 1)) << "the leaf";
}

TEST(Voxelize, OverlappingAndNestedBodiesAreTheirUnion) {
  bake::TriangleSoup overlapping;
  test::addBox(overlapping, {0, 0, 0}, {10, 10, 10});
  test::addBox(overlapping, {6, 0, 0}, {16, 10, 10});
  EXPECT_EQ(voxelizeUnit(test::makeModel(overlapping)).solid, 16u * 10u * 10u);

  // The inner shell may be wound inward, as a hollow ball is modeled: nobody sees the cavity, and it would
  // cost memory.
  for (const bool inward : {false, true}) {
    bake::TriangleSoup nested;
    test::addBox(nested, {5, 5, 5}, {15, 15, 15});
    if (inward) test::turnInsideOut(nested);
    test::addBox(nested, {0, 0, 0}, {20, 20, 20});
    EXPECT_EQ(voxelizeUnit(test::makeModel(nested)).solid, 20u * 20u * 20u) << inward;
  }
}

TEST(Voxelize, NormalsIgnoreTrianglesHiddenInTheUnion) {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {20, 20, 20});
  test::addBox(soup, {4.3f, 4.3f, 0.7f}, {15.6f, 15.6f, 10.0f});  // its -z face lies 0.7 beneath the other's
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  for (const bake::SurfaceSample& sample : baked.grid().surface) {
    const glm::dvec3 p = centerOf(baked.grid(), sample.index);
    if (p.z < 1.0 && p.x > 5 && p.x < 15 && p.y > 5 && p.y < 15) {
      EXPECT_LT(sample.normal.z, -0.99f);
    }
  }

  // Bodies that overlap with their sides flush: the hidden ends stand across what is seen.
  for (const float at : {10.1f, 10.4f, 10.7f}) {
    bake::TriangleSoup flush;
    test::addBox(flush, {0, 0, 0}, {20, 12, 12});
    test::addBox(flush, {at, 0, 0}, {30, 12, 12});
    EXPECT_EQ(normalsAside(voxelizeUnit(test::makeModel(flush)).grid()), 0)
        << "the end at " << at << " shows";
  }
}

TEST(Voxelize, HolesAreClosedByFans) {
  bake::TriangleSoup soup;  // the lowest 25 degrees are missing: far wider than a voxel
  test::addSphere(soup, {0, 0, 0}, 40.0f, 90,
                  [](float latitude) { return latitude > -65.0f * std::numbers::pi_v<float> / 180.0f; });
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  EXPECT_FALSE(baked.result.closed);
  EXPECT_NE(baked.result.fill.find("1 hole closed by fans"), std::string::npos) << baked.result.fill;
  const double h = 40.0 * (1.0 - std::sin(65.0 * kHalfTurn / 180.0));
  const double volume = 4.0 / 3.0 * kHalfTurn * 40.0 * 40.0 * 40.0 - kHalfTurn * h * h * (40.0 - h / 3.0);
  EXPECT_NEAR(static_cast<double>(baked.solid), volume, 0.01 * volume);
  // The fan is flat and faces down, though no triangle of the mesh is near.
  const int middle = baked.grid().size.x / 2;
  EXPECT_TRUE(baked.at(middle, 0, middle));
  for (const bake::SurfaceSample& sample : baked.grid().surface) {
    const glm::dvec3 p = centerOf(baked.grid(), sample.index);
    if (p.y < 1 && std::hypot(p.x - middle, p.z - middle) < 10) {
      EXPECT_LT(sample.normal.y, -0.99f);
    }
  }
}

TEST(Voxelize, OpenSheetsStaySheets) {
  bake::TriangleSoup bowl;
  test::addSphere(bowl, {0, 0, 0}, 30.0f, 60, [](float latitude) { return latitude < 0; });
  const test::Baked baked = voxelizeUnit(test::makeModel(bowl));
  EXPECT_EQ(baked.result.fill.substr(0, 8), "surface:") << baked.result.fill;
  const int middle = baked.grid().size.x / 2;
  EXPECT_FALSE(baked.at(middle, baked.grid().size.y / 2, middle)) << "the bowl is full";
  EXPECT_TRUE(baked.at(middle, 0, middle));
  // Tight: every vertical line through the bowl's opening meets it.
  for (int z = 0; z < baked.grid().size.z; ++z) {
    for (int x = 0; x < baked.grid().size.x; ++x) {
      if (std::hypot(x + 0.5 - 30.0, z + 0.5 - 30.0) > 29.5) continue;
      int hits = 0;
      for (int y = 0; y < baked.grid().size.y; ++y) hits += baked.at(x, y, z);
      EXPECT_GT(hits, 0) << x << " " << z;
    }
  }
}

// A sheet has one normal at each place, whichever way the voxels' steps happen to open: no rings where
// neighbors disagree.
TEST(Voxelize, OpenSheetsHaveSmoothNormals) {
  const auto radial = [](const glm::dvec3& p) { return glm::normalize(p); };
  const auto around = [](const glm::dvec3& p) { return glm::normalize(glm::dvec3(p.x, 0, p.z)); };
  bake::TriangleSoup bowl, pipe, inward;
  test::addSphere(bowl, {0, 0, 0}, 50.3f, 120, [](float latitude) { return latitude < 0; });
  test::addSphere(inward, {0, 0, 0}, 50.3f, 120, [](float latitude) { return latitude < 0; });
  test::turnInsideOut(inward);
  test::addRod(pipe, {0, 0, 0}, {0, 60, 0}, 20.4f);
  const auto onRing = [&](const bake::TriangleSoup::Triangle& t) {
    return pipe.positions[t.vertex[0]].y == pipe.positions[t.vertex[1]].y &&
           pipe.positions[t.vertex[1]].y == pipe.positions[t.vertex[2]].y;
  };
  pipe.triangles.erase(std::remove_if(pipe.triangles.begin(), pipe.triangles.end(), onRing),
                       pipe.triangles.end());
  struct Case {
    const char* name;
    bake::TriangleSoup soup;
    std::function<glm::dvec3(const glm::dvec3&)> exact;
    double bound;  // degrees; a rod has few sides
  };
  for (const Case& its : {Case{"bowl", bowl, radial, 1.5}, Case{"inward bowl", inward, radial, 1.5},
                          Case{"pipe", pipe, around, 12.0}}) {
    const test::Baked baked = voxelizeUnit(test::makeModel(its.soup));
    ASSERT_EQ(baked.result.fill.substr(0, 8), "surface:") << its.name;
    const double error = meanNormalError(baked.grid(), its.exact);
    EXPECT_LT(std::min(error, 180.0 - error), its.bound) << its.name;
    std::vector<const bake::SurfaceSample*> at(baked.grid().solid.size(), nullptr);
    for (const bake::SurfaceSample& sample : baked.grid().surface) at[sample.index] = &sample;
    const std::size_t stride[3] = {
        1, static_cast<std::size_t>(baked.grid().size.x),
        static_cast<std::size_t>(baked.grid().size.x) * static_cast<std::size_t>(baked.grid().size.y)};
    std::size_t turned = 0;
    for (const bake::SurfaceSample& sample : baked.grid().surface) {
      for (int axis = 0; axis < 3; ++axis) {
        if (centerOf(baked.grid(), sample.index)[axis] + 1 > baked.grid().size[axis]) continue;
        const bake::SurfaceSample* next = at[sample.index + stride[axis]];
        turned += next && glm::dot(sample.normal, next->normal) < 0;
      }
    }
    EXPECT_EQ(turned, 0u) << its.name;
  }
}

// A sleeve with its cuff folded back, both wound to be seen from outside; and the same sleeve with a strip
// wound by mistake.
TEST(Voxelize, FoldedSheetsShowTheSideThatWasMeant) {
  for (const bool folded : {true, false}) {
    bake::TriangleSoup soup;
    const auto point = [](float angle, float radius, float y) {
      return glm::vec3(radius * std::cos(angle), y, radius * std::sin(angle));
    };
    for (int k = 0; k < 64; ++k) {
      const float a = static_cast<float>(2 * kHalfTurn) * static_cast<float>(k) / 64,
                  b = static_cast<float>(2 * kHalfTurn) * static_cast<float>((k + 1) % 64) / 64;
      const auto band = [&](float y0, float r0, float y1, float r1, bool outward) {
        const glm::vec3 p = point(a, r0, y0), q = point(b, r0, y0), r = point(a, r1, y1),
                        s = point(b, r1, y1);
        test::addTriangle(soup, p, outward ? r : q, outward ? q : r);
        test::addTriangle(soup, q, outward ? r : s, outward ? s : r);
      };
      band(0, 20, 50, 20, true);
      band(-20, 20, 0, 20, folded);
      if (folded) band(-20, 20, 0, 26, true);
    }
    const test::Baked baked = voxelizeUnit(test::makeModel(soup));
    ASSERT_EQ(baked.result.fill.substr(0, 8), "surface:") << baked.result.fill;
    const double middle = 0.5 * baked.grid().size.x;
    for (const bake::SurfaceSample& sample : baked.grid().surface) {
      const glm::dvec3 p = centerOf(baked.grid(), sample.index);
      const glm::dvec3 outward = glm::normalize(glm::dvec3(p.x - middle, 0, p.z - middle));
      ASSERT_GT(glm::dot(glm::dvec3(sample.normal), outward), 0.8)
          << "folded " << folded << " at " << p.x << " " << p.y << " " << p.z;
    }
  }
}

// A sheet that lies on a body is seen from outside, however it is wound.
TEST(Voxelize, SheetsOnBodiesFaceTheOpen) {
  for (const bool turn : {false, true}) {
    bake::TriangleSoup soup;
    test::addTriangle(soup, {4, 20.4f, 4}, turn ? glm::vec3(4, 20.4f, 28) : glm::vec3(28, 20.4f, 4),
                      turn ? glm::vec3(28, 20.4f, 4) : glm::vec3(4, 20.4f, 28));
    test::addBox(soup, {0, 0, 0}, {30, 20, 30});
    const test::Baked baked = voxelizeUnit(test::makeModel(soup));
    std::size_t seen = 0;
    for (const bake::SurfaceSample& sample : baked.grid().surface) {
      if (centerOf(baked.grid(), sample.index).y < 20) continue;
      ++seen;
      EXPECT_GT(sample.normal.y, 0.99f);
    }
    EXPECT_GT(seen, 200u);
  }
}

TEST(Voxelize, FillCanBeForced) {
  bake::TriangleSoup box;
  test::addBox(box, {0, 0, 0}, {10, 10, 10}, 3);  // without a lid: a fifth of its surface
  EXPECT_EQ(voxelizeUnit(test::makeModel(box)).solid, 1000u - 8u * 8u * 9u);
  EXPECT_EQ(voxelizeUnit(test::makeModel(box), bake::Fill::kSolid).solid, 1000u);
  bake::TriangleSoup closed;
  test::addBox(closed, {0, 0, 0}, {10, 10, 10});
  EXPECT_EQ(voxelizeUnit(test::makeModel(closed), bake::Fill::kSurface).solid, 1000u - 8u * 8u * 8u);

  bake::TriangleSoup sheet;
  test::addTriangle(sheet, {0, 0, 0}, {10, 0, 0}, {0, 10, 3});
  const std::string said = voxelizeUnit(test::makeModel(sheet), bake::Fill::kSolid).result.fill;
  EXPECT_NE(said.find("(100 % of its surface)"), std::string::npos) << said;
}

TEST(Voxelize, AnyNumberOfThreadsGivesTheSame) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 30.0f, 50);
  test::addTorus(soup, 40.0f, 6.0f, 60);
  test::addRod(soup, {-50, -20, 3}, {40, 33, -20}, 0.2f);
  test::addSphere(soup, {20, 0, 0}, 25.0f, 30, [](float latitude) { return latitude < 0.5f; });
  const bake::SourceModel model = test::makeModel(soup);
  const test::Baked one = voxelizeUnit(model, bake::Fill::kAuto, 1);
  for (const int threads : {2, 3, 8}) {
    const test::Baked many = voxelizeUnit(model, bake::Fill::kAuto, threads);
    EXPECT_EQ(one.grid().solid, many.grid().solid);
    ASSERT_EQ(one.grid().surface.size(), many.grid().surface.size());
    for (std::size_t i = 0; i < one.grid().surface.size(); ++i) {
      ASSERT_EQ(one.grid().surface[i].normal, many.grid().surface[i].normal);
      ASSERT_EQ(one.grid().surface[i].material.base_color, many.grid().surface[i].material.base_color);
    }
  }
}

TEST(MakeFrame, FitsTheBoxAndTurnsTheAxis) {
  bake::TriangleSoup soup;
  test::addBox(soup, {1, 2, 3}, {5, 10, 6});
  const bake::Frame up = bake::makeFrame(soup, Axis::kPlusY, 0.5, "box");
  EXPECT_EQ(up.size, glm::ivec3(8, 16, 6));
  EXPECT_NEAR(glm::distance(glm::dvec3(up.node_to_voxel * glm::dvec4(1, 2, 3, 1)), glm::dvec3(0)), 0.0, 1e-9);
  const bake::Frame along = bake::makeFrame(soup, Axis::kMinusX, 0.5, "box");
  EXPECT_EQ(along.size.y, 8);
  // -x runs up: the box's high x is the bottom.
  EXPECT_NEAR((along.node_to_voxel * glm::dvec4(5, 2, 3, 1)).y, 0.0, 1e-9);
  EXPECT_NEAR((along.node_to_voxel * glm::dvec4(1, 2, 3, 1)).y, 8.0, 1e-9);
  EXPECT_GT(glm::determinant(glm::dmat3(along.node_to_voxel)), 0.0) << "mirrored";
  // A box that does not divide evenly is centered.
  const bake::Frame odd = bake::makeFrame(soup, Axis::kPlusY, 3.0, "box");
  EXPECT_EQ(odd.size, glm::ivec3(2, 3, 1));
  EXPECT_NEAR((odd.node_to_voxel * glm::dvec4(3, 6, 4.5, 1)).y, 1.5, 1e-9);
}

TEST(MakeFrame, RefusesWhatHasNoBox) {
  bake::TriangleSoup soup;
  EXPECT_THROW(bake::makeFrame(soup, Axis::kPlusY, 1.0, "nothing"), kelp::ToolError);
  test::addBox(soup, {0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(bake::makeFrame(soup, Axis::kPlusY, 0.0, "box"), kelp::ToolError);
  EXPECT_THROW(bake::makeFrame(soup, Axis::kPlusY, 1e-5, "box"), kelp::ToolError);
  EXPECT_THROW(bake::makeFrame(soup, Axis::kPlusY, 1e13, "box"), kelp::ToolError);
  soup.triangles[0].vertex[0] = 1000;
  EXPECT_THROW(bake::makeFrame(soup, Axis::kPlusY, 1.0, "box"), kelp::ToolError);
}

// A square so far along its normal that a division and a product round it to places a voxel and more apart.
TEST(MakeFrame, RefusesWhatLiesTooFarToBeTold) {
  const auto squareAt = [](float x) {
    bake::TriangleSoup soup;
    soup.positions = {{x, 0, 0}, {x, 7, 0}, {x, 7, 7}, {x, 0, 7}};
    soup.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
    return soup;
  };
  for (const Axis axis : {Axis::kPlusY, Axis::kMinusX, Axis::kPlusZ}) {
    for (const float x : {0x1p37f, -0x1.3579p37f}) {
      const bake::Frame frame = bake::makeFrame(squareAt(x), axis, 0.7, "square");
      const glm::dvec3 there(frame.node_to_voxel * glm::dvec4(x, 3.5, 3.5, 1));
      EXPECT_LT(glm::distance(there, glm::dvec3(frame.size) / 2.0), 1.0 / 8192) << x;
    }
    for (const float x : {0x1p39f, -1e30f, std::numeric_limits<float>::max()}) {
      try {
        bake::makeFrame(squareAt(x), axis, 0.7, "square");
        ADD_FAILURE() << x;
      } catch (const kelp::ToolError& error) {
        EXPECT_EQ(error.exit, kelp::Exit::kInvalid);
        EXPECT_NE(std::string(error.what()).find("from its origin"), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace kelp
