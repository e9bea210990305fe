// SPDX-License-Identifier: MIT
// Fog against the sums of the file's own densities.
#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "import_scratch.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

// The integral of density over space, in the file's units: of a part, from optical depths; of a file, from
// its values.
double massOf(const FogGrid& fog) {
  double codes = 0;
  for (const std::uint16_t code : fog.density) codes += code;
  const double edge = std::cbrt(std::abs(glm::determinant(glm::dmat3(glm::dmat4x3(fog.to_node)))));
  return codes / 65535 * fog.extinction / edge * edge * edge * edge;
}
double massOf(const VdbPeer& peer) {
  double sum = 0;
  const glm::ivec3 low = peer.low(), high = peer.high();
  for (int x = low.x; x <= high.x; ++x)
    for (int y = low.y; y <= high.y; ++y)
      for (int z = low.z; z <= high.z; ++z)
        if (const double value = peer.value({x, y, z}); value > 0 && std::isfinite(value)) sum += value;
  const glm::dvec3 o = peer.world(glm::dvec3(0));
  return sum * std::abs(glm::determinant(glm::dmat3(peer.world({1, 0, 0}) - o, peer.world({0, 1, 0}) - o,
                                                    peer.world({0, 0, 1}) - o)));
}

glm::dvec3 centerOf(const FogGrid& fog) {
  glm::dvec3 sum(0);
  double all = 0;
  std::size_t i = 0;
  for (int z = 0; z < fog.size.z; ++z)
    for (int y = 0; y < fog.size.y; ++y)
      for (int x = 0; x < fog.size.x; ++x, ++i) {
        sum += static_cast<double>(fog.density[i]) *
               glm::dvec3(glm::dmat4x3(fog.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1));
        all += fog.density[i];
      }
  return sum / all;
}
glm::dvec3 centerOf(const VdbPeer& peer) {
  glm::dvec3 sum(0);
  double all = 0;
  const glm::ivec3 low = peer.low(), high = peer.high();
  for (int x = low.x; x <= high.x; ++x)
    for (int y = low.y; y <= high.y; ++y)
      for (int z = low.z; z <= high.z; ++z) {
        const double value = std::max(0.0, peer.value({x, y, z}));
        sum += value * peer.world(glm::dvec3(x, y, z));
        all += value;
      }
  return sum / all;
}

double puff(const glm::ivec3& p) {
  const double d = glm::length(glm::dvec3(p) - glm::dvec3(2, 5, -3)) / 11;
  return d < 1 ? (1 - d) * (1 - d) * (1.2 + std::sin(p.x * 0.7) * std::cos(p.y * 0.4 + p.z)) : 0;
}

VdbSpec cloud(const glm::dmat4& to_world = glm::dmat4(1)) {
  VdbSpec spec;
  spec.grid_class = "fog volume";
  spec.to_world = to_world;
  spec.low = glm::ivec3(-14);
  spec.high = glm::ivec3(18);
  spec.value = [](const glm::ivec3& p) {
    return puff(p) > 0 ? std::optional(glm::dvec3(puff(p))) : std::nullopt;
  };
  return spec;
}

