// SPDX-License-Identifier: MIT
// Frustum grids, points, and grids of one name, against balls known in closed form.
#include <algorithm>
#include <cmath>

#include "import_scratch.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

const glm::dvec3 kFrustumBallCenter(0.1, -0.05, 2.1);
constexpr double kFrustumBallRadius = 0.6;

// 64 voxels a side: 1 wide at the near side, 2.5 at the far one, 4 deep.
VdbSpec frustumBall(const std::string& type, const std::string& grid_class) {
  VdbSpec spec;
  spec.type = type;
  spec.grid_class = grid_class;
  spec.frustum = true;
  spec.frustum_size = glm::ivec3(64);
  spec.taper = 0.4;
  spec.depth = 4;
  spec.low = glm::ivec3(0);
  spec.high = glm::ivec3(64);
  const bool distance = grid_class == "level set", binary = type == "mask" || type == "bool";
  spec.background = glm::dvec3(distance ? 0.3 : 0);
  spec.world_value = [=](const glm::dvec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(p - kFrustumBallCenter) - kFrustumBallRadius;
    if (binary) return d <= 0 ? std::optional(glm::dvec3(1)) : std::nullopt;
    if (type == "vec3s") return glm::clamp((p - kFrustumBallCenter) / 1.4 + 0.5, 0.0, 1.0);
    if (type == "int32") return d < 0.3 ? std::optional(glm::dvec3(std::round(d * 1000))) : std::nullopt;
    if (distance) return d < 0.3 ? std::optional(glm::dvec3(d)) : std::nullopt;
    return d < 0 ? std::optional(glm::dvec3(-d)) : std::nullopt;
  };
  if (type == "int32" && distance) spec.background = glm::dvec3(300);
  return spec;
}

template <class Visit>
void eachVoxel(const VoxelGrid& grid, const Visit& visit) {
  std::size_t i = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x, ++i)
        visit(grid.solid[i] != 0,
              glm::dvec3(glm::dmat4x3(grid.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1)));
}

double edgeOf(const glm::mat4x3& to_node) { return glm::length(glm::dvec3(to_node[0])); }

TEST(VdbKinds, AFrustumGridIsTheBallThatItShows) {
  const Scratch scratch;
  const auto path = scratch.folder() / "frustum.vdb";
  for (const char* type : {"float", "double", "int32", "mask"})
    for (const int resolution : {0, 60}) {
      SCOPED_TRACE(std::string(type) + " " + std::to_string(resolution));
      const bool mask = std::string(type) == "mask";
      writeVdb(path, {frustumBall(type, mask ? "" : "level set")});
      const SourceModel model = importFile(path, with([&](Settings& s) {
                                             s.resolution_given = resolution > 0;
                                             if (resolution > 0) s.resolution = resolution;
                                           }));
      const VoxelGrid& grid = *model.parts[0].grid;
      const double edge = edgeOf(grid.to_node);
      // The trilinear field differs from the ball by its curvature within a voxel of the frustum, at most
      // 0.0625 deep; a mask's voxels are solid or not.
      const double tolerance = mask ? 0.06 : 0.003;
      std::uint64_t wrong = 0;
      double solid = 0;
      eachVoxel(grid, [&](bool is, const glm::dvec3& p) {
        const double d = glm::length(p - kFrustumBallCenter) - kFrustumBallRadius;
        solid += is ? 1 : 0;
        wrong += is != (d <= 0) && std::abs(d) > tolerance ? 1 : 0;
      });
      EXPECT_EQ(wrong, 0u);
      EXPECT_NEAR(solid * edge * edge * edge, 4.18879 * std::pow(kFrustumBallRadius, 3), mask ? 0.03 : 0.01);
      // Cubes with the volume of a frustum voxel in the middle of the leaves, 31 to 36 deep: 0.0358 to
      // 0.0372.
      if (resolution == 0) {
        EXPECT_NEAR(edge, 0.0365, 0.001);
      } else {
        EXPECT_LE(std::max({grid.size.x, grid.size.y, grid.size.z}), 60);
      }
    }
}

TEST(VdbKinds, FrustumFogAndItsHeatKeepTheirMass) {
  const Scratch scratch;
  const auto path = scratch.folder() / "frustum.vdb";
  VdbSpec heat = frustumBall("float", "");
  heat.name = "heat";
  writeVdb(path, {frustumBall("float", "fog volume"), heat});
  const SourceModel model = importFile(path, {});
  const FogGrid& fog = *model.parts[0].fog;
  const double edge = edgeOf(fog.to_node);
  double mass = 0;
  for (const std::uint16_t code : fog.density) mass += code / 65535.0 * fog.extinction / edge;
  // Of a density that falls from the radius in the middle to 0: pi r^4 / 3.
  EXPECT_NEAR(mass * edge * edge * edge, 3.14159265 * std::pow(kFrustumBallRadius, 4) / 3, 0.002);
  EXPECT_EQ(fog.heat, fog.density) << "the same field";
}

TEST(VdbKinds, FrustumColorsAreThoseOfTheirPlace) {
  const Scratch scratch;
  const auto path = scratch.folder() / "frustum.vdb";
  VdbSpec color = frustumBall("vec3s", "");
  color.name = "Cd";
  writeVdb(path, {frustumBall("float", "level set"), color});
  const SourceModel model = importFile(path, {});
  const VoxelGrid& grid = *model.parts[0].grid;
  for (const SurfaceSample& sample : grid.surface) {
    const auto x = static_cast<std::uint64_t>(grid.size.x), y = static_cast<std::uint64_t>(grid.size.y);
    const glm::dvec3 p =
        glm::dmat4x3(grid.to_node) *
        glm::dvec4(glm::dvec3(sample.index % x, sample.index / x % y, sample.index / (x * y)) + 0.5, 1);
    ASSERT_LT(glm::length(glm::dvec3(sample.material.base_color) - ((p - kFrustumBallCenter) / 1.4 + 0.5)),
              0.01);
  }
}

