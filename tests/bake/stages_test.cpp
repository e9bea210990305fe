// SPDX-License-Identifier: MIT
// Colors, palette, levels and the written file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "kelp/common/output_file.h"
#include "kelp/fields/fields.h"
#include "shapes.h"
#include "support/scratch.h"
#include "support/straight_knots.h"

namespace kelp {
namespace {

using test::voxelizeUnit;

// A square of 16 x 16 units in the xy plane, uv 0 to 1, one unit thick, with a 4 x 4 texture whose texel (i,
// j) is red i/3, green j/3.
bake::SourceModel texturedPlate() {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {16, 16, 1});
  for (const bake::TriangleSoup::Triangle& triangle : soup.triangles) {
    auto& uv = soup.uvs.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      uv[k] = glm::vec2(soup.positions[triangle.vertex[k]].x / 16.0f,
                        1.0f - soup.positions[triangle.vertex[k]].y / 16.0f);
  }
  bake::SourceModel model = test::makeModel(soup);
  bake::Image image;
  image.width = image.height = 4;
  image.srgb = false;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i)
      image.rgba.insert(image.rgba.end(),
                        {static_cast<std::uint8_t>(i * 85), static_cast<std::uint8_t>(j * 85), 0, 255});
  }
  model.images.push_back(image);
  model.materials[0].texture = 0;
  model.materials[0].nearest = true;
  return model;
}

// Base colors of the voxels with z = 0, [y * 16 + x].
std::vector<glm::vec4> colorsOf(const bake::SourceModel& model) {
  std::vector<glm::vec4> colors(256);
  const test::Baked baked = voxelizeUnit(model);
  EXPECT_EQ(baked.grid().size, glm::ivec3(16, 16, 1));
  for (const bake::SurfaceSample& sample : baked.grid().surface)
    colors[sample.index] = sample.material.base_color;
  return colors;
}

TEST(SurfaceColor, TextureStandsUprightWithItsTexels) {
  const std::vector<glm::vec4> colors = colorsOf(texturedPlate());
  // Row 0 of the image is at v = 0, the top: y = 15.
  EXPECT_NEAR(colors[2 + 16 * 14].x, 0.0f, 0.01f);
  EXPECT_NEAR(colors[2 + 16 * 14].y, 0.0f, 0.01f);
  EXPECT_NEAR(colors[14 + 16 * 14].x, 1.0f, 0.01f);
  EXPECT_NEAR(colors[2 + 16 * 2].y, 1.0f, 0.01f);
  EXPECT_NEAR(colors[6 + 16 * 6].x, 1.0f / 3, 0.01f);
  EXPECT_NEAR(colors[6 + 16 * 6].y, 2.0f / 3, 0.01f);
}

bake::VoxelGrid gridOfColors(int count) {
  bake::VoxelGrid grid;
  grid.size = {count, 1, 1};
  grid.solid.assign(static_cast<std::size_t>(count), 1);
  for (int i = 0; i < count; ++i) {
    bake::SurfaceSample sample;
    sample.index = static_cast<std::uint64_t>(i);
    sample.material.base_color = {static_cast<float>(i % 40) / 39.0f, static_cast<float>(i / 40 % 40) / 39.0f,
                                  static_cast<float>(i / 1600) / 10.0f, 1};
    grid.surface.push_back(sample);
  }
  return grid;
}

TEST(Palette, IsExactUpTo256) {
  const bake::VoxelGrid grid = gridOfColors(256);
  const bake::Palette palette = bake::choosePalette({&grid, &grid}, 2);
  EXPECT_EQ(palette.entries.size(), 256u);
  EXPECT_EQ(palette.mean_error, 0.0);
  ASSERT_EQ(palette.indices.size(), 2u);
  for (std::size_t i = 0; i < 256; ++i)
    EXPECT_EQ(palette.entries[palette.indices[1][i]].base_color, grid.surface[i].material.base_color);
}

TEST(Palette, ClustersMoreAndKeepsWhatIsRareButApart) {
  bake::VoxelGrid grid = gridOfColors(8000);
  grid.surface[7].material.emissive = {4, 0, 0};  // one glowing voxel among 8000
  const bake::Palette palette = bake::choosePalette({&grid}, 1);
  EXPECT_LE(palette.entries.size(), 256u);
  EXPECT_GT(palette.mean_error, 0.0);
  EXPECT_LT(palette.mean_error, 0.05);
  EXPECT_GT(palette.entries[palette.indices[0][7]].emissive.x, 3.9f);
  const bake::Palette again = bake::choosePalette({&grid}, 4);
  EXPECT_EQ(palette.indices, again.indices);
}

TEST(Palette, OfNothingHasOneEntry) {
  const bake::VoxelGrid grid;
  EXPECT_EQ(bake::choosePalette({&grid}, 1).entries.size(), 1u);
}

