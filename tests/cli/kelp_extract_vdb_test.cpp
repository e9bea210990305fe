// SPDX-License-Identifier: MIT
// `kelp-dump extract --vdb` and `--nvdb`, read back through OpenVDB and NanoVDB themselves.
#include <kelp/common/openvdb.h>
#include <nanovdb/util/IO.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "extract_packs.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

using test::KnownPart;

openvdb::Coord coordOf(const glm::ivec3& v) { return {v.x, v.y, v.z}; }

openvdb::GridPtrVecPtr readVdb(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(false);
  return file.getGrids();
}

template <class Grid>
typename Grid::Ptr find(const openvdb::GridPtrVecPtr& grids, const std::string& name) {
  for (const openvdb::GridBase::Ptr& grid : *grids)
    if (grid->getName() == name) return openvdb::gridPtrCast<Grid>(grid);
  ADD_FAILURE() << "no grid '" << name << "'";
  return nullptr;
}

// A voxel's middle in the file is where it is in the object, meters.
void expectPlaces(const openvdb::GridBase& grid, const glm::mat4x3& to_object, const glm::ivec3& size) {
  for (const glm::ivec3& voxel : {glm::ivec3(0), size - 1, glm::ivec3(3, 1, 2)}) {
    const glm::dvec3 expected = glm::dmat4x3(to_object) * glm::dvec4(glm::dvec3(voxel) + 0.5, 1);
    const openvdb::Vec3d got = grid.indexToWorld(coordOf(voxel));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[i], expected[i], 1e-9 * (1 + std::abs(expected[i])));
  }
}

class ExtractVdb : public testing::Test {
 protected:
  void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    ASSERT_EQ(result.exit, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
  }
  test::Scratch folder_;
};

// Solid where the value is at most 0, voxel for voxel, also around the part; colors and attributes at the
// surface and nowhere else.
void expectSolid(const openvdb::GridPtrVecPtr& grids, const std::string& name, const std::string& prefix,
                 const KnownPart& part, const std::vector<Material>& palette) {
  const auto surface = find<openvdb::FloatGrid>(grids, name);
  const auto colors = find<openvdb::Vec3SGrid>(grids, prefix + "Cd");
  const auto attributes = find<openvdb::Vec3SGrid>(grids, prefix + "kelp_attribute");
  const auto entries = find<openvdb::Vec3SGrid>(grids, prefix + "kelp_palette");
  ASSERT_TRUE(surface && colors && attributes && entries);
  for (int e = 0; e < static_cast<int>(palette.size()); ++e) {
    const Material& m = palette[static_cast<std::size_t>(e)];
    EXPECT_EQ(entries->tree().getValue(openvdb::Coord(e, 0, 0)),
              openvdb::Vec3s(m.base_color.r, m.base_color.g, m.base_color.b));
    EXPECT_EQ(entries->tree().getValue(openvdb::Coord(e, 1, 0)),
              openvdb::Vec3s(m.emissive.r, m.emissive.g, m.emissive.b));
    EXPECT_EQ(entries->tree().getValue(openvdb::Coord(e, 2, 0)),
              openvdb::Vec3s(m.base_color.a, m.metallic, m.roughness));
  }
  EXPECT_EQ(entries->activeVoxelCount(), 3 * palette.size());
  EXPECT_EQ(surface->getGridClass(), openvdb::GRID_LEVEL_SET);
  const float edge =
      static_cast<float>(std::cbrt(std::abs(glm::determinant(glm::dmat3(glm::dmat4x3(part.to_object))))));
  EXPECT_FLOAT_EQ(surface->background(), 3 * edge);
  for (const openvdb::GridBase::Ptr& grid : *grids)
    if (grid->getName() == name || grid->getName().rfind(prefix, 0) == 0)
      expectPlaces(*grid, part.to_object, part.occupancy.size);
  std::size_t wrong = 0, wrong_look = 0, solid = 0;
  const auto at = surface->getConstAccessor();
  part.eachVoxel(12, [&](const glm::ivec3& v) {
    const float value = at.getValue(coordOf(v));
    wrong += (value <= 0) == part.solid(v) && std::abs(value) <= 3 * edge ? 0 : 1;
    solid += part.solid(v) ? 1 : 0;
    const std::int64_t attribute = part.solid(v) ? part.attribute[part.occupancy.index(v)] : -1;
    openvdb::Vec3s color;
    openvdb::Vec3s stored(-1);
    const bool has_color = colors->tree().probeValue(coordOf(v), color),
               has_attribute = attributes->tree().probeValue(coordOf(v), stored);
    const bool corner = v == glm::ivec3(0) || v == part.occupancy.size - 1;
    if (has_color != (attribute >= 0) || has_attribute != (attribute >= 0 || corner)) ++wrong_look;
    if (attribute < 0) {
      if (corner && stored != openvdb::Vec3s(-1)) ++wrong_look;
      return;
    }
    const auto bits = static_cast<std::uint32_t>(attribute);
    const glm::vec4& expected = palette[attributePalette(bits)].base_color;
    if (color != openvdb::Vec3s(expected.r, expected.g, expected.b)) ++wrong_look;
    if (stored[0] != static_cast<float>(attributePalette(bits)) ||
        (static_cast<std::uint32_t>(stored[1]) | static_cast<std::uint32_t>(stored[2]) << 12) !=
            attributeNormal(bits))
      ++wrong_look;
  });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(wrong_look, 0u);
  // Nothing is solid anywhere else.
  std::uint64_t stored = 0;
  for (auto value = surface->cbeginValueAll(); value; ++value)
    if (*value <= 0) stored += value.getVoxelCount();
  EXPECT_EQ(stored, solid);
}

