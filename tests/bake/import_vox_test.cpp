// SPDX-License-Identifier: MIT
// MagicaVoxel models in packs, voxel for voxel, against a second reader of the same files.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "import_scratch.h"
#include "support/assets.h"
#include "vox_truth.h"

namespace kelp::bake::test {
namespace {

using Place = std::array<int, 3>;

// A pack's finest voxels in MagicaVoxel's own axes: x, y to the back, z up. The palette entry of those that
// have one, -1 of inner ones.
std::map<Place, int> voxelsOf(const RawPack& pack, double voxel_size = 1) {
  std::map<Place, int> out;
  for (const RawPart& part : pack.parts) {
    const RawLevel& level = part.levels.front();
    const glm::ivec3 bricks = brickGrid(part.size);
    std::size_t next = 0;
    std::map<std::uint32_t, glm::ivec3> brick_of;
    const auto placeOf = [&](const glm::ivec3& brick, int i) -> Place {
      const glm::vec3 center = glm::vec3(brick * kBrickSide + glm::ivec3(i & 7, i >> 3 & 7, i >> 6)) + 0.5f;
      const glm::dvec3 object = glm::dvec3(part.to_object * glm::vec4(center, 1)) / voxel_size;
      return {static_cast<int>(std::floor(object.x)), static_cast<int>(std::floor(-object.z)),
              static_cast<int>(std::floor(object.y))};
    };
    for (int z = 0; z < bricks.z; ++z)
      for (int y = 0; y < bricks.y; ++y)
        for (int x = 0; x < bricks.x; ++x)
          if (const std::uint32_t cell =
                  level.cells[static_cast<std::size_t>(x + bricks.x * (y + bricks.y * z))];
              isStoredCell(cell)) {
            brick_of[cell & kCellSlotMask] = {x, y, z};
          } else if (cell == kCellInside) {
            for (int i = 0; i < kBrickVoxels; ++i) out[placeOf({x, y, z}, i)] = -1;
          }
    for (const auto& [slot, brick] : brick_of)
      for (int i = 0; i < kBrickVoxels; ++i) {
        const std::uint8_t code = level.codes[slot * std::size_t{kBrickVoxels} + static_cast<std::size_t>(i)];
        if (!isSolidCode(code)) continue;
        out[placeOf(brick, i)] = isSurfaceCode(code) ? attributePalette(level.attributes[next++]) : -1;
      }
  }
  return out;
}

RawPack baked(const std::filesystem::path& path, const Settings& settings = {}) {
  Report report;
  return bake(path, settings, report);
}

double linear(int display) {
  const double c = display / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Every voxel where the second reader has it, with the palette entry that its index names, in its color.
void expectTruth(const RawPack& pack, const VoxTruth& truth, double voxel_size = 1) {
  const std::map<Place, int> voxels = voxelsOf(pack, voxel_size);
  ASSERT_EQ(voxels.size(), truth.voxels.size());
  ASSERT_EQ(pack.palette.size(), 256u);
  std::size_t painted = 0;
  for (const auto& [at, index] : truth.voxels) {
    const auto found = voxels.find(at);
    ASSERT_NE(found, voxels.end()) << at[0] << ' ' << at[1] << ' ' << at[2];
    if (found->second < 0) continue;
    const int entry = truth.shown_at[static_cast<std::size_t>(index)];
    ASSERT_EQ(found->second, entry) << at[0] << ' ' << at[1] << ' ' << at[2];
    ++painted;
    if (!truth.has_palette) continue;
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(pack.palette[static_cast<std::size_t>(entry)].base_color[k],
                  linear(truth.rgb[static_cast<std::size_t>(index)][static_cast<std::size_t>(k)]), 1e-6);
  }
  EXPECT_GT(painted, 0u);
}

TEST(ImportVox, EveryAssetHasTheVoxelsAndColorsOfASecondReader) {
  const std::filesystem::path folder = kelp::test::assetsFolder() / "vox";
  if (kelp::test::assetsFolder().empty() || !std::filesystem::exists(folder))
    GTEST_SKIP() << "asset vox is absent: set KELP_ASSETS to a folder that holds it";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".vox") continue;
    SCOPED_TRACE(entry.path().filename().string());
    expectTruth(baked(entry.path()), readVoxTruth(entry.path()));
    ++files;
  }
  EXPECT_GE(files, 4u);
}

TEST(ImportVox, AllTurnsAndMirrorings) {
  const Scratch scratch;
  int turns = 0;
  for (int r = 0; r < 128; ++r) {
    const int first = r & 3, second = r >> 2 & 3;
    if (first > 2 || second > 2 || first == second) continue;
    ++turns;
    VoxMaker maker;
    maker.box({3, 4, 7});
    maker.scene({{0, {{"_r", std::to_string(r)}, {"_t", "5 -8 11"}}}});
    const auto path = scratch.write("model.vox", maker.bytes());
    SCOPED_TRACE("_r " + std::to_string(r));
    expectTruth(baked(path), readVoxTruth(path));
  }
  EXPECT_EQ(turns, 48);
}

// The description's own example: rows (0 1 0), (0 0 -1), (-1 0 0).
TEST(ImportVox, TheTurnOfTheFormatsDescription) {
  const Scratch scratch;
  VoxMaker maker;
  maker.model({8, 8, 8}, {{5, 6, 7, 9}, {4, 4, 4, 1}});
  maker.scene({{0, {{"_r", std::to_string((1 << 0) | (2 << 2) | (1 << 5) | (1 << 6))}}}});
  const std::map<Place, int> voxels = voxelsOf(baked(scratch.write("model.vox", maker.bytes())));
  // About (4, 4, 4), centers at (1.5, 2.5, 3.5) and (0.5, 0.5, 0.5).
  const std::map<Place, int> wanted = {{{2, -4, -2}, 8}, {{0, -1, -1}, 0}};
  EXPECT_EQ(voxels, wanted);
}

TEST(ImportVox, NestedGroupsAndSharedNodes) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({2, 3, 4});
  maker.box({5, 1, 1});
  maker.transform(0, 1, {{{"_t", "1 2 3"}}});
  maker.group(1, {2, 4, 6});
  maker.transform(2, 3, {{{"_r", "17"}, {"_t", "10 0 0"}}});
  maker.group(3, {8, 9});
  maker.transform(4, 5, {{{"_t", "-20 0 0"}}});
  maker.shape(5, {{0, {}}});
  maker.transform(6, 5, {{{"_r", "40"}, {"_t", "0 30 0"}}});  // the same shape again
  maker.transform(8, 5, {{{"_r", "33"}, {"_t", "0 0 9"}}});
  maker.transform(9, 10, {{{"_t", "0 6 0"}}});
  maker.shape(10, {{1, {}}});
  const auto path = scratch.write("model.vox", maker.bytes());
  const VoxTruth truth = readVoxTruth(path);
  EXPECT_EQ(truth.voxels.size(), 3 * 24u + 5u);
  expectTruth(baked(path), truth);
}

