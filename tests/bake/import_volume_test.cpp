// SPDX-License-Identifier: MIT
// binvox files and raw volumes against balls and ramps, whose voxels and normals are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

using Value = std::function<double(const glm::dvec3& center)>;

// y fastest, then z, then x; in runs of at most 255.
std::string binvox(const glm::ivec3& size, const std::function<bool(const glm::ivec3&)>& solid,
                   const std::string& more = "") {
  std::string out = "#binvox 1\ndim " + std::to_string(size.x) + " " + std::to_string(size.z) + " " +
                    std::to_string(size.y) + "\n" + more + "data\n";
  int value = -1, length = 0;
  const auto end = [&] {
    if (length > 0) (out += static_cast<char>(value)) += static_cast<char>(length);
    length = 0;
  };
  for (int x = 0; x < size.x; ++x)
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y) {
        const int here = solid({x, y, z}) ? 1 : 0;
        if (here != value || length == 255) end();
        value = here;
        ++length;
      }
  end();
  return out;
}

// Compares the solid voxels with `solid`, on the lattice that voxels of `edge` have from `origin` on.
std::size_t expectSolid(const SourcePart& part, double edge, const glm::dvec3& origin,
                        const std::function<bool(const glm::ivec3&)>& solid) {
  const VoxelGrid& grid = *part.grid;
  std::size_t count = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 place = glm::dvec3(grid.to_node * glm::vec4(x + 0.5f, y + 0.5f, z + 0.5f, 1));
        const glm::ivec3 voxel(glm::floor((place - origin) / edge));
        const bool is = grid.solid[static_cast<std::size_t>(x) +
                                   static_cast<std::size_t>(grid.size.x) *
                                       (static_cast<std::size_t>(y) + static_cast<std::size_t>(grid.size.y) *
                                                                          static_cast<std::size_t>(z))] != 0;
        EXPECT_EQ(is, solid(voxel)) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
        count += is;
      }
  return count;
}

// Degrees between the normals and the direction from the center, which is in voxels of the grid; the mean and
// the largest.
std::pair<double, double> normalErrors(const VoxelGrid& grid, const glm::dvec3& center) {
  double sum = 0, most = 0;
  for (const SurfaceSample& sample : grid.surface) {
    const auto x = static_cast<std::uint64_t>(grid.size.x), y = static_cast<std::uint64_t>(grid.size.y);
    const glm::dvec3 at =
        glm::dvec3(double(sample.index % x), double(sample.index / x % y), double(sample.index / (x * y))) +
        0.5;
    const double error =
        std::acos(std::min(1.0, glm::dot(glm::normalize(at - center), glm::dvec3(sample.normal)))) * 57.29578;
    sum += error;
    most = std::max(most, error);
  }
  return {sum / static_cast<double>(grid.surface.size()), most};
}

TEST(ImportBinvox, VoxelsAndPlace) {
  const Scratch scratch;
  const auto solid = [](const glm::ivec3& v) {
    return v.x >= 1 && v.x < 4 && v.y >= 2 && v.y < 9 && v.z >= 0 && v.z < 6 && (v.x + v.y * v.z) % 3 != 0;
  };
  const auto path = scratch.write("a.binvox", binvox({5, 10, 6}, solid, "translate 1.5 -2 0.25\nscale 20\n"));
  std::size_t count = 0;
  for (int i = 0; i < 300; ++i) count += solid({i % 5, i / 5 % 10, i / 50});
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    Settings settings;
    settings.axis = axis;
    const SourceModel model = importFile(path, settings);
    EXPECT_EQ(expectSolid(model.parts[0], 2, {1.5, -2, 0.25}, solid), count);
  }
  Settings settings;
  settings.voxel_size = 0.5;
  EXPECT_EQ(expectSolid(importFile(path, settings).parts[0], 0.5, {0.375, -0.5, 0.0625}, solid), count);
  settings = {};
  settings.resolution_given = true;
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, settings), "kept as they are"));
}

TEST(ImportBinvox, NormalsOfABall) {
  const Scratch scratch;
  const auto path = scratch.write("ball.binvox", binvox({64, 64, 64}, [](const glm::ivec3& v) {
                                    return glm::length(glm::dvec3(v) + 0.5 - 32.0) <= 30;
                                  }));
  const VoxelGrid grid = *importFile(path, {}).parts[0].grid;
  const auto [mean, most] = normalErrors(grid, glm::dvec3(grid.size) * 0.5);
  EXPECT_LT(mean, 1.3);
  EXPECT_LT(most, 6.0);
}

