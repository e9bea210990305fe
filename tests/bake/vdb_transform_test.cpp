// SPDX-License-Identifier: MIT
// Every linear transform: what keeps the voxels is exact, and what does not is the trilinear field, looked up
// by brute force in double precision.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "import_scratch.h"
#include "support/all_tests.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

// A box with one corner longer than the others, so that no two of its turns look alike.
double field(const glm::dvec3& p) {
  const glm::dvec3 q = glm::abs(p - glm::dvec3(2, 1, 0)) - glm::dvec3(9, 6, 4);
  const double box = glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max({q.x, q.y, q.z}));
  return std::min(box, glm::length(p - glm::dvec3(10, 6, 4)) - 3);
}

VdbSpec solid(const glm::dmat4& to_world, const char* type = "float") {
  VdbSpec spec;
  spec.type = type;
  spec.grid_class = "level set";
  spec.background = glm::dvec3(3);
  spec.to_world = to_world;
  spec.low = glm::ivec3(-16);
  spec.high = glm::ivec3(20);
  spec.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = field(p);
    return d < 3 ? std::optional(glm::dvec3(std::max(d, -3.0))) : std::nullopt;
  };
  return spec;
}

double trilinear(const VdbPeer& peer, const glm::dvec3& p) {
  const glm::dvec3 low = glm::floor(p);
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner = low + glm::dvec3(i & 1, i >> 1 & 1, i >> 2);
    const glm::dvec3 w = 1.0 - glm::abs(p - corner);
    sum += w.x * w.y * w.z * peer.value(glm::ivec3(corner));
  }
  return sum;
}

struct Compared {
  std::uint64_t wrong = 0, solid = 0, voxels = 0;
};
// Voxel by voxel, but where the field is too near to 0 for two ways of rounding to agree.
Compared compare(const std::filesystem::path& path, const VoxelGrid& grid, const glm::dmat4& to_world,
                 bool exact) {
  const VdbPeer peer(path, "density");
  const glm::dmat4 to_index = glm::inverse(to_world);
  Compared result;
  std::size_t i = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x, ++i) {
        const glm::dvec3 world = glm::dmat4x3(grid.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1);
        const glm::dvec3 index = glm::dvec3(to_index * glm::dvec4(world, 1));
        const double value = exact ? peer.value(glm::ivec3(glm::round(index))) : trilinear(peer, index);
        ++result.voxels;
        result.solid += grid.solid[i];
        if (!exact && std::abs(value) < 1e-4) continue;
        result.wrong += (grid.solid[i] != 0) != (value <= 0) ? 1 : 0;
      }
  return result;
}

TEST(VdbTransform, QuarterTurnsFlipsAndScalesLoseNothing) {
  const Scratch scratch;
  const auto path = scratch.folder() / "turned.vdb";
  std::uint64_t first = 0;
  const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const auto& axes : order)
    for (int flips = 0; flips < 8; ++flips) {
      glm::dmat4 m(0.0);
      for (int i = 0; i < 3; ++i) m[i][axes[i]] = (flips >> i & 1 ? -0.125 : 0.125);
      m[3] = glm::dvec4(5, -2, 0.3, 1);
      writeVdb(path, {solid(m)});
      for (const Axis axis : {Axis::kPlusY, Axis::kMinusX}) {
        if (!kelp::test::allTests() && (axis == Axis::kMinusX) != (flips % 2 == 0)) continue;
        Settings settings;
        settings.axis = axis;
        const VoxelGrid grid = *importFile(path, settings).parts[0].grid;
        const Compared c = compare(path, grid, m, true);
        EXPECT_EQ(c.wrong, 0u);
        if (first == 0) first = c.solid;
        EXPECT_EQ(c.solid, first) << "not one voxel more or less";
      }
    }
  EXPECT_GT(first, 1000u);
}