TEST(ImportVox, TheAxisOfTheRigChangesNoPlace) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({3, 4, 7});
  maker.scene({{0, {{"_r", "24"}, {"_t", "5 -8 11"}}}});
  const auto path = scratch.write("model.vox", maker.bytes());
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    Settings settings;
    settings.axis = axis;
    settings.pad = 2;
    expectTruth(baked(path, settings), readVoxTruth(path));
  }
  // An upright part bends along its height: after its turn it is 4 high and 7 deep.
  EXPECT_EQ(baked(path).parts[0].size, (glm::ivec3(3, 4, 7)));
}

TEST(ImportVox, WithoutAPaletteTheDefaultOne) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({15, 17, 1});
  const RawPack pack = baked(scratch.write("model.vox", maker.bytes()));
  const std::pair<int, glm::ivec3> known[] = {
      {1, {255, 255, 255}},      {2, {255, 255, 0xcc}},    {7, {255, 0xcc, 255}}, {37, {0xcc, 255, 255}},
      {215, {0, 0, 0x33}},       {216, {0xee, 0, 0}},      {226, {0, 0xee, 0}},   {236, {0, 0, 0xee}},
      {246, {0xee, 0xee, 0xee}}, {255, {0x11, 0x11, 0x11}}};
  for (const auto& [index, color] : known)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(pack.palette[static_cast<std::size_t>(index - 1)].base_color[k], linear(color[k]), 1e-6)
          << index;
}