TEST(ImportBinvox, DamagedFiles) {
  const Scratch scratch;
  const std::string good = binvox(
      {3, 4, 5}, [](const glm::ivec3& v) { return (v.x + v.y) % 2 == 0; }, "translate 0 0 0\nscale 1\n");
  const auto path = [&](const std::string& bytes) { return scratch.write("bad.binvox", bytes); };
  for (std::size_t length = 0; length < good.size(); ++length)
    refusal(path(good.substr(0, length)), Exit::kInvalid);
  EXPECT_TRUE(contains(refusal(path("voxels\n"), Exit::kInvalid), "#binvox"));
  EXPECT_TRUE(contains(refusal(path("#binvox 1\ndim 65536 65536 65536\ndata\n\1\377"), Exit::kInvalid),
                       "ends after 255"));
  EXPECT_TRUE(contains(refusal(path("#binvox 1\ndim 0 1 1\ndata\n"), Exit::kInvalid), "line 2"));
  EXPECT_TRUE(contains(refusal(path("#binvox 1\ndim 1 1 x\ndata\n"), Exit::kInvalid), "has no 3 numbers"));
  EXPECT_TRUE(
      contains(refusal(path("#binvox 1\ndim 2 2 2\nscale -1\ndata\n\1\10"), Exit::kInvalid), "scale"));
  EXPECT_TRUE(
      contains(refusal(path("#binvox 1\ndim 2 2 2\ndata\n\1\11"), Exit::kInvalid), "beyond the volume"));
  EXPECT_TRUE(
      contains(refusal(path(std::string("#binvox 1\ndim 2 2 2\ndata\n\0\10", 27)), Exit::kUnsupported),
               "no solid voxel"));
  EXPECT_TRUE(contains(refusal(path("#binvox 1\ndata\n"), Exit::kInvalid), "no line 'dim'"));
  EXPECT_TRUE(contains(refusal(path("#binvox 1\n" + std::string(5000, 'x')), Exit::kInvalid), "header"));
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int bits : {1, 6, 0x80}) {
      std::string flipped = good;
      flipped[at] = static_cast<char>(flipped[at] ^ bits);
      Settings settings;
      settings.max_memory = std::uint64_t{256} << 20;
      try {
        importFile(path(flipped), settings);
      } catch (const ToolError& error) {
        EXPECT_TRUE(error.exit == Exit::kInvalid || error.exit == Exit::kUnsupported ||
                    error.exit == Exit::kRuntime)
            << at << ": " << error.what();
      }
    }
}

// A volume of `size` voxels whose values are those at their centers, in voxels, with its sidecar.
template <class T>
std::filesystem::path writeRaw(const Scratch& scratch, const glm::ivec3& size, const std::string& type,
                               const Value& value, const std::string& more = "", bool big_endian = false,
                               const std::string& head = "") {
  std::string bytes = head;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const T number = static_cast<T>(value(glm::dvec3(x, y, z) + 0.5));
        char raw[sizeof(T)];
        std::memcpy(raw, &number, sizeof(T));
        for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big_endian ? sizeof(T) - 1 - i : i];
      }
  scratch.write("scan.raw.json", R"({"size": [)" + std::to_string(size.x) + "," + std::to_string(size.y) +
                                     "," + std::to_string(size.z) + R"(], "type": ")" + type + "\"" + more +
                                     "}");
  return scratch.write("scan.raw", bytes);
}

// 100 in the middle, falling by 10 a voxel: 50 at a radius of 5.
double hill(const glm::dvec3& p) { return 100 - 10 * glm::length(p - glm::dvec3(10, 9, 8)); }