TEST_F(ExtractVdb, LevelSetsAreTheVoxelsAndTheirColors) {
  const std::vector<Material> palette = test::paletteOf(9);
  const glm::mat4x3 odd(glm::vec3(0, 0, 0.02f), glm::vec3(-0.02f, 0, 0), glm::vec3(0, 0.03f, 0),
                        glm::vec3(0.4f, -0.1f, 2));
  const std::vector<KnownPart> parts{test::ball(odd, 9), test::ball(test::scaled(0.5f), 9)};
  const std::string pack = test::writePackFile(
      folder_, "two.kelp", {test::rawPart(parts[0], "one"), test::rawPart(parts[1], "two")}, palette);
  run({pack, "--vdb", folder_ / "two.vdb"});
  const auto both = readVdb(folder_ / "two.vdb");
  EXPECT_EQ(both->size(), 8u);
  expectSolid(both, "one", "one.", parts[0], palette);
  expectSolid(both, "two", "two.", parts[1], palette);
  run({pack, "--vdb", folder_ / "two.vdb", "--part", "two"});  // over the file that is there
  expectSolid(readVdb(folder_ / "two.vdb"), "two", "", parts[1], palette);
}

// A full cube has bricks without any surface voxel.
TEST_F(ExtractVdb, TheInsideIsSolid) {
  const KnownPart cube = test::knownPart(
      {64, 48, 40}, test::scaled(1), [](const glm::ivec3&) { return true; },
      [](const glm::ivec3& v) { return glm::vec3(v) - glm::vec3(31.5f, 23.5f, 19.5f); },
      [](const glm::ivec3&) { return 0; });
  const std::vector<Material> palette = test::paletteOf(1);
  run({test::writePackFile(folder_, "cube.kelp", {test::rawPart(cube, "cube")}, palette), "--vdb",
       folder_ / "cube.vdb"});
  expectSolid(readVdb(folder_ / "cube.vdb"), "cube", "", cube, palette);
}

// Of a ball, all is known: how far each voxel is from its surface, and which way.
TEST_F(ExtractVdb, LevelSetsAreDistancesWithThePacksNormals) {
  const glm::vec3 middle(20.4f, 19.7f, 20.2f);
  constexpr float kRadius = 17.3f;
  const auto away = [&](const glm::ivec3& v) { return glm::vec3(v) + 0.5f - middle; };
  const KnownPart ball = test::knownPart(
      {41, 40, 41}, test::scaled(0.1f), [&](const glm::ivec3& v) { return glm::length(away(v)) <= kRadius; },
      away, [](const glm::ivec3&) { return 0; });
  run({test::writePackFile(folder_, "ball.kelp", {test::rawPart(ball, "ball")}, test::paletteOf(1)), "--vdb",
       folder_ / "ball.vdb"});
  const auto surface = find<openvdb::FloatGrid>(readVdb(folder_ / "ball.vdb"), "ball");
  ASSERT_TRUE(surface);
  const auto at = surface->getConstAccessor();
  double worst_distance = 0, sum = 0, worst = 0, count = 0;
  ball.eachVoxel(4, [&](const glm::ivec3& v) {
    const double distance = double{glm::length(away(v))} - double{kRadius};
    if (std::abs(distance) < 2.5)
      worst_distance = std::max(worst_distance, std::abs(double{at.getValue(coordOf(v))} / 0.1 - distance));
    if (!ball.solid(v) || ball.attribute[ball.occupancy.index(v)] < 0) return;
    glm::dvec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step(0);
      step[axis] = 1;
      gradient[axis] = double{at.getValue(coordOf(v + step))} - double{at.getValue(coordOf(v - step))};
    }
    const glm::dvec3 normal = glm::normalize(glm::dvec3(away(v)));
    const double error = std::atan2(glm::length(glm::cross(gradient, normal)), glm::dot(gradient, normal)) *
                         180 / std::numbers::pi;
    sum += error;
    worst = std::max(worst, error);
    ++count;
  });
  EXPECT_LT(worst_distance, 0.75);
  EXPECT_LT(sum / count, 0.2);
  EXPECT_LT(worst, 3);
  RecordProperty("mean_degrees", std::to_string(sum / count));
  printf("  distances within %.2f voxels, normals %.3f degrees in the mean, %.2f at most\n", worst_distance,
         sum / count, worst);
}