TEST(ImportVox, MaterialsInThePacksTerms) {
  const Scratch scratch;
  VoxMaker maker;
  std::vector<std::array<int, 4>> voxels;
  for (int i = 0; i < 6; ++i) voxels.push_back({2 * i, 0, 0, i + 1});
  maker.model({12, 1, 1}, voxels);
  maker.material(1, {{"_type", "_diffuse"}, {"_rough", "0.1"}});
  maker.material(2, {{"_type", "_metal"}, {"_metal", "0.75"}, {"_rough", "0.25"}});
  maker.material(3, {{"_type", "_glass"}, {"_trans", "0.6"}, {"_rough", "0.05"}});
  maker.material(4, {{"_type", "_emit"}, {"_emit", "0.5"}, {"_flux", "3"}});
  maker.material(5, {{"_type", "_metal"}, {"_weight", "0.5"}, {"_rough", "nan"}});
  std::string old = VoxMaker::integer(6) + VoxMaker::integer(1);
  const float numbers[] = {0.3f, 0.8f};  // its weight; its roughness
  old += std::string(reinterpret_cast<const char*>(&numbers[0]), 4) + VoxMaker::integer(2) +
         std::string(reinterpret_cast<const char*>(&numbers[1]), 4);
  maker.chunk("MATT", old);
  const auto path = scratch.write("model.vox", maker.bytes());
  const std::vector<Material> palette = baked(path).palette;
  EXPECT_EQ(palette[0].roughness, 1);
  EXPECT_EQ(palette[0].metallic, 0);
  EXPECT_EQ(palette[1].metallic, 0.75f);
  EXPECT_EQ(palette[1].roughness, 0.25f);
  EXPECT_NEAR(palette[2].base_color.a, 0.4f, 1e-6);
  EXPECT_EQ(palette[2].roughness, 0.05f);
  EXPECT_EQ(palette[3].emissive, glm::vec3(palette[3].base_color) * 2.0f);
  EXPECT_EQ(palette[4].metallic, 0.5f);
  EXPECT_EQ(palette[5].metallic, 0.3f);
  EXPECT_EQ(palette[5].roughness, 0.8f);
  EXPECT_TRUE(anyContains(importFile(path, {}).notices, "1 color is glass"));
}

// displayed[k] = color index map[k]: an artist dragged colors to other places of the palette.
TEST(ImportVox, ThePaletteIsInTheOrderInWhichItIsShown) {
  const Scratch scratch;
  VoxMaker maker;
  maker.model({3, 1, 1}, {{0, 0, 0, 10}, {1, 0, 0, 20}, {2, 0, 0, 255}});
  std::string map, colors;
  for (int k = 0; k < 256; ++k) map += static_cast<char>((k == 4 ? 20 : k == 19 ? 5 : k + 1) & 255);
  for (int i = 0; i < 256; ++i) colors += std::string(3, static_cast<char>(i + 1)) + static_cast<char>(255);
  maker.chunk("RGBA", colors);
  maker.material(20, {{"_type", "_metal"}, {"_metal", "1"}, {"_rough", "0.5"}});
  VoxMaker damaged = maker;
  maker.chunk("IMAP", map);
  RawPack pack = baked(scratch.write("model.vox", maker.bytes()));
  const std::map<Place, int> voxels = voxelsOf(pack);
  EXPECT_EQ(voxels.at({-1, 0, 0}), 9);
  EXPECT_EQ(voxels.at({0, 0, 0}), 4);
  EXPECT_EQ(voxels.at({1, 0, 0}), 254);
  EXPECT_NEAR(pack.palette[4].base_color.r, linear(20), 1e-6);
  EXPECT_EQ(pack.palette[4].metallic, 1);
  EXPECT_NEAR(pack.palette[19].base_color.r, linear(5), 1e-6);
  expectTruth(pack, readVoxTruth(scratch.folder() / "model.vox"));

  damaged.chunk("IMAP", std::string(256, 7));
  const auto path = scratch.write("model.vox", damaged.bytes());
  EXPECT_TRUE(anyContains(importFile(path, {}).notices, "names a color twice"));
  EXPECT_EQ(voxelsOf(baked(path)).at({0, 0, 0}), 19);
}