TEST(Levels, HalveByOrAndAverageWhatLiesAbove) {
  bake::TriangleSoup soup;
  test::addSphere(soup, {0, 0, 0}, 20.3f, 40);
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  const bake::Palette palette = bake::choosePalette({&baked.grid()}, 1);
  const std::vector<RawLevel> levels =
      bake::buildLevels(baked.grid(), palette.indices[0], palette.entries, 0, 2, {});
  ASSERT_EQ(levels.size(), 4u);  // 41, 21, 11, 6: one brick
  EXPECT_EQ(levels.back().cells.size(), 1u);
  EXPECT_EQ(bake::buildLevels(baked.grid(), palette.indices[0], palette.entries, 2, 2, {}).size(), 2u);
  fields::Occupancy fine{baked.grid().size, baked.grid().solid};
  std::set<std::uint64_t> surface;
  for (const bake::SurfaceSample& sample : baked.grid().surface) surface.insert(sample.index);
  for (int level = 0; level < 4; ++level) {
    const glm::ivec3 size = levelSize(baked.grid().size, level);
    const fields::Occupancy stored = fields::occupancyOf(levels[static_cast<std::size_t>(level)], size);
    EXPECT_EQ(stored.solid, fine.solid) << level;
    EXPECT_EQ(levels[static_cast<std::size_t>(level)].attributes.size(), surface.size()) << level;
    // The next level, by the definition.
    const glm::ivec3 half = levelSize(baked.grid().size, level + 1);
    fields::Occupancy coarse{
        half, std::vector<std::uint8_t>(static_cast<std::size_t>(half.x) * static_cast<std::size_t>(half.y) *
                                            static_cast<std::size_t>(half.z),
                                        0)};
    std::set<std::uint64_t> above;
    for (int z = 0; z < size.z; ++z) {
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
          const std::size_t i = fine.index({x, y, z}), up = coarse.index({x / 2, y / 2, z / 2});
          coarse.solid[up] |= fine.solid[i];
          if (surface.count(i)) above.insert(up);
        }
      }
    }
    fine = coarse;
    surface = above;
  }
}

std::vector<char> readAll(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(WritePackFile, InterruptLeavesTheOldFileAlone) {
  bake::TriangleSoup soup;
  test::addBox(soup, {0, 0, 0}, {9, 9, 9});
  const test::Baked baked = voxelizeUnit(test::makeModel(soup));
  const bake::Palette palette = bake::choosePalette({&baked.grid()}, 1);
  RawPack pack;
  pack.info_json = "{}";
  pack.palette = palette.entries;
  RawPart& part = pack.parts.emplace_back();
  part.name = "box";
  part.size = baked.grid().size;
  part.knots = test::straightKnots();
  part.levels = bake::buildLevels(baked.grid(), palette.indices[0], palette.entries, 0, 1, {});

  const test::Scratch scratch;
  const std::filesystem::path& folder = scratch.folder();
  const std::filesystem::path path = scratch.write("box.kelp", "old");
  bake::Report report;
  try {
    bake::writePackFile(pack, path, 1, report, [](std::string_view, double) { return false; });
    ADD_FAILURE() << "was not interrupted";
  } catch (const kelp::ToolError& error) {
    EXPECT_EQ(error.exit, kelp::Exit::kInterrupted);
  }
  EXPECT_EQ(readAll(path), (std::vector<char>{'o', 'l', 'd'}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);

  kelp::checkOutput(path);
  EXPECT_EQ(readAll(path), (std::vector<char>{'o', 'l', 'd'}));
  bake::writePackFile(pack, path, 1, report);
  EXPECT_EQ(readAll(path).size(), report.pack_bytes);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

// The same model with another rig is another pack: its INFO must say so, wherever the rig's file was found.
TEST(Info, RecordsARigFromAFile) {
  const test::Scratch scratch;
  const std::filesystem::path model =
      scratch.write("tet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string
      straight = R"({"kelp": 1})",
      sway =
          R"({"kelp": 1, "clips": {"sway": {"waves": [{"knot": 1, "offset": [0.1, 0, 0], "period": 2}]}}})";
  const auto info = [&](const char* rig) {
    bake::Settings settings;
    settings.resolution = 8;
    if (rig) settings.rig_file = scratch / rig;
    bake::Report report;
    return bake::bake(model, settings, report).info_json;
  };
  const auto rigOf = [](const std::string& text) {  // the object after "rig":
    const std::size_t at = text.find(R"("rig":{)");
    return at == std::string::npos ? std::string() : text.substr(at, text.find('}', at) - at);
  };
  EXPECT_EQ(info(nullptr).find("rig"), std::string::npos);
  scratch.write("any.rig.json", straight);
  const std::string first = rigOf(info("any.rig.json"));
  scratch.write("any.rig.json", sway);
  const std::string second = rigOf(info("any.rig.json"));
  EXPECT_NE(first.find(R"("name":"any.rig.json","xxh3":")"), std::string::npos) << first;
  EXPECT_NE(first, second);
  scratch.write("tet.rig.json", sway);
  const std::string beside = rigOf(info(nullptr));
  EXPECT_NE(beside.find(R"("name":"tet.rig.json")"), std::string::npos) << beside;
  EXPECT_EQ(beside.substr(beside.find("xxh3")), second.substr(second.find("xxh3")));
}

}  // namespace
}  // namespace kelp
