// SPDX-License-Identifier: MIT
// Palettes by request: colors that somebody fixed, and materials that stay apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "import_scratch.h"
#include "shapes.h"

namespace kelp {
namespace {

using bake::test::Scratch;
using kelp::Exit;

// Two boxes of the same gray, of two materials, one voxel apart.
bake::SourceModel twins() {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {8, 8, 8});
  const std::size_t first = soup.triangles.size();
  test::addBox(soup, {9, 0, 0}, {16, 8, 8});
  for (std::size_t i = first; i < soup.triangles.size(); ++i) soup.triangles[i].material = 1;
  bake::SourceModel model = test::makeModel(soup);
  model.materials[0].base_color = {0.2f, 0.2f, 0.2f, 1};
  model.materials.push_back(model.materials[0]);
  return model;
}

std::string refusal(const std::filesystem::path& path, Exit code) {
  try {
    bake::readPalette(path);
  } catch (const kelp::ToolError& error) {
    EXPECT_EQ(error.exit, code);
    return error.what();
  }
  ADD_FAILURE() << path << " was accepted";
  return {};
}

TEST(PaletteRules, MaterialsOfOneColorStayApartOnAllLevels) {
  const test::Baked baked = test::voxelizeUnit(twins());
  EXPECT_EQ(bake::choosePalette({&baked.grid()}, 2).entries.size(), 1u);
  const bake::Palette palette = bake::choosePalette({&baked.grid()}, 2, {{}, {}, true});
  ASSERT_EQ(palette.entries.size(), 2u);
  EXPECT_EQ(palette.sources, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(palette.mean_error, 0.0);
  for (std::size_t i = 0; i < palette.indices[0].size(); ++i) {
    const std::uint64_t x = baked.grid().surface[i].index % static_cast<std::uint64_t>(baked.grid().size.x);
    EXPECT_EQ(palette.indices[0][i], x < 8 ? 0 : 1);
  }
  const std::vector<RawLevel> levels =
      bake::buildLevels(baked.grid(), palette.indices[0], palette.entries, 0, 2, {}, palette.sources);
  ASSERT_GT(levels.size(), 1u);
  for (const RawLevel& level : levels) {
    std::size_t of[2] = {0, 0};
    for (const std::uint32_t attribute : level.attributes) ++of[attribute & 0xff];
    EXPECT_GT(of[0], 0u);
    EXPECT_GT(of[1], 0u) << "the second material is gone from a coarser level";
  }
}

TEST(PaletteRules, CrowdedPalettesAreShared) {
  // One material of 5 colors and one of 5000.
  bake::VoxelGrid grid;
  for (std::uint32_t i = 0; i < 5005; ++i) {
    bake::SurfaceSample& sample = grid.surface.emplace_back();
    sample.index = i;
    sample.source = i < 5 ? 3 : 7;
    sample.material.base_color =
        i < 5 ? glm::vec4(0.1f * static_cast<float>(i), 0, 0, 1)
              : glm::vec4(0, static_cast<float>(i % 71) / 71.0f, static_cast<float>(i / 71) / 71.0f, 1);
  }
  const bake::Palette palette = bake::choosePalette({&grid}, 2, {{}, {}, true});
  EXPECT_EQ(palette.entries.size(), 256u);
  EXPECT_EQ(std::count(palette.sources.begin(), palette.sources.end(), 3u), 5);
  for (std::size_t i = 0; i < 5005; ++i) {
    ASSERT_EQ(palette.sources[palette.indices[0][i]], grid.surface[i].source);
    if (i < 5) {
      EXPECT_EQ(palette.entries[palette.indices[0][i]].base_color, grid.surface[i].material.base_color);
    }
  }
  for (std::uint32_t i = 0; i < 300; ++i) grid.surface[i].source = 100 + i;
  EXPECT_THROW(bake::choosePalette({&grid}, 2, {{}, {}, true}), kelp::ToolError);
}

TEST(PaletteRules, FixedColorsAreTheEntriesInTheirOrder) {
  const Scratch scratch;
  const auto path = scratch.write("p.gpl",
                                  "GIMP Palette\r\nName: three\r\nColumns: 3\r\n# red\r\n255   0   "
                                  "0\tred\r\n  0 255 0 green\r\n128 128 128 gray\r\n");
  bake::FilesUsed used;
  const std::vector<glm::vec3> colors = bake::readPalette(path, &used);
  ASSERT_EQ(used.read.size(), 1u);
  EXPECT_EQ(used.read[0].path, path);
  ASSERT_EQ(colors.size(), 3u);
  EXPECT_EQ(colors[0], glm::vec3(1, 0, 0));
  EXPECT_NEAR(colors[2].x, 0.2158605f, 1e-6f);  // sRGB 128

  bake::SourceModel model = twins();
  model.materials[1].base_color = {0.9f, 0.1f, 0.1f, 1};
  model.materials[1].metallic = 0.5f;
  const test::Baked baked = test::voxelizeUnit(model);
  const bake::Palette palette = bake::choosePalette({&baked.grid()}, 2, {{}, colors, false});
  ASSERT_EQ(palette.entries.size(), 3u);
  for (std::size_t e = 0; e < 3; ++e) EXPECT_EQ(glm::vec3(palette.entries[e].base_color), colors[e]);
  EXPECT_FLOAT_EQ(palette.entries[0].metallic, 0.5f);
  for (std::size_t i = 0; i < palette.indices[0].size(); ++i)
    EXPECT_EQ(palette.indices[0][i], baked.grid().surface[i].source == 0 ? 2 : 0);
  EXPECT_GT(palette.mean_error, 0.0);
}

TEST(PaletteRules, PicturesGiveTheirColorsOnce) {
  const Scratch scratch;
  // TGA: 4 x 1, 32 bits, from the top left: blue, clear, green, blue.
  std::string tga{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 1, 0, 32, 0x28};
  for (const int byte : {255, 0, 0, 255, 9, 9, 9, 0, 0, 255, 0, 255, 255, 0, 0, 255})
    tga += static_cast<char>(byte);
  const std::vector<glm::vec3> colors = bake::readPalette(scratch.write("p.tga", tga));
  ASSERT_EQ(colors.size(), 2u);
  EXPECT_EQ(colors[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(colors[1], glm::vec3(0, 1, 0));
}

TEST(PaletteRules, RefusesWhatIsNoPalette) {
  const Scratch scratch;
  EXPECT_NE(refusal(scratch.write("a.gpl", "GIMP Palette\n1 2 300 x\n"), Exit::kInvalid).find("line 2"),
            std::string::npos);
  refusal(scratch.write("b.gpl", "GIMP Palette\n"), Exit::kInvalid);
  EXPECT_NE(refusal(scratch.write("c.gpl", "not a palette"), Exit::kInvalid)
                .find("is no GIMP palette (.gpl) and is not a PNG"),
            std::string::npos);
  EXPECT_NE(refusal(scratch.write("c.png", "\x89PNG\r\n\x1a\n and no more"), Exit::kInvalid)
                .find("and is a PNG picture whose header is damaged"),
            std::string::npos);
  std::string many = "GIMP Palette\n";
  for (int i = 0; i < 257; ++i) many += std::to_string(i % 256) + " " + std::to_string(i / 256) + " 0\n";
  EXPECT_NE(refusal(scratch.write("d.gpl", many), Exit::kInvalid).find("256"), std::string::npos);
  refusal(scratch.folder() / "absent.gpl", Exit::kIo);
}

}  // namespace
}  // namespace kelp