TEST(ImportRaw, EveryTypeAndByteOrderIsTheSameSolid) {
  const Scratch scratch;
  Settings settings;
  settings.isovalue = 50;
  const glm::ivec3 size(20, 18, 17);
  const auto positive = [](const glm::dvec3& p) { return std::max(0.0, std::floor(hill(p))); };
  const auto solid = [](const glm::ivec3& v) { return std::floor(hill(glm::dvec3(v) + 0.5)) >= 50; };
  const auto check = [&](const std::filesystem::path& path) {
    const SourceModel model = importFile(path, settings);
    EXPECT_GT(expectSolid(model.parts[0], 1, {0, 0, 0}, solid), 400u);
  };
  check(writeRaw<std::uint8_t>(scratch, size, "u8", positive));
  check(writeRaw<std::uint16_t>(scratch, size, "u16", positive));
  check(writeRaw<std::uint16_t>(scratch, size, "u16", positive, R"(, "endian": "big")", true));
  check(
      writeRaw<std::int16_t>(scratch, size, "i16", [](const glm::dvec3& p) { return std::floor(hill(p)); }));
  check(writeRaw<std::int16_t>(
      scratch, size, "i16", [](const glm::dvec3& p) { return std::floor(hill(p)); },
      R"(, "endian": "big", "offset": 7)", true, "header."));
  check(writeRaw<float>(
      scratch, size, "f32", [](const glm::dvec3& p) { return std::floor(hill(p)); },
      R"(, "endian": "little")"));
}

TEST(ImportRaw, NormalsAreTheDensitysOwn) {
  const Scratch scratch;
  Settings settings;
  settings.isovalue = 30;
  const auto path = writeRaw<float>(scratch, {20, 18, 17}, "f32", hill);
  for (const Axis axis : {Axis::kPlusY, Axis::kMinusX, Axis::kPlusZ}) {
    settings.axis = axis;
    const SourceModel model = importFile(path, settings);
    const VoxelGrid& grid = *model.parts[0].grid;
    const glm::dvec3 center =
        glm::inverse(glm::dmat3(grid.to_node)) * (glm::dvec3(10, 9, 8) - glm::dvec3(grid.to_node[3]));
    EXPECT_LT(normalErrors(grid, center).second, 2.0);
  }
}

TEST(ImportRaw, SpacingIsResampledToCubes) {
  const Scratch scratch;
  Settings settings;
  settings.isovalue = 50;
  // A ball of radius 15 in lengths; voxels are twice as deep along z.
  const auto path = writeRaw<float>(
      scratch, {40, 38, 18}, "f32",
      [](const glm::dvec3& p) {
        return 100 - 50 / 15.0 * glm::length(p * glm::dvec3(1, 1, 2) - glm::dvec3(20, 19, 18));
      },
      R"(, "spacing": [1, 1, 2])");
  const auto volume = [&](const SourceModel& model) {
    const VoxelGrid& grid = *model.parts[0].grid;
    return static_cast<double>(std::count(grid.solid.begin(), grid.solid.end(), 1)) *
           std::abs(glm::determinant(glm::dmat3(grid.to_node)));
  };
  const double ball = 4.0 / 3 * std::numbers::pi * 3375;
  SourceModel model = importFile(path, settings);
  EXPECT_NEAR(glm::length(model.parts[0].grid->to_node[2]), 1, 1e-6);
  EXPECT_NEAR(volume(model), ball, 0.02 * ball);
  settings.resolution = 40;
  settings.resolution_given = true;
  model = importFile(path, settings);
  EXPECT_EQ(std::max({model.parts[0].grid->size.x, model.parts[0].grid->size.y, model.parts[0].grid->size.z}),
            40);
  EXPECT_NEAR(volume(model), ball, 0.02 * ball);
  settings.resolution_given = false;
  settings.voxel_size = 0.5;
  model = importFile(path, settings);
  EXPECT_NEAR(glm::length(model.parts[0].grid->to_node[0]), 0.5, 1e-6);
  EXPECT_NEAR(volume(model), ball, 0.02 * ball);
}

// Voxels a million million million million times as deep as they are wide: between them there is next to
// nothing of any.
TEST(ImportRaw, SpacingMayDifferByAnything) {
  const Scratch scratch;
  const auto path = writeRaw<float>(
      scratch, {20, 18, 17}, "f32", [](const glm::dvec3&) { return 1.0; },
      R"(, "spacing": [1e-12, 1e-12, 1e12])");
  Settings settings;
  settings.resolution = 8;
  settings.resolution_given = true;
  settings.volume = VolumeKind::kSolid;
  EXPECT_EQ(importFile(path, settings).parts[0].grid->size, glm::ivec3(1, 1, 8));
  settings.volume = VolumeKind::kFog;
  const FogGrid fog = *importFile(path, settings).parts[0].fog;
  EXPECT_EQ(fog.size, glm::ivec3(1, 1, 8));
  double mass = 0;
  const double edge = glm::length(glm::dvec3(fog.to_node[2]));
  for (const std::uint16_t density : fog.density)
    mass += density / 65535.0 * static_cast<double>(fog.extinction) * edge * edge;
  EXPECT_NEAR(mass, 20 * 18 * 17 * 1e-12, 1e-3 * mass);
}

