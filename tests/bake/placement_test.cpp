// SPDX-License-Identifier: MIT
// Where a pack puts a model: up axes, units, padding, and models far from the origin.
#include <algorithm>
#include <limits>
#include <map>

#include "import_scratch.h"

namespace kelp::bake {
namespace {

using test::Scratch;

// A box of 1 x 2 x 3 with one corner at the origin, wound outward.
const char* const kBoxObj =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 1 2 0\nv 0 0 3\nv 1 0 3\nv 0 2 3\nv 1 2 3\n"
    "f 1 3 2\nf 2 3 4\nf 5 6 7\nf 6 8 7\nf 1 2 5\nf 2 6 5\nf 3 7 4\nf 4 7 8\nf 1 5 3\nf 3 5 7\nf 2 4 6\nf 4 "
    "8 6\n";

struct Placed {
  glm::dvec3 low{1e30}, high{-1e30};  // of the solid voxels' corners, in the object
  std::uint64_t voxels = 0;
  RawPack pack;
  Report report;
};

Placed bakeIt(const std::filesystem::path& path, const Settings& settings) {
  Placed placed;
  placed.pack = bake(path, settings, placed.report);
  placed.voxels = placed.report.parts.at(0).solid_voxels;
  return placed;
}

// The box that the part's voxels fill, less `pad` on every side.
void measure(Placed& placed, const glm::ivec3& pad = glm::ivec3(0)) {
  const RawPart& part = placed.pack.parts.at(0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 at(corner & 1 ? part.size.x - pad.x : pad.x, corner & 2 ? part.size.y - pad.y : pad.y,
                       corner & 4 ? part.size.z - pad.z : pad.z);
    const glm::dvec3 object(part.to_object * glm::vec4(at, 1));
    placed.low = glm::min(placed.low, object);
    placed.high = glm::max(placed.high, object);
  }
}

// kBoxObj, baked and measured.
Placed bakeBox(const Settings& settings, const glm::ivec3& pad = glm::ivec3(0)) {
  const Scratch scratch;
  Placed placed = bakeIt(scratch.write("box.obj", kBoxObj), settings);
  measure(placed, pad);
  return placed;
}

void expectBox(const Placed& placed, const glm::dvec3& low, const glm::dvec3& high, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(placed.low[i], low[i], tolerance) << i;
    EXPECT_NEAR(placed.high[i], high[i], tolerance) << i;
  }
}

TEST(Placement, EveryUpAxisStandsUp) {
  // (1, 2, 3) of the file, by hand: the named axis becomes y.
  const std::map<Axis, glm::dvec3> far = {{Axis::kPlusX, {-2, 1, 3}}, {Axis::kMinusX, {2, -1, 3}},
                                          {Axis::kPlusY, {1, 2, 3}},  {Axis::kMinusY, {1, -2, -3}},
                                          {Axis::kPlusZ, {1, 3, -2}}, {Axis::kMinusZ, {1, -3, 2}}};
  for (const auto& [up, corner] : far) {
    SCOPED_TRACE(toString(up));
    Settings settings;
    settings.up = up;
    settings.voxel_size = 0.25;
    const Placed placed = bakeBox(settings);
    expectBox(placed, glm::min(corner, glm::dvec3(0)), glm::max(corner, glm::dvec3(0)), 1e-5);
    EXPECT_EQ(placed.voxels, 4u * 8 * 12);
    EXPECT_GT(glm::determinant(glm::dmat3(placed.pack.parts[0].to_object)), 0);
    // Without an axis of its own the part bends along what is up; the rig's y is the file's up axis.
    const glm::dvec3 along = glm::normalize(glm::dvec3(placed.pack.parts[0].to_object[1]));
    EXPECT_NEAR(along.y, 1, 1e-6);
  }
}

TEST(Placement, UnitsScaleTheObjectAndNotTheVoxels) {
  Settings settings;
  settings.resolution = 24;
  settings.unit = 0.0254;
  const Placed placed = bakeBox(settings);
  expectBox(placed, {0, 0, 0}, {0.0254, 0.0508, 0.0762}, 1e-6);
  EXPECT_EQ(placed.voxels, 8u * 16 * 24);
  EXPECT_NEAR(placed.report.parts[0].voxel_size, 0.0762 / 24, 1e-9);
  // A voxel size is in meters whatever the file is in.
  settings.voxel_size = 0.0254 / 4;
  EXPECT_EQ(bakeBox(settings).voxels, 4u * 8 * 12);
  for (double wrong : {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
    settings.unit = wrong;
    EXPECT_THROW(bakeBox(settings), ToolError) << wrong;
  }
}

TEST(Placement, AnimatedNodesKeepTheirPivotsInTheUnitAndAxis) {
  const Scratch scratch;
  test::GltfMaker maker;
  maker.addBox();
  const auto path = scratch.write(
      "a.gltf",
      maker.text(R"("nodes":[{"mesh":0,"translation":[0,0,5]}],"scenes":[{"nodes":[0]}],"scene":0,)" +
                 test::GltfMaker::boxMesh()));
  Settings settings;
  settings.parts = Parts::kNodes;
  settings.up = Axis::kPlusZ;
  settings.unit = 0.01;
  settings.resolution = 20;
  const Placed placed = bakeIt(path, settings);
  const glm::vec3 pivot = placed.pack.parts[0].pivot[3];
  EXPECT_NEAR(pivot.x, 0, 1e-6);
  EXPECT_NEAR(pivot.y, 0.05, 1e-6);
  EXPECT_NEAR(pivot.z, 0, 1e-6);
}

TEST(Placement, PaddingIsEmptyAndMovesNothing) {
  Settings settings;
  settings.voxel_size = 0.25;
  settings.pad = 3;
  Placed placed = bakeBox(settings, glm::ivec3(3));
  EXPECT_EQ(placed.pack.parts[0].size, glm::ivec3(4 + 6, 8 + 6, 12 + 6));
  EXPECT_EQ(placed.voxels, 4u * 8 * 12);
  expectBox(placed, {0, 0, 0}, {1, 2, 3}, 1e-5);
  // The spline of what bends ends with the source: a rig's unit is the source's length.
  settings.rig_preset = "sway";
  placed = bakeBox(settings, glm::ivec3(3, 0, 3));
  EXPECT_EQ(placed.pack.parts[0].size, glm::ivec3(4 + 6, 8, 12 + 6));
  expectBox(placed, {0, 0, 0}, {1, 2, 3}, 1e-5);
  settings.pad = -1;
  EXPECT_THROW(bakeBox(settings), ToolError);
}

// A box of 2 x 1.4 x 1 under a translated node, the same everywhere.
TEST(Placement, FarFromTheOriginShapesStayWhole) {
  const Scratch scratch;
  const auto bakeAt = [&](double place) {
    test::GltfMaker maker;
    std::vector<float> corners;
    for (int i = 0; i < 8; ++i)
      corners.insert(corners.end(), {i & 1 ? 2.0f : 0.0f, i & 2 ? 1.4f : 0.0f, i & 4 ? 1.0f : 0.0f});
    maker.floats(corners, 3);
    maker.indices({0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                   2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
    const std::string at = std::to_string(place);
    Settings settings;
    settings.resolution = 40;
    return bakeIt(scratch.write("far.gltf", maker.text(R"("nodes":[{"mesh":0,"translation":[)" + at + ",0," +
                                                       at + R"(]}],"scenes":[{"nodes":[0]}],"scene":0,)" +
                                                       test::GltfMaker::boxMesh())),
                  settings);
  };
  const Placed here = bakeAt(0);
  EXPECT_EQ(here.voxels, 40u * 28 * 20);
  EXPECT_TRUE(here.report.notices.empty());
  for (double place : {5000.3, 5000000.3, 10000000.3, 1e9 + 0.3, -1e12 + 0.3}) {
    SCOPED_TRACE(place);
    Placed far = bakeAt(place);
    EXPECT_EQ(far.voxels, here.voxels);
    EXPECT_EQ(far.pack.parts[0].size, here.pack.parts[0].size);
    EXPECT_EQ(test::anyContains(far.report.notices, "far from the origin"), std::abs(place) > 1e4);
    measure(far);
    const double step = std::abs(place) * 0x1p-22;
    expectBox(far, {place, 0, place}, {place + 2, 1.4, place + 1}, step + 1e-5);
  }
}

}  // namespace
}  // namespace kelp::bake
