// SPDX-License-Identifier: MIT
// Level sets against the sphere's own formulas.
#include <kelp/common/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <numbers>

#include "import_scratch.h"
#include "support/all_tests.h"

namespace kelp::bake::test {
namespace {

std::filesystem::path writeGrids(const Scratch& scratch, const openvdb::GridCPtrVec& grids) {
  const auto path = scratch.folder() / "grids.vdb";
  openvdb::io::File file(path.string());
  file.write(grids);
  file.close();
  return path;
}

openvdb::FloatGrid::Ptr sphere(float radius, const openvdb::Vec3f& center, float voxel) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, center, voxel);
  grid->setName("ball");
  return grid;
}

struct Measure {
  double volume = 0;  // of the object
  glm::dvec3 center{0};
  double mean_normal_error = 0;  // degrees, against the direction from the center
};

Measure measure(const SourceModel& model) {
  const VoxelGrid& grid = *model.parts[0].grid;
  const glm::dmat4x3 to_node(grid.to_node);
  Measure out;
  double count = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x)
        if (grid.solid[static_cast<std::size_t>(x) +
                       static_cast<std::size_t>(grid.size.x) *
                           (static_cast<std::size_t>(y) +
                            static_cast<std::size_t>(grid.size.y) * static_cast<std::size_t>(z))]) {
          ++count;
          out.center += to_node * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1);
        }
  out.center /= count;
  out.volume = count * std::abs(glm::determinant(glm::dmat3(to_node)));
  for (const SurfaceSample& sample : grid.surface) {
    const auto i = sample.index;
    const glm::dvec3 voxel(double(i % std::uint64_t(grid.size.x)) + 0.5,
                           double(i / std::uint64_t(grid.size.x) % std::uint64_t(grid.size.y)) + 0.5,
                           double(i / (std::uint64_t(grid.size.x) * std::uint64_t(grid.size.y))) + 0.5);
    const glm::dvec3 wanted = glm::normalize(to_node * glm::dvec4(voxel, 1) - out.center);
    const glm::dvec3 normal =
        glm::normalize(glm::transpose(glm::inverse(glm::dmat3(to_node))) * glm::dvec3(sample.normal));
    out.mean_normal_error +=
        std::acos(std::clamp(glm::dot(wanted, normal), -1.0, 1.0)) * 57.29578 / double(grid.surface.size());
  }
  return out;
}

constexpr double ballVolume(double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; }

TEST(ImportVdb, ASphereKeepsItsVoxelsItsPlaceAndItsVolume) {
  const Scratch scratch;
  const SourceModel model = importFile(writeGrids(scratch, {sphere(2.0f, {5, -3, 1}, 0.05f)}), {});
  const VoxelGrid& grid = *model.parts[0].grid;
  EXPECT_NEAR(grid.size.x, 80, 1);
  EXPECT_NEAR(grid.to_node[0][0], 0.05f, 1e-6);
  const Measure m = measure(model);
  EXPECT_NEAR(m.volume, ballVolume(2), 0.01 * ballVolume(2));
  EXPECT_LT(glm::length(m.center - glm::dvec3(5, -3, 1)), 0.01);
  EXPECT_LT(m.mean_normal_error, 0.5);
}

TEST(ImportVdb, ResolutionAndVoxelSizeResample) {
  const Scratch scratch;
  const auto path = writeGrids(scratch, {sphere(2.0f, {5, -3, 1}, 0.05f)});
  Settings settings;
  settings.resolution = 100;
  settings.resolution_given = true;
  SourceModel model = importFile(path, settings);
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(100));
  Measure m = measure(model);
  EXPECT_NEAR(m.volume, ballVolume(2), 0.01 * ballVolume(2));
  EXPECT_LT(glm::length(m.center - glm::dvec3(5, -3, 1)), 0.01);
  EXPECT_LT(m.mean_normal_error, 0.5);
  settings.voxel_size = 0.1;
  model = importFile(path, settings);
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(40));
}

TEST(ImportVdb, PaddingTakesMemoryToo) {
  const Scratch scratch;
  const auto path = writeGrids(scratch, {sphere(2.0f, {5, -3, 1}, 0.05f)});
  const auto needs = [&](int pad, std::uint64_t limit) {
    Settings settings;
    settings.pad = pad;
    settings.max_memory = limit;
    Report report;
    bake(path, settings, report);
    return report.estimated_bytes;
  };
  // A box of 880 voxels a side: 0.63 GiB at a byte each.
  try {
    needs(400, std::uint64_t{300} << 20);
    FAIL() << "baked";
  } catch (const ToolError& error) {
    EXPECT_EQ(error.exit, Exit::kRuntime);
    EXPECT_NE(std::string(error.what()).find("would fit"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("--pad 0"), std::string::npos) << error.what();
  }
  if (kelp::test::kSanitized) return;  // these are large, and not of untrusted bytes
  // Boxes of 360 and of 320, both more than the least that any bake needs.
  EXPECT_GT(needs(140, 0), needs(120, 0) + 360 * 360 * 360 - 320 * 320 * 320)
      << "a byte for each voxel that is added";
}

}  // namespace
}  // namespace kelp::bake::test