// One voxel that is no denser than the isovalue: no surface lies around it at any distance.
TEST(ImportRaw, ASolidMayHaveNoExtent) {
  const Scratch scratch;
  const auto path = writeRaw<float>(scratch, {8, 8, 8}, "f32", [](const glm::dvec3& p) {
    return glm::floor(p) == glm::dvec3(4) ? 2.0 : 0.0;
  });
  Settings settings;
  settings.volume = VolumeKind::kSolid;
  settings.isovalue = 2;
  settings.voxel_size = 0.5;
  EXPECT_EQ(importFile(path, settings).parts[0].grid->size.x,
            importFile(path, settings).parts[0].grid->size.y);
  settings.voxel_size.reset();
  settings.resolution = 64;
  settings.resolution_given = true;
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid, settings), "has no extent; choose another --isovalue"));
}

TEST(ImportRaw, FogHoldsTheDensities) {
  const Scratch scratch;
  const auto density = [](const glm::dvec3& p) { return std::max(0.0, hill(p)); };
  const auto path = writeRaw<float>(scratch, {20, 18, 17}, "f32", hill, R"(, "spacing": [0.5, 0.5, 0.5])");
  const SourceModel model = importFile(path, {});
  ASSERT_TRUE(model.parts[0].fog);
  EXPECT_FALSE(model.parts[0].grid);
  EXPECT_TRUE(anyContains(model.notices, "voxels of the volume are negative and count as no density"));
  const FogGrid& fog = *model.parts[0].fog;
  const double most = density({9.5, 8.5, 7.5});
  EXPECT_NEAR(fog.extinction, most * 0.5, 1e-3);
  double sum = 0, wanted = 0;
  for (int z = 0; z < fog.size.z; ++z)
    for (int y = 0; y < fog.size.y; ++y)
      for (int x = 0; x < fog.size.x; ++x) {
        const glm::dvec3 place = glm::dvec3(fog.to_node * glm::vec4(x + 0.5f, y + 0.5f, z + 0.5f, 1)) * 2.0;
        const double here =
            fog.density[static_cast<std::size_t>(x + fog.size.x * (y + fog.size.y * z))] / 65535.0 * most;
        EXPECT_NEAR(here, density(place), most / 65535);
        sum += here;
      }
  for (int z = 0; z < 17; ++z)
    for (int y = 0; y < 18; ++y)
      for (int x = 0; x < 20; ++x) wanted += density(glm::dvec3(x, y, z) + 0.5);
  EXPECT_NEAR(sum, wanted, 1e-4 * wanted);

  // Coarser voxels hold the mean: the mass stays.
  Settings settings;
  settings.voxel_size = 1;
  const FogGrid coarse = *importFile(path, settings).parts[0].fog;
  double mass = 0;
  for (const std::uint16_t d : coarse.density) mass += d / 65535.0 * static_cast<double>(coarse.extinction);
  EXPECT_NEAR(mass * 8, wanted, 1e-3 * wanted);
  settings.volume = VolumeKind::kFog;
  settings.isovalue = 5;
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, settings), "fog has no surface"));
  settings = {};
  settings.volume = VolumeKind::kSolid;  // from half the greatest value on
  EXPECT_TRUE(importFile(path, settings).parts[0].grid);
}