TEST(ImportVox, WhatIsHiddenIsLeftOut) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({2, 2, 2});
  maker.transform(0, 1, {{}});
  maker.group(1, {2, 4, 6});
  maker.transform(2, 3, {{{"_t", "0 0 0"}}}, {}, 0);
  maker.shape(3, {{0, {}}});
  maker.transform(4, 5, {{{"_t", "9 0 0"}}}, {{"_hidden", "1"}}, 0);
  maker.shape(5, {{0, {}}});
  maker.transform(6, 7, {{{"_t", "0 9 0"}}}, {}, 3);
  maker.group(7, {8, 10});
  maker.transform(8, 9, {{{"_t", "0 0 9"}}}, {}, 0);
  maker.shape(9, {{0, {}}});
  maker.transform(10, 11, {{{"_t", "0 0 99"}}}, {}, 0);
  maker.shape(11, {{0, {}}});
  maker.layer(0, {{"_name", "seen"}});
  VoxMaker none = maker;
  maker.layer(3, {{"_name", "scaffold"}, {"_hidden", "1"}});
  const auto path = scratch.write("model.vox", maker.bytes());
  expectTruth(baked(path), readVoxTruth(path));
  EXPECT_EQ(voxelsOf(baked(path)).size(), 8u);
  EXPECT_TRUE(
      anyContains(importFile(path, {}).notices, "3 hidden objects were left out (layers 'scaffold')"));

  VoxMaker unseen;
  unseen.box({2, 2, 2});
  unseen.transform(0, 1, {{}}, {{"_hidden", "1"}});
  unseen.shape(1, {{0, {}}});
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", unseen.bytes()), Exit::kUnsupported),
                       "all of its objects are hidden"));
}

TEST(ImportVox, WhereObjectsOverlapTheVersionSaysWhichIsSeen) {
  const Scratch scratch;
  for (const int version : {150, 200}) {
    VoxMaker maker(version);
    maker.filled({4, 4, 4}, 11);
    maker.filled({4, 4, 4}, 22);
    maker.filled({4, 4, 4}, 33);
    maker.scene({{0, {}}, {1, {{"_t", "2 0 0"}}}, {2, {{"_t", "1 1 1"}}}});
    const auto path = scratch.write("model.vox", maker.bytes());
    expectTruth(baked(path), readVoxTruth(path));
    EXPECT_EQ(voxelsOf(baked(path)).at({0, -2, 1}), version == 150 ? 21 : 10);
  }
}

TEST(ImportVox, FramesOfAScene) {
  const Scratch scratch;
  VoxMaker maker(200);
  maker.filled({2, 2, 2}, 1);
  maker.filled({3, 2, 2}, 2);
  maker.filled({4, 2, 2}, 3);
  maker.transform(0, 1, {{}});
  maker.group(1, {2});
  maker.transform(2, 3, {{{"_f", "2"}, {"_t", "-10 0 0"}}, {{"_f", "8"}, {"_r", "17"}, {"_t", "10 5 -7"}}});
  maker.shape(3, {{0, {{"_f", "0"}}}, {1, {{"_f", "4"}}}, {2, {{"_f", "9"}}}});
  const auto path = scratch.write("model.vox", maker.bytes());
  for (int frame = 0; frame <= 9; ++frame) {
    SCOPED_TRACE(frame);
    Settings settings;
    settings.frame = frame;
    expectTruth(baked(path, settings), readVoxTruth(path, frame));
  }
  expectTruth(baked(path), readVoxTruth(path));
  EXPECT_TRUE(
      anyContains(importFile(path, {}).notices, "its animation of 10 frames was taken where it begins"));
  for (const int frame : {-1, 10}) {
    Settings settings;
    settings.frame = frame;
    EXPECT_TRUE(contains(refusal(path, Exit::kUsage, settings), "frames 0 to 9"));
  }
}

TEST(ImportVox, AnimationsThatLoop) {
  const Scratch scratch;
  VoxMaker maker(200);
  for (int i = 1; i <= 3; ++i) maker.filled({i, 1, 1}, i);
  maker.transform(0, 1, {{}});
  maker.group(1, {2});
  maker.transform(2, 3, {{}});
  maker.shape(3, {{0, {{"_f", "0"}}}, {1, {{"_f", "1"}}}, {2, {{"_f", "2"}}}}, {{"_loop", "1"}});
  maker.chunk("META", VoxMaker::dictionary({{"_anim_range", "0 30"}}));
  const auto path = scratch.write("model.vox", maker.bytes());
  for (const int frame : {0, 1, 2, 3, 4, 29, 30}) {
    Settings settings;
    settings.frame = frame;
    EXPECT_EQ(voxelsOf(baked(path, settings)).size(), static_cast<std::size_t>(frame % 3 + 1)) << frame;
  }
}