TEST(VdbTransform, TurnsStretchesAndShearsAreTheTrilinearField) {
  const Scratch scratch;
  const auto path = scratch.folder() / "turned.vdb";
  std::vector<glm::dmat4> all;
  all.push_back(glm::rotate(glm::dmat4(1), 0.5, glm::normalize(glm::dvec3(1, 2, 3))));
  all.push_back(glm::scale(glm::dmat4(1), glm::dvec3(0.5, 1.25, 1)));
  glm::dmat4 shear(1);
  shear[1][0] = 0.4;
  shear[2][1] = -0.3;
  all.push_back(shear);
  all.push_back(glm::translate(glm::dmat4(1), glm::dvec3(3, 4, 5)) * all[0] * shear * all[1] *
                glm::scale(glm::dmat4(1), glm::dvec3(-0.02)));
  for (const glm::dmat4& m : all) {
    writeVdb(path, {solid(m, "double")});
    for (const int resolution : {0, 50}) {
      Settings settings;
      settings.resolution_given = resolution > 0;
      if (resolution > 0) settings.resolution = resolution;
      const VoxelGrid grid = *importFile(path, settings).parts[0].grid;
      if (resolution > 0) {
        EXPECT_EQ(std::max({grid.size.x, grid.size.y, grid.size.z}), resolution);
      }
      const Compared c = compare(path, grid, m, false);
      EXPECT_EQ(c.wrong, 0u);
      EXPECT_GT(c.solid, 1000u);
      // Cubes, that keep the volume of what they show.
      const glm::dmat3 linear(glm::dmat4x3(grid.to_node));
      EXPECT_NEAR(glm::length(linear[0]), glm::length(linear[1]), 1e-6);
      EXPECT_NEAR(glm::length(linear[0]), glm::length(linear[2]), 1e-6);
      EXPECT_NEAR(glm::dot(linear[0], linear[1]), 0, 1e-9);
    }
  }
}

// Translations, scales and whole matrices are written as different kinds of maps.
TEST(VdbTransform, EveryKindOfMapIsRead) {
  const Scratch scratch;
  const auto path = scratch.folder() / "maps.vdb";
  std::vector<glm::dmat4> all;
  all.push_back(glm::dmat4(1));
  all.push_back(glm::translate(glm::dmat4(1), glm::dvec3(3, -4, 5)));
  all.push_back(glm::scale(glm::dmat4(1), glm::dvec3(0.1)));
  all.push_back(glm::scale(glm::dmat4(1), glm::dvec3(0.1, 0.2, 0.3)));
  all.push_back(glm::translate(glm::dmat4(1), glm::dvec3(3, -4, 5)) * all[2]);
  all.push_back(glm::translate(glm::dmat4(1), glm::dvec3(3, -4, 5)) * all[3]);
  all.push_back(glm::rotate(glm::dmat4(1), 0.5, glm::dvec3(0, 0, 1)));
  for (const glm::dmat4& m : all) {
    writeVdb(path, {solid(m)});
    const SourceModel model = importFile(path, {});
    const VoxelGrid& grid = *model.parts[0].grid;
    const VdbPeer peer(path, "density");
    EXPECT_LT(glm::length(peer.world({1, 2, 3}) - glm::dvec3(m * glm::dvec4(1, 2, 3, 1))), 1e-12);
    // The center of what is solid, in the file's space.
    glm::dvec3 own(0), made(0);
    double own_count = 0, made_count = 0;
    for (int x = -16; x <= 20; ++x)
      for (int y = -16; y <= 20; ++y)
        for (int z = -16; z <= 20; ++z)
          if (peer.value({x, y, z}) <= 0) own += peer.world(glm::dvec3(x, y, z)), ++own_count;
    std::size_t i = 0;
    for (int z = 0; z < grid.size.z; ++z)
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x, ++i)
          if (grid.solid[i])
            made += glm::dmat4x3(grid.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1), ++made_count;
    EXPECT_LT(glm::length(own / own_count - made / made_count),
              0.6 * std::cbrt(std::abs(glm::determinant(glm::dmat3(m)))));
  }
}

}  // namespace
}  // namespace kelp::bake::test