// However many of the scan's voxels one of the part's spans: none is overlooked.
TEST(ImportRaw, MeansOfFogAreExact) {
  const Scratch scratch;
  const glm::ivec3 size(600, 20, 12);
  const glm::dvec3 spacing(0.25, 1.5, 1);
  const auto droplets = [](const glm::dvec3& p) {
    const glm::ivec3 v(p);
    return v == glm::ivec3(0) || v == glm::ivec3(599, 19, 11)      ? 30
           : (v.x * 7919 + v.y * 104729 + v.z * 1299709) % 37 == 0 ? 200
                                                                   : 0;
  };
  const auto path = writeRaw<std::uint8_t>(scratch, size, "u8", droplets, R"(, "spacing": [0.25, 1.5, 1])");
  for (const int resolution : {4, 7, 23, 300}) {
    const FogGrid fog = *importFile(path, with([&](Settings& settings) {
                                      settings.resolution = resolution;
                                      settings.resolution_given = true;
                                    }))
                             .parts[0]
                             .fog;
    const double edge = glm::length(glm::dvec3(fog.to_node[0])),
                 most = static_cast<double>(fog.extinction) / edge;
    // Each of the part's voxels along an axis of the scan: the share of each of the scan's, a box or, between
    // neighbors, a tent, by summing it up in small steps.
    std::array<std::vector<std::map<int, double>>, 3> shares;
    for (int axis = 0; axis < 3; ++axis)
      for (int voxel = 0; voxel < fog.size[axis]; ++voxel) {
        std::map<int, double>& share = shares[static_cast<std::size_t>(axis)].emplace_back();
        constexpr int kSteps = 4000;
        for (int step = 0; step < kSteps; ++step) {
          glm::vec4 at(0, 0, 0, 1);
          at[axis] = static_cast<float>(voxel + (step + 0.5) / kSteps);
          const double place =
              (static_cast<double>(fog.to_node[3][axis]) +
               static_cast<double>(fog.to_node[axis][axis]) * (voxel + (step + 0.5) / kSteps)) /
              spacing[axis];
          if (edge >= spacing[axis]) {
            share[static_cast<int>(std::floor(place))] += 1.0 / kSteps;
          } else {
            const double below = std::floor(place - 0.5), part = place - 0.5 - below;
            share[static_cast<int>(below)] += (1 - part) / kSteps;
            share[static_cast<int>(below) + 1] += part / kSteps;
          }
        }
      }
    double worst = 0;
    for (int z = 0; z < fog.size.z; ++z)
      for (int y = 0; y < fog.size.y; ++y)
        for (int x = 0; x < fog.size.x; ++x) {
          double wanted = 0;
          for (const auto& [k, c] : shares[2][static_cast<std::size_t>(z)])
            for (const auto& [j, b] : shares[1][static_cast<std::size_t>(y)])
              for (const auto& [i, a] : shares[0][static_cast<std::size_t>(x)])
                if (glm::all(glm::greaterThanEqual(glm::ivec3(i, j, k), glm::ivec3(0))) &&
                    glm::all(glm::lessThan(glm::ivec3(i, j, k), size)))
                  wanted += a * b * c * droplets(glm::dvec3(i, j, k) + 0.5);
          worst = std::max(
              worst, std::abs(fog.density[static_cast<std::size_t>(x + fog.size.x * (y + fog.size.y * z))] /
                                  65535.0 * most -
                              wanted));
        }
    EXPECT_LT(worst, 0.004 * most) << resolution;
  }
}

TEST(ImportRaw, ValuesThatAreNone) {
  const Scratch scratch;
  Settings settings;
  settings.isovalue = 50;
  const auto holed = writeRaw<float>(scratch, {20, 18, 17}, "f32", [](const glm::dvec3& p) {
    return p == glm::dvec3(3.5, 3.5, 3.5) ? NAN : hill(p);
  });
  EXPECT_TRUE(anyContains(importFile(holed, settings).notices, "1 voxels are not finite"));
  settings.isovalue = 500;
  EXPECT_TRUE(contains(refusal(holed, Exit::kUnsupported, settings), "at or above the isovalue"));
  settings.isovalue = -1000;
  EXPECT_TRUE(contains(refusal(holed, Exit::kUnsupported, settings), "would be solid"));
  const auto empty = writeRaw<std::uint8_t>(scratch, {2, 2, 2}, "u8", [](const glm::dvec3&) { return 0; });
  EXPECT_TRUE(contains(refusal(empty, Exit::kUnsupported), "no density above 0"));
}