TEST(ImportVox, ModelsWithoutASceneAreFrames) {
  const Scratch scratch;
  VoxMaker maker;
  maker.chunk("PACK", VoxMaker::integer(3));
  for (int i = 1; i <= 3; ++i) maker.box({i, 5, 3});
  const auto path = scratch.write("model.vox", maker.bytes());
  for (int frame = 0; frame < 3; ++frame) {
    Settings settings;
    settings.frame = frame;
    expectTruth(baked(path, settings), readVoxTruth(path, frame));
  }
  EXPECT_EQ(voxelsOf(baked(path)).size(), 15u);
  // it stands on the ground, about the middle
  EXPECT_EQ(voxelsOf(baked(path)).begin()->first, (Place{0, -2, 0}));
  Settings settings;
  settings.frame = 3;
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, settings), "frames 0 to 2"));
  VoxMaker still;
  still.box({2, 2, 2});
  settings.frame = 1;
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", still.bytes()), Exit::kUsage, settings), "no animation"));
}

TEST(ImportVox, ObjectsAsParts) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({3, 4, 5});
  maker.box({6, 1, 2});
  maker.model({3, 3, 3}, {});
  maker.transform(0, 1, {{}});
  maker.group(1, {2, 4, 6});
  maker.transform(2, 3, {{{"_t", "-300 7 1"}}}, {{"_name", "left"}});
  maker.shape(3, {{0, {}}});
  maker.transform(4, 5, {{{"_r", "17"}, {"_t", "300 0 0"}}});
  maker.shape(5, {{1, {}}});
  maker.transform(6, 7, {{}}, {{"_name", "nothing"}});
  maker.shape(7, {{2, {}}});
  const auto path = scratch.write("model.vox", maker.bytes());
  Settings settings;
  settings.parts = Parts::kNodes;
  const RawPack pack = baked(path, settings);
  ASSERT_EQ(pack.parts.size(), 2u);
  EXPECT_EQ(pack.parts[0].name, "left");
  EXPECT_EQ(pack.parts[1].name, "object 2");
  EXPECT_EQ(pack.parts[0].pivot[3], glm::vec3(-300, 1, -7));
  expectTruth(pack, readVoxTruth(path));
  settings.rig_preset = "sway";
  EXPECT_TRUE(contains(refusal(path, Exit::kUsage, settings), "--parts nodes"));
}

TEST(ImportVox, SizesAreWhatTheUserSays) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({3, 4, 7});
  maker.scene({{0, {{"_t", "5 -8 11"}}}});
  const auto path = scratch.write("model.vox", maker.bytes());
  Settings settings;
  settings.unit = 0.5;
  expectTruth(baked(path, settings), readVoxTruth(path), 0.5);
  settings.unit = 0.01;
  settings.voxel_size = 0.25;
  expectTruth(baked(path, settings), readVoxTruth(path), 0.25);
}

// Whoever swaps palettes gets the same pattern on every level: no coarse voxel has an index that none of
// those below it has.
TEST(ImportVox, CoarserLevelsUseNoOtherIndices) {
  const Scratch scratch;
  VoxMaker maker;
  std::vector<std::array<int, 4>> voxels;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      // white and dark red: their mean is a color of the palette too
      for (int x = 0; x < 32; ++x) voxels.push_back({x, y, z, (x / 4 + y / 4 + z / 4) % 2 ? 1 : 220});
  maker.model({32, 32, 32}, voxels);
  const RawPack pack = baked(scratch.write("model.vox", maker.bytes()));
  ASSERT_GT(pack.parts[0].levels.size(), 2u);
  for (const RawLevel& level : pack.parts[0].levels)
    for (const std::uint32_t attribute : level.attributes)
      ASSERT_TRUE(attributePalette(attribute) == 0 || attributePalette(attribute) == 219);
}

TEST(ImportVox, APaletteFromOutsideWins) {
  const Scratch scratch;
  VoxMaker maker;
  maker.model({2, 1, 1}, {{0, 0, 0, 1}, {1, 0, 0, 255}});
  const auto path = scratch.write("model.vox", maker.bytes());
  Settings settings;
  settings.palette_file = scratch.write("two.gpl", "GIMP Palette\n0 0 0\n250 250 250\n");
  const RawPack pack = baked(path, settings);
  EXPECT_EQ(pack.palette.size(), 2u);
  EXPECT_EQ(voxelsOf(pack).at({-1, 0, 0}), 1);
  EXPECT_EQ(voxelsOf(pack).at({0, 0, 0}), 0);
}