TEST(VdbFog, TheAssetsKeepTheirMassAndTheirValues) {
  for (const char* name : {"vdb/gaffer_smoke.vdb", "vdb/gaffer_arnold_sphere.vdb"}) {
    KELP_ASSET(path, name);
    const SourceModel model = importFile(path, {});
    ASSERT_TRUE(model.parts[0].fog) << name;
    const FogGrid& fog = *model.parts[0].fog;
    const VdbPeer peer(path, "density");
    const double mass = massOf(peer);
    EXPECT_NEAR(massOf(fog), mass, 1e-4 * mass) << name;
    EXPECT_EQ(*std::max_element(fog.density.begin(), fog.density.end()), 65535) << name;
    // Voxel by voxel, rounded to nearest, and no empty layer around.
    const double edge = glm::length(glm::dvec3(fog.to_node[0])), unit = fog.extinction / edge / 65535;
    const glm::dvec3 o = peer.world(glm::dvec3(0));
    const glm::dmat3 inverse = glm::inverse(
        glm::dmat3(peer.world({1, 0, 0}) - o, peer.world({0, 1, 0}) - o, peer.world({0, 0, 1}) - o));
    double worst = 0;
    glm::ivec3 low(std::numeric_limits<int>::max()), high(-1);
    std::size_t i = 0;
    for (int z = 0; z < fog.size.z; ++z)
      for (int y = 0; y < fog.size.y; ++y)
        for (int x = 0; x < fog.size.x; ++x, ++i) {
          const glm::dvec3 world = glm::dmat4x3(fog.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1);
          const double value = peer.value(glm::ivec3(glm::round(inverse * (world - o))));
          worst = std::max(worst, std::abs(fog.density[i] * unit - std::max(0.0, value)));
          if (value > 0) low = glm::min(low, glm::ivec3(x, y, z)), high = glm::max(high, glm::ivec3(x, y, z));
        }
    EXPECT_LT(worst, 0.503 * unit) << name;
    EXPECT_EQ(low, glm::ivec3(0)) << name;
    EXPECT_EQ(high, fog.size - 1) << name;
  }
}

TEST(VdbFog, EveryTransformKeepsTheMassInItsPlace) {
  const Scratch scratch;
  const auto path = scratch.folder() / "cloud.vdb";
  std::vector<glm::dmat4> all = {glm::dmat4(1), glm::scale(glm::dmat4(1), glm::dvec3(0.25, -0.25, 0.25)),
                                 glm::scale(glm::dmat4(1), glm::dvec3(0.1, 0.3, 0.2)),
                                 glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, -2, 1)))};
  glm::dmat4 shear(1);
  shear[1][2] = 0.5;
  all.push_back(glm::translate(glm::dmat4(1), glm::dvec3(7, 8, 9)) * all[3] * shear);
  for (const glm::dmat4& m : all) {
    writeVdb(path, {cloud(m)});
    const VdbPeer peer(path, "density");
    const double mass = massOf(peer), edge = std::cbrt(std::abs(glm::determinant(glm::dmat3(m))));
    for (const double voxel : {0.0, 0.8, 2.7}) {
      const Axis axis = voxel > 1 ? Axis::kPlusX : Axis::kPlusY;
      const FogGrid fog = *importFile(path, with([&](Settings& s) {
                                        if (voxel > 0) s.voxel_size = voxel * edge;
                                        s.axis = axis;
                                      }))
                               .parts[0]
                               .fog;
      EXPECT_NEAR(massOf(fog), mass, 0.01 * mass) << voxel;
      EXPECT_LT(glm::length(centerOf(fog) - centerOf(peer)), 0.05 * edge) << voxel;
      if (voxel > 0) {
        EXPECT_NEAR(glm::length(glm::dvec3(fog.to_node[1])), voxel * edge, 1e-6 * edge);
      }
    }
  }
}

TEST(VdbFog, AVoxelIsTheMeanOverItsCube) {
  // Along the axes, by brute force: every voxel of the file is a box of one density.
  const Scratch scratch;
  const auto path = scratch.folder() / "cloud.vdb";
  writeVdb(path, {cloud()});
  const VdbPeer peer(path, "density");
  const FogGrid fog = *importFile(path, with([](Settings& s) { s.voxel_size = 2.5; })).parts[0].fog;
  const double unit = fog.extinction / 2.5 / 65535;
  for (int z = 0; z < fog.size.z; ++z)
    for (int y = 0; y < fog.size.y; ++y)
      for (int x = 0; x < fog.size.x; ++x) {
        const glm::dvec3 low = glm::dmat4x3(fog.to_node) * glm::dvec4(x, y, z, 1), high = low + 2.5;
        double sum = 0;
        for (int i = static_cast<int>(std::floor(low.x)) - 1; i <= high.x + 1; ++i)
          for (int j = static_cast<int>(std::floor(low.y)) - 1; j <= high.y + 1; ++j)
            for (int k = static_cast<int>(std::floor(low.z)) - 1; k <= high.z + 1; ++k) {
              const glm::dvec3 shared = glm::max(glm::dvec3(0), glm::min(high, glm::dvec3(i, j, k) + 0.5) -
                                                                    glm::max(low, glm::dvec3(i, j, k) - 0.5));
              sum += shared.x * shared.y * shared.z * peer.value({i, j, k});
            }
        const std::size_t at = static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(fog.size.x) *
                                   (static_cast<std::size_t>(y) +
                                    static_cast<std::size_t>(fog.size.y) * static_cast<std::size_t>(z));
        ASSERT_NEAR(fog.density[at] * unit, sum / (2.5 * 2.5 * 2.5), 0.51 * unit + 1e-6);
      }
}