VdbPoints someBalls() {
  VdbPoints points;
  points.places = {{0, 0, 0}, {3, 0.5, -1}, {3.4, 0.9, -1}, {-2, 2, 2}};
  points.radii = {1, 0.75f, 0.5f, 0.3f};
  points.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
  return points;
}

TEST(VdbKinds, PointsAreSpheresOfTheirRadiusAndColor) {
  const Scratch scratch;
  const auto path = scratch.folder() / "points.vdb";
  // Of voxels that are much smaller than its cubes, the grid has too many to look at each.
  for (const auto& [name, voxel] : {std::pair("pscale", 1.0), {"radius", 1.0}, {"pscale", 1e-3}}) {
    VdbPoints points = someBalls();
    points.radius = name;
    points.voxel = voxel;
    writePoints(path, {points});
    const SourceModel model = importFile(path, with([](Settings& s) { s.resolution = 200; }));
    EXPECT_TRUE(anyContains(model.notices, std::string("4 spheres of its points' ") + name));
    const VoxelGrid& grid = *model.parts[0].grid;
    EXPECT_NEAR(std::max({grid.size.x, grid.size.y, grid.size.z}), 200, 2);
    const auto distances = [&](const glm::dvec3& p) {
      std::vector<double> d;
      for (std::size_t i = 0; i < points.places.size(); ++i)
        d.push_back(glm::length(p - points.places[i]) - double{points.radii[i]});
      return d;
    };
    std::uint64_t wrong = 0, solid = 0;
    eachVoxel(grid, [&](bool is, const glm::dvec3& p) {
      const std::vector<double> all = distances(p);
      const double d = *std::min_element(all.begin(), all.end());
      solid += is ? 1 : 0;
      wrong += is != (d <= 0) && std::abs(d) > 1e-4 ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(solid, 100000u);
    for (const SurfaceSample& sample : grid.surface) {
      const auto x = static_cast<std::uint64_t>(grid.size.x), y = static_cast<std::uint64_t>(grid.size.y);
      const glm::dvec3 p =
          glm::dmat4x3(grid.to_node) *
          glm::dvec4(glm::dvec3(sample.index % x, sample.index / x % y, sample.index / (x * y)) + 0.5, 1);
      const std::vector<double> all = distances(p);
      const auto nearest = static_cast<std::size_t>(std::min_element(all.begin(), all.end()) - all.begin());
      if (std::count_if(all.begin(), all.end(), [&](double d) { return d < all[nearest] + 1e-4; }) > 1)
        continue;
      ASSERT_EQ(glm::vec3(sample.material.base_color), points.colors[nearest]);
    }
  }
}

TEST(VdbKinds, PointsWithoutARadiusAreHalfAVoxel) {
  const Scratch scratch;
  const auto path = scratch.folder() / "points.vdb";
  VdbPoints points = someBalls();
  points.radii.clear();
  points.voxel = 0.8;
  writePoints(path, {points});
  const SourceModel model = importFile(path, with([](Settings& s) { s.voxel_size = 0.02; }));
  EXPECT_TRUE(anyContains(model.notices, "4 spheres of 0.4, half its voxels"));
  const VoxelGrid& grid = *model.parts[0].grid;
  EXPECT_NEAR(edgeOf(grid.to_node), 0.02, 1e-7);
  std::uint64_t wrong = 0;
  eachVoxel(grid, [&](bool is, const glm::dvec3& p) {
    double d = INFINITY;
    for (const glm::dvec3& place : points.places) d = std::min(d, glm::length(p - place) - 0.4);
    wrong += is != (d <= 0) && std::abs(d) > 1e-4 ? 1 : 0;
  });
  EXPECT_EQ(wrong, 0u);
}

TEST(VdbKinds, OnePointFarFromAllOthers) {
  const Scratch scratch;
  const auto path = scratch.folder() / "points.vdb";
  VdbPoints points = someBalls();
  points.places.push_back({1000, 0, 0});
  points.radii.assign(points.places.size(), 10);
  points.colors.push_back({1, 1, 1});
  points.voxel = 0.001;
  writePoints(path, {points});
  const SourceModel model = importFile(path, with([](Settings& s) { s.resolution = 128; }));
  EXPECT_NEAR(model.parts[0].grid->size.x, 128, 2);
  points.places.back().x = 2e9;
  points.voxel = 1;
  writePoints(path, {points});
  EXPECT_TRUE(contains(refusal(path, Exit::kUnsupported), "stray points"));
}

TEST(VdbKinds, PointsThatAreNoSpheresAreRefused) {
  const Scratch scratch;
  const auto path = scratch.folder() / "points.vdb";
  for (const float radius : {0.0f, -1.0f, INFINITY, NAN}) {
    VdbPoints points = someBalls();
    points.radii[1] = radius;
    writePoints(path, {points});
    EXPECT_TRUE(contains(refusal(path, Exit::kInvalid), "radius")) << radius;
  }
  writePoints(path, {someBalls()});
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, with([](Settings& s) { s.voxel_size = 1e-5; })),
                       "more than 8192 voxels along a side"));
}

}  // namespace
}  // namespace kelp::bake::test