TEST(ImportRaw, Sidecars) {
  const Scratch scratch;
  const auto path = scratch.write("scan.raw", std::string(8, '\1'));
  EXPECT_TRUE(contains(refusal(path, Exit::kIo), "has no scan.raw.json beside it"));
  const auto with = [&](const std::string& json, const std::string& name = "scan.raw.json") {
    scratch.write(name, json);
    return path;
  };
  EXPECT_TRUE(importFile(with(R"({"size": [2, 2, 2], "type": "u8"})", "scan.json"), {}).parts[0].fog);
  EXPECT_TRUE(
      contains(refusal(with(R"({"size": [2, 2, 2], "type": "u16"})"), Exit::kInvalid), "holds 8 bytes"));
  EXPECT_TRUE(contains(
      refusal(with(R"({"size": [2, 2, 2], "type": "u8", "offset": 18446744073709551615})"), Exit::kInvalid),
      "holds 8 bytes"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [65536, 65536, 65536], "type": "f32"})"), Exit::kInvalid),
                       "holds 8 bytes"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2, 2.5], "type": "u8"})"), Exit::kInvalid), "size"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2, -2], "type": "u8"})"), Exit::kInvalid), "size"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2], "type": "u8"})"), Exit::kInvalid), "size"));
  EXPECT_TRUE(contains(refusal(with(R"({"type": "u8"})"), Exit::kInvalid), "size: is missing"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2, 2]})"), Exit::kInvalid), "type: is missing"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2, 2], "type": "u12"})"), Exit::kInvalid),
                       "is not one of u8, u16, i16, f32"));
  EXPECT_TRUE(
      contains(refusal(with(R"({"size": [2, 2, 2], "type": "u8", "spacing": [1, 0, 1]})"), Exit::kInvalid),
               "spacing"));
  EXPECT_TRUE(
      contains(refusal(with(R"({"size": [2, 2, 2], "type": "u8", "endian": 1})"), Exit::kInvalid), "endian"));
  EXPECT_TRUE(contains(refusal(with(R"({"size": [2, 2, 2], "type": "u8", "dims": 3})"), Exit::kInvalid),
                       "dims: is not known"));
  EXPECT_TRUE(contains(refusal(with("[]"), Exit::kInvalid), "is not a JSON object"));
  EXPECT_TRUE(contains(refusal(with(std::string(60000, '[')), Exit::kInvalid), "is not a JSON object"));
  EXPECT_TRUE(contains(refusal(with(std::string(70000, ' ')), Exit::kInvalid), "too long"));
  EXPECT_TRUE(contains(refusal(scratch.write("scan.bin", "x"), Exit::kUnsupported), ".raw"));
}

TEST(ImportRaw, TruncatedAndTooLarge) {
  const Scratch scratch;
  const auto path =
      writeRaw<std::uint16_t>(scratch, {5, 4, 3}, "u16", [](const glm::dvec3& p) { return p.x; });
  std::string bytes(120, '\1');
  for (std::size_t length = 0; length <= 122; ++length) {
    if (length == 120) continue;
    bytes.resize(length, '\1');
    refusal(scratch.write("scan.raw", bytes), Exit::kInvalid);
  }
  const auto wide = writeRaw<std::uint8_t>(scratch, {8193, 1, 1}, "u8", [](const glm::dvec3&) { return 1; });
  EXPECT_TRUE(contains(refusal(wide, Exit::kUnsupported), "give a --resolution of at most 8192"));
  refusal(wide, Exit::kUsage, with([](Settings& settings) { settings.voxel_size = 0.5; }));
  writeRaw<std::uint8_t>(scratch, {64, 64, 64}, "u8", [](const glm::dvec3&) { return 1; });
  Settings settings;
  settings.resolution = 4000;
  settings.resolution_given = true;
  settings.max_memory = std::uint64_t{1} << 30;
  // The resolution that the error names fits.
  for (const bool solid : {false, true}) {
    if (solid) settings.isovalue = 0.5;
    settings.resolution = 4000;
    const std::string text = refusal(path, Exit::kRuntime, settings);
    const std::size_t at = text.find("--resolution ");
    ASSERT_NE(at, text.npos) << text;
    settings.max_memory = std::uint64_t{40} << 20;
    const std::string small = refusal(path, Exit::kRuntime, settings);
    settings.resolution = std::atoi(small.c_str() + small.find("--resolution ") + 13);
    EXPECT_GT(settings.resolution, 64) << small;
    EXPECT_EQ(importFile(path, settings).parts.size(), 1u);
    settings.max_memory = std::uint64_t{1} << 30;
  }
}

}  // namespace
}  // namespace kelp::bake::test