TEST(VdbFog, TilesTypesAndFactorsCount) {
  const Scratch scratch;
  const auto path = scratch.folder() / "cloud.vdb";
  for (const char* type : {"float", "double", "int32", "int64"}) {
    VdbSpec spec = cloud();
    spec.type = type;
    spec.value = [](const glm::ivec3& p) { return std::optional(glm::dvec3(std::floor(4 * puff(p)))); };
    spec.tiles = {{{64, 0, 0}, 1, glm::dvec3(3), true}, {{72, 0, 0}, 1, glm::dvec3(2), false}};
    if (std::string(type) == "float") spec.tiles.push_back({{0, 0, -128}, 2, glm::dvec3(1), true});
    writeVdb(path, {spec});
    const double mass = massOf(VdbPeer(path, "density"));
    const FogGrid fog = *importFile(path, {}).parts[0].fog,
                  twice = *importFile(path, with([](Settings&s) { s.density = 2; })).parts[0].fog;
    EXPECT_NEAR(massOf(fog), mass, 1e-4 * mass) << type;
    EXPECT_EQ(twice.density, fog.density);
    EXPECT_FLOAT_EQ(twice.extinction, 2 * fog.extinction);
  }
}

TEST(VdbFog, NegativeAndUndefinedDensitiesAreNothing) {
  const Scratch scratch;
  const auto path = scratch.folder() / "cloud.vdb";
  VdbSpec spec = cloud();
  spec.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    if (p == glm::ivec3(2, 5, -3)) return glm::dvec3(-1);
    if (p == glm::ivec3(2, 5, -4)) return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    if (p == glm::ivec3(2, 5, -5)) return glm::dvec3(std::numeric_limits<double>::infinity());
    return glm::dvec3(puff(p));
  };
  writeVdb(path, {spec});
  const SourceModel model = importFile(path, {});
  EXPECT_TRUE(anyContains(model.notices, "1 voxels of grid 'density' are negative"));
  EXPECT_TRUE(anyContains(model.notices, "2 voxels of grid 'density' are not finite"));
  const double mass = massOf(VdbPeer(path, "density"));
  EXPECT_NEAR(massOf(*model.parts[0].fog), mass, 1e-4 * mass);
  spec.value = [](const glm::ivec3&) { return std::optional(glm::dvec3(-1)); };
  writeVdb(path, {spec});
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid), "no density above 0"));
}