TEST(ImportVox, FlatFacesHaveTheirOwnNormals) {
  const Scratch scratch;
  VoxMaker maker;
  maker.filled({12, 12, 12}, 5);
  const SourceModel model = importFile(scratch.write("model.vox", maker.bytes()), {});
  const VoxelGrid& grid = *model.parts[0].grid;
  std::size_t inner = 0;
  for (const SurfaceSample& sample : grid.surface) {
    const glm::ivec3 at(sample.index % 12, sample.index / 12 % 12, sample.index / 144);
    glm::vec3 outward(0);
    for (int axis = 0; axis < 3; ++axis) outward[axis] = at[axis] == 0 ? -1.0f : at[axis] == 11 ? 1.0f : 0.0f;
    EXPECT_GT(glm::dot(sample.normal, outward), 0.7f);
    int near_edges = 0;
    for (int axis = 0; axis < 3; ++axis) near_edges += at[axis] < 2 || at[axis] > 9;
    if (near_edges > 1) continue;
    ++inner;
    EXPECT_EQ(sample.normal, outward);
  }
  EXPECT_EQ(inner, 6u * 8 * 8);
}

// One voxel thick: both sides are one voxel's, and the same one everywhere, up to the rim.
TEST(ImportVox, ThinWallsAreOfOneMind) {
  const Scratch scratch;
  VoxMaker maker;
  maker.filled({9, 1, 9}, 5);
  const SourceModel model = importFile(scratch.write("model.vox", maker.bytes()), {});
  for (const SurfaceSample& sample : model.parts[0].grid->surface) {
    const glm::vec3 file = glm::transpose(glm::mat3(axisRotation(Axis::kPlusZ))) * sample.normal;
    const glm::ivec3 at(sample.index % 9, sample.index / 9 % 9, sample.index / 81);
    if (at.x > 0 && at.x < 8 && at.y > 0 && at.y < 8) {
      EXPECT_EQ(std::abs(file.y), 1.0f) << at.x << ' ' << at.y;
    }
  }
}

// A closed shell one voxel thick, whose inside nobody sees, is as smooth as the ball that it goes around.
TEST(ImportVox, ShellsHaveAnOutside) {
  const Scratch scratch;
  VoxMaker shell;
  std::vector<std::array<int, 4>> voxels;
  const auto inside = [](int x, int y, int z) { return glm::length(glm::dvec3(x, y, z) + 0.5 - 25.0) <= 22; };
  for (int z = 0; z < 50; ++z)
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 50; ++x)
        if (inside(x, y, z) && !(inside(x - 1, y, z) && inside(x + 1, y, z) && inside(x, y - 1, z) &&
                                 inside(x, y + 1, z) && inside(x, y, z - 1) && inside(x, y, z + 1)))
          voxels.push_back({x, y, z, 1});
  shell.model({50, 50, 50}, voxels);
  const SourceModel model = importFile(scratch.write("model.vox", shell.bytes()), {});
  const VoxelGrid& grid = *model.parts[0].grid;
  EXPECT_EQ(grid.surface.size(), voxels.size());
  for (const SurfaceSample& sample : grid.surface) {
    const auto side = static_cast<std::uint64_t>(grid.size.x);
    const glm::dvec3 at(double(sample.index % side), double(sample.index / side % side),
                        double(sample.index / (side * side)));
    EXPECT_GT(glm::dot(glm::normalize(at + 0.5 - glm::dvec3(grid.size) * 0.5), glm::dvec3(sample.normal)),
              0.93);
  }
}

TEST(ImportVox, TheSameOnAnyNumberOfThreads) {
  const Scratch scratch;
  VoxMaker maker;
  maker.box({40, 40, 40});
  const auto path = scratch.write("model.vox", maker.bytes());
  Settings one, five;
  one.threads = 1;
  five.threads = 5;
  const SourceModel a = importFile(path, one), b = importFile(path, five);
  ASSERT_EQ(a.parts[0].grid->surface.size(), b.parts[0].grid->surface.size());
  for (std::size_t i = 0; i < a.parts[0].grid->surface.size(); ++i) {
    const SurfaceSample &p = a.parts[0].grid->surface[i], &q = b.parts[0].grid->surface[i];
    ASSERT_TRUE(p.index == q.index && p.normal == q.normal && p.source == q.source);
  }
}

}  // namespace
}  // namespace kelp::bake::test