TEST_F(ExtractVdb, FogIsItsDensityPerMeter) {
  const glm::ivec3 size(17, 33, 20);
  const fields::FogSamples fog =
      test::fogOf(size, test::puffs, [](const glm::dvec3& p) { return p.y * test::puffs(p); });
  const RawPack pack = test::fogPack(fog, 0.3f);
  const std::string path = folder_.write("fog.kelp", std::span<const std::byte>(test::bytesOf(pack)));
  run({path, "--vdb", folder_ / "fog.vdb"});
  const auto grids = readVdb(folder_ / "fog.vdb");
  const auto density = find<openvdb::FloatGrid>(grids, "density"),
             heat = find<openvdb::FloatGrid>(grids, "heat");
  ASSERT_TRUE(density && heat);
  EXPECT_EQ(density->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(density->background(), 0.0f);
  expectPlaces(*density, pack.parts[0].to_object, size);
  const double edge = 1.0 / 33, densest = 0.3 / edge;
  EXPECT_EQ(density->evalActiveVoxelBoundingBox(), openvdb::CoordBBox(openvdb::Coord(0), coordOf(size - 1)));
  double worst = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const std::size_t i = static_cast<std::size_t>(x + size.x * (y + size.y * z));
        worst = std::max(worst, std::abs(double{density->tree().getValue({x, y, z})} -
                                         densest * double{fogDensity(fog.density[i])}) /
                                    densest);
        worst = std::max(worst, std::abs(double{heat->tree().getValue({x, y, z})} - fog.heat[i] / 255.0));
      }
  EXPECT_LT(worst, 2e-6);
}

// The same grids, value by value.
template <class Value, class Grid>
void expectSame(const nanovdb::GridHandle<>& handle, const Grid& open, const glm::ivec3& low,
                const glm::ivec3& high) {
  const nanovdb::NanoGrid<Value>* const grid = handle.grid<Value>();
  ASSERT_NE(grid, nullptr);
  EXPECT_EQ(open.getName(), grid->gridName());
  const auto at = open.getConstAccessor();
  const auto nano_at = grid->getAccessor();
  std::size_t wrong = 0;
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) {
        const auto a = at.getValue({x, y, z});
        const Value b = nano_at.getValue({x, y, z});
        if constexpr (std::is_floating_point_v<Value>)
          wrong += a == b ? 0 : 1;
        else
          wrong += a[0] == b[0] && a[1] == b[1] && a[2] == b[2] ? 0 : 1;
      }
  EXPECT_EQ(wrong, 0u);
  const openvdb::Vec3d place = open.indexToWorld(openvdb::Coord(3, 1, 2));
  const nanovdb::Vec3d nano_place = grid->indexToWorld(nanovdb::Vec3d(3, 1, 2));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(place[i], nano_place[i], 1e-9);
}

TEST_F(ExtractVdb, NanoVdbHoldsTheSame) {
  const KnownPart part = test::ball(test::scaled(0.5f, {1, 2, 3}), 9);
  const std::string pack =
      test::writePackFile(folder_, "ball.kelp", {test::rawPart(part, "ball")}, test::paletteOf(9));
  run({pack, "--vdb", folder_ / "ball.vdb"});
  run({pack, "--nvdb", folder_ / "ball.nvdb"});
  const auto grids = readVdb(folder_ / "ball.vdb");
  const auto handles = nanovdb::io::readGrids((folder_ / "ball.nvdb").string());
  ASSERT_EQ(handles.size(), 4u);
  const glm::ivec3 low(-9), high = part.occupancy.size + 9;
  const auto surface = find<openvdb::FloatGrid>(grids, "ball");
  const auto colors = find<openvdb::Vec3SGrid>(grids, "Cd");
  const auto attributes = find<openvdb::Vec3SGrid>(grids, "kelp_attribute");
  const auto entries = find<openvdb::Vec3SGrid>(grids, "kelp_palette");
  ASSERT_TRUE(surface && colors && attributes && entries);
  EXPECT_TRUE(handles[0].grid<float>()->isLevelSet());
  expectSame<float>(handles[0], *surface, low, high);
  expectSame<nanovdb::Vec3f>(handles[1], *colors, low, high);
  expectSame<nanovdb::Vec3f>(handles[2], *attributes, low, high);
  expectSame<nanovdb::Vec3f>(handles[3], *entries, low, high);
}

}  // namespace
}  // namespace kelp