TEST(VdbFog, HeatIsAShareOfItsGreatestValue) {
  const Scratch scratch;
  const auto path = scratch.folder() / "fire.vdb";
  VdbSpec heat = cloud(glm::scale(glm::dmat4(1), glm::dvec3(2)));
  heat.name = "flame";
  // Linear in space: what lies between its voxels is known.
  const auto warmth = [](const glm::dvec3& world) {
    return std::max(0.0, 300 + 4 * world.x - 3 * world.y + 2 * world.z);
  };
  heat.value = [&](const glm::ivec3& p) { return std::optional(glm::dvec3(warmth(2.0 * glm::dvec3(p)))); };
  writeVdb(path, {cloud(), heat});
  SourceModel model = importFile(path, {});
  const FogGrid& fog = *model.parts[0].fog;
  EXPECT_TRUE(anyContains(model.notices, "glows of grid 'flame'"));
  ASSERT_EQ(fog.heat.size(), fog.density.size());
  const double most = warmth({36, -28, 36});
  std::size_t i = 0;
  for (int z = 0; z < fog.size.z; ++z)
    for (int y = 0; y < fog.size.y; ++y)
      for (int x = 0; x < fog.size.x; ++x, ++i)
        ASSERT_NEAR(
            fog.heat[i],
            65535 * warmth(glm::dmat4x3(fog.to_node) * glm::dvec4(x + 0.5, y + 0.5, z + 0.5, 1)) / most, 0.6);
  // On the density's own lattice nothing lies between.
  VdbSpec same = cloud();
  same.name = "flame";
  writeVdb(path, {cloud(), same});
  const FogGrid glow = *importFile(path, {}).parts[0].fog;
  EXPECT_EQ(glow.heat, glow.density);
  KELP_ASSET(real, "vdb/openusd_densityAndHeat.vdb");
  // Its voxels are not quite cubes: it is resampled, and keeps what there is.
  const FogGrid own = *importFile(real, {}).parts[0].fog;
  const double mass = massOf(VdbPeer(real, "density"));
  EXPECT_NEAR(massOf(own), mass, 0.01 * mass);
  ASSERT_EQ(own.heat.size(), own.density.size());
  EXPECT_GT(*std::max_element(own.heat.begin(), own.heat.end()), 40000);
}

TEST(VdbFog, TheBytesDoNotDependOnThreads) {
  KELP_ASSET(path, "vdb/gaffer_smoke.vdb");
  const auto made = [&](int threads) {
    return *importFile(path, with([&](Settings& s) {
                         s.threads = threads, s.resolution = 60, s.resolution_given = true;
                       }))
                .parts[0]
                .fog;
  };
  EXPECT_EQ(made(1).density, made(2).density);
  EXPECT_EQ(made(1).extinction, made(2).extinction);
}

TEST(VdbFog, MemoryIsAskedForBefore) {
  const Scratch scratch;
  const auto path = scratch.folder() / "cloud.vdb";
  VdbSpec spec = cloud();
  spec.tiles = {{{-4096, 0, 0}, 3, glm::dvec3(1), true}};
  writeVdb(path, {spec});
  const std::string said =
      refusal(path, Exit::kRuntime, with([](Settings& s) { s.max_memory = std::uint64_t{1} << 30; }));
  EXPECT_TRUE(contains(said, "--resolution ")) << said;
  EXPECT_TRUE(contains(said, "would fit")) << said;
  EXPECT_TRUE(
      importFile(path, with([](Settings& s) { s.resolution = 60, s.resolution_given = true; })).parts[0].fog);
}

// A few bytes say that the voxels of one grid are millions to one of another.
TEST(VdbFog, MeansOfAMillionVoxelsAreRefused) {
  const Scratch scratch;
  const auto path = scratch.folder() / "fine.vdb";
  const auto scaled = [](double edge) { return cloud(glm::scale(glm::dmat4(1), glm::dvec3(edge))); };
  for (const double finer : {5000.0, 1e7}) {
    VdbSpec heat = scaled(1000 / finer);
    heat.name = "heat";
    writeVdb(path, {scaled(1000), heat});
    const std::string said = refusal(path, Exit::kUnsupported);
    EXPECT_TRUE(contains(said, "grid 'heat'") && contains(said, "voxels along an axis to one of the part"))
        << said;
    EXPECT_TRUE(importFile(path, with([](Settings& s) { s.heat_grid = ""; })).parts[0].fog);
  }
  VdbSpec far = cloud();
  for (const int at : {0, 1 << 18}) far.tiles.push_back({glm::ivec3(at), 1, glm::dvec3(1), true});
  writeVdb(path, {far});
  const auto resolution = [](int r) {
    return with([r](Settings& s) { s.resolution = r, s.resolution_given = true; });
  };
  EXPECT_TRUE(contains(refusal(path, Exit::kUnsupported, resolution(32)), "give a larger --resolution"));
  if (kelp::test::kSanitized) return;  // two million voxels take half a minute
  EXPECT_EQ(importFile(path, resolution(128)).parts[0].fog->size, glm::ivec3(128));
}

}  // namespace
}  // namespace kelp::bake::test
