// SPDX-License-Identifier: MIT
// Pictures of leaves on cards: what is transparent is not there, what is there keeps its color, bodies stay
// whole.
#include <algorithm>
#include <cmath>
#include <map>

#include "import_scratch.h"
#include "kelp/common/dense_index.h"
#include "kelp/import/core/frame.h"
#include "kelp/voxelize/voxelize.h"
#include "shapes.h"

namespace kelp::bake::test {
namespace {

using kelp::test::Baked;
using kelp::test::makeModel;
using kelp::test::voxelizeUnit;

constexpr int kPicture = 256;
constexpr float kRadius = 0.4f;  // of the disc, in widths of the picture

// A green disc; all around it, transparent, magenta.
Image disc() {
  Image image;
  image.width = image.height = kPicture;
  for (int y = 0; y < kPicture; ++y) {
    for (int x = 0; x < kPicture; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / kPicture - 0.5f,
                  v = (static_cast<float>(y) + 0.5f) / kPicture - 0.5f;
      const bool inside = u * u + v * v < kRadius * kRadius;
      for (const int c : inside ? std::array{0, 255, 0, 255} : std::array{255, 0, 255, 0})
        image.rgba.push_back(static_cast<std::uint8_t>(c));
    }
  }
  return image;
}

// A square of n voxels in the plane z, or x if `turned`, with the whole picture on it.
void addCard(TriangleSoup& soup, float n, float at, bool turned, std::uint32_t material) {
  const std::uint32_t first = static_cast<std::uint32_t>(soup.positions.size());
  const std::array<glm::vec2, 4> corner = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1),
                                           glm::vec2(0, 1)};
  for (const glm::vec2& c : corner)
    soup.positions.push_back(turned ? glm::vec3(at, c.y * n, c.x * n) : glm::vec3(c.x * n, c.y * n, at));
  for (const std::array<std::uint32_t, 3>& t : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}}) {
    soup.triangles.push_back({{first + t[0], first + t[1], first + t[2]}, material});
    soup.uvs.push_back({corner[t[0]], corner[t[1]], corner[t[2]]});
  }
}

// Material 0 is opaque and blue, material 1 cut out.
SourceModel cards(TriangleSoup soup) {
  SourceModel model = makeModel(std::move(soup));
  model.materials.resize(2);
  model.materials[0].base_color = {0, 0, 1, 1};
  model.materials[1].name = "leaf";
  model.materials[1].texture = 0;
  model.materials[1].wrap_u = model.materials[1].wrap_v = Wrap::kClamp;
  model.materials[1].alpha_cutoff = 0.5f;
  model.images.push_back(disc());
  return model;
}

std::uint64_t countSamples(const Baked& baked, const glm::vec3& color) {
  std::uint64_t count = 0;
  for (const SurfaceSample& s : baked.grid().surface)
    count += glm::distance(glm::vec3(s.material.base_color), color) < 0.01f && s.material.base_color.a == 1;
  return count;
}

TEST(CutOut, ACardShowsItsDisc) {
  for (const float n : {32.0f, 100.0f, 256.0f}) {
    TriangleSoup soup;
    addCard(soup, n, 0, false, 1);
    const Baked baked = voxelizeUnit(cards(soup));
    const glm::ivec3 size = baked.grid().size;
    ASSERT_EQ(size.x, static_cast<int>(n));
    EXPECT_NEAR(static_cast<double>(baked.solid), M_PI * kRadius * kRadius * n * n, 0.02 * n * n) << n;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        // Voxels of which the disc's edge passes within one are either.
        const double from_center = std::hypot(x + 0.5 - 0.5 * n, y + 0.5 - 0.5 * n) - kRadius * n;
        if (std::abs(from_center) < 1) continue;
        bool solid = false;
        for (int z = 0; z < size.z; ++z) solid = solid || baked.at(x, y, z);
        ASSERT_EQ(solid, from_center < 0) << x << " " << y << " of " << n;
      }
    }
    EXPECT_EQ(countSamples(baked, {0, 1, 0}), baked.grid().surface.size()) << "the paper shines through";
  }
}

// Two cards cross; where one is transparent the other stays, in its own color.
TEST(CutOut, WhatStandsBehindAHoleStays) {
  TriangleSoup soup;
  addCard(soup, 64, 32.5f, false, 1);
  addCard(soup, 64, 32.5f, true, 0);
  const Baked baked = voxelizeUnit(cards(soup));
  for (int y = 0; y < 64; ++y)
    for (int z = 0; z < 64; ++z) ASSERT_TRUE(baked.at(32, y, z)) << y << " " << z;
  const std::uint64_t blue = countSamples(baked, {0, 0, 1}), green = countSamples(baked, {0, 1, 0});
  EXPECT_EQ(blue + green, baked.grid().surface.size());
  EXPECT_GE(blue, 64u * 63u);
}

// A box of 16 voxels of which so many of the twelve triangles are cut out.
SourceModel cutBox(std::size_t cut) {
  TriangleSoup soup;
  kelp::test::addBox(soup, {0, 0, 0}, {16, 16, 16});
  for (TriangleSoup::Triangle& t : soup.triangles) {
    t.material = 1;
    const glm::vec2 at(soup.uvs.size() < cut ? 0 : 0.5f);
    soup.uvs.push_back({at, at, at});
  }
  return cards(soup);
}

// Open above: 11 % of its surface would close it.
TEST(CutOut, AnOpenShellIsASheetToo) {
  const auto made = [](std::size_t cut) {
    SourceModel model = cutBox(cut);
    TriangleSoup soup;
    kelp::test::addBox(soup, {0, 0, 0}, {16, 32, 16}, 3);
    for (TriangleSoup::Triangle& t : soup.triangles) t.material = 1;
    soup.uvs.assign(model.parts[0].soup.uvs.begin(), model.parts[0].soup.uvs.begin() + 10);
    model.parts[0].soup = soup;
    return model;
  };
  EXPECT_GT(voxelizeUnit(made(0)).solid, 16u * 16u * 30u);
  const Baked shell = voxelizeUnit(made(2));
  EXPECT_LT(shell.solid, 16u * 16u * 16u);
  EXPECT_EQ(shell.grid().solid, voxelizeUnit(made(2), Fill::kSurface).grid().solid);
}

TEST(CutOut, BodiesStayWholeAndSaySo) {
  const Baked body = voxelizeUnit(cutBox(1));
  EXPECT_EQ(body.solid, 16u * 16u * 16u);
  EXPECT_TRUE(anyContains(body.result.notices, "'leaf' has cut-outs"));
  const Baked sheets = voxelizeUnit(cutBox(12), Fill::kSurface);
  EXPECT_EQ(sheets.solid, 0u);
  EXPECT_TRUE(sheets.result.notices.empty());
}

// From a tenth of its surface on, as --fill surface has it.
TEST(CutOut, AShellIsASheet) {
  for (const std::size_t cut : {2u, 5u}) {
    const Baked shell = voxelizeUnit(cutBox(cut)), sheet = voxelizeUnit(cutBox(cut), Fill::kSurface);
    EXPECT_EQ(shell.grid().solid, sheet.grid().solid) << cut;
    EXPECT_LT(shell.solid, 16u * 16u * 16u / 2) << cut;
    EXPECT_TRUE(shell.result.notices.empty()) << cut;
    EXPECT_EQ(voxelizeUnit(cutBox(cut), Fill::kSolid).solid, 16u * 16u * 16u) << cut;
  }
}

// A public bug report: a green hat with holes around a red box. From outside it looks as --fill surface does.
TEST(CutOut, ABodyShowsBelowAHat) {
  const SourceModel model = importFile(std::filesystem::path(KELP_HUNT) / "hat_mask.glb", {});
  const SourcePart& part = model.parts.at(0);
  const Frame frame = makeFrame(part.soup, Axis::kPlusY, 2.12 / 96, "hat");
  // The color of the first voxel along +x in each row: -1: none, 0: green, 1: red.
  const auto seen = [&](Fill fill) {
    const VoxelGrid grid = voxelize(model, part, frame, fill, 1, {}).grid;
    std::map<std::uint64_t, bool> red;
    for (const SurfaceSample& sample : grid.surface)
      red[sample.index] = sample.material.base_color.r > sample.material.base_color.g;
    std::vector<int> rows;
    for (int z = 0; z < grid.size.z; ++z)
      for (int y = 0; y < grid.size.y; ++y) {
        int x = 0;
        while (x < grid.size.x && !grid.solid[denseIndex(grid.size, x, y, z)]) ++x;
        rows.push_back(x == grid.size.x ? -1 : red.at(denseIndex(grid.size, x, y, z)));
      }
    return rows;
  };
  const std::vector<int> rows = seen(Fill::kAuto);
  const std::vector<int> sheets = seen(Fill::kSurface);
  // A solid box and its faces have other voxels along its edges.
  int other = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) other += rows[i] != sheets[i];
  EXPECT_LT(other, static_cast<int>(rows.size() / 50));
  EXPECT_GT(std::ranges::count(rows, 1), 1000);
  EXPECT_GT(std::ranges::count(rows, 0), 1000);
}

TEST(CutOut, ThreadsDoNotMatter) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i)
    addCard(soup, 60, static_cast<float>(i) * 7.3f, i % 2 != 0, static_cast<std::uint32_t>(i % 3 != 0));
  const SourceModel model = cards(soup);
  EXPECT_EQ(voxelizeUnit(model, Fill::kAuto, 1).grid().solid,
            voxelizeUnit(model, Fill::kAuto, 4).grid().solid);
}

// An uncompressed TGA of one row of pixels, each of the alpha given.
std::string tga(const std::vector<int>& alpha) {
  std::string bytes("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
  bytes += {static_cast<char>(alpha.size()), 0, 1, 0, 32, 8};
  for (const int a : alpha) bytes += {0, 0, 0, static_cast<char>(a)};
  return bytes;
}

SurfaceMaterial importMaterial(const std::vector<int>& alpha, const std::string& mode, float factor,
                               std::vector<std::string>* notices = nullptr) {
  const Scratch scratch;
  scratch.write("leaf.tga", tga(alpha));
  GltfMaker maker;
  maker.addBox();
  maker.floats(std::vector<float>(16, 0.0f), 2);
  const SourceModel model = importFile(
      scratch.write(
          "a.gltf",
          maker.text(
              R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],"images":[{"uri":"leaf.tga"}],"textures":[{"source":0}],
      "materials":[{)" +
              mode + R"(,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)" + std::to_string(factor) +
              R"(],"baseColorTexture":{"index":0}}}])")),
      {});
  if (notices) *notices = model.notices;
  EXPECT_EQ(model.images.size(), 1u);
  return model.materials[0];
}

TEST(CutOut, ComesFromTheAlphaModesOfGltf) {
  std::vector<std::string> notices;
  EXPECT_EQ(importMaterial({0, 255}, R"("alphaMode":"OPAQUE")", 1).alpha_cutoff, 0);
  // A mask is 0 or 1 once it is read: half of a voxel decides, whatever the cutoff. 100 of 255 passes 0.25,
  // and with a factor of 0.5 does not.
  EXPECT_EQ(importMaterial({0, 255}, R"("alphaMode":"MASK")", 1, &notices).alpha_cutoff, 0.5f);
  EXPECT_TRUE(notices.empty());
  EXPECT_EQ(importMaterial({100, 255}, R"("alphaMode":"MASK","alphaCutoff":0.25)", 1, &notices).alpha_cutoff,
            0);
  EXPECT_TRUE(anyContains(notices, "nothing is cut out"));
  EXPECT_EQ(importMaterial({100, 255}, R"("alphaMode":"MASK","alphaCutoff":0.25)", 0.5f).alpha_cutoff, 0.5f);
  // Blending cuts at half of the picture's alpha, unless the picture is a pane: all below, or all above.
  EXPECT_EQ(importMaterial({0, 255}, R"("alphaMode":"BLEND")", 1).alpha_cutoff, 0.5f);
  EXPECT_EQ(importMaterial({0, 255}, R"("alphaMode":"BLEND")", 0.5f).alpha_cutoff, 0.25f);
  EXPECT_EQ(importMaterial({80, 100}, R"("alphaMode":"BLEND")", 1, &notices).alpha_cutoff, 0);
  EXPECT_FALSE(anyContains(notices, "cut out"));
  EXPECT_TRUE(anyContains(notices, "is transparent; it is baked opaque"));
}

// Meshes that are cut out entirely are left out, bodies too, with one notice however often they are shown,
// and nothing else goes with them.
TEST(CutOut, PartsThatNobodySeesAreLeftOut) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const SourceModel model = importFile(
      scratch.write(
          "a.gltf",
          maker.text(
              R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "materials":[{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.1]}}],"nodes":[{"mesh":0},{"mesh":1},{"mesh":0,"translation":[1,0,0]}])")),
      {});
  EXPECT_EQ(model.parts.at(0).soup.triangles.size(), 12u);
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "meshes[0].primitives[0]: its alphaMode is MASK"))
      << model.notices[0];
}

// A sheet of one square, 16 voxels a side; `alpha` is that of COLOR_0 at x = 0 and x = 16.
class Masked : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& material, const std::vector<int>& texels = {},
                              std::array<float, 2> alpha = {1, 1}) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 16, 0, 0, 16, 16, 0, 0, 16, 0}, 3);
    maker.indices({0, 1, 2, 0, 2, 3});
    maker.floats({0, 0, 1, 0, 1, 1, 0, 1}, 2);
    maker.floats({1, 1, 1, alpha[0], 1, 1, 1, alpha[1], 1, 1, 1, alpha[1], 1, 1, 1, alpha[0]}, 4);
    if (!texels.empty()) scratch_.write("leaf.tga", tga(texels));
    return scratch_.write(
        "a.gltf",
        maker.text(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2,"COLOR_0":3},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],"materials":[{"alphaMode":"MASK",)" +
            material +
            (texels.empty() ? "}]" : R"(}],"images":[{"uri":"leaf.tga"}],"textures":[{"source":0}])")));
  }
  // The share of the square that is there.
  double share(const std::filesystem::path& path) {
    model_ = importFile(path, {});
    return static_cast<double>(voxelizeUnit(model_).solid) / 256;
  }
  static std::string factor(float alpha, const std::string& more = "") {
    return R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)" + std::to_string(alpha) + "]" + more + "}";
  }

  Scratch scratch_;
  SourceModel model_;
};

TEST_F(Masked, FactorsAloneCutOutAllOrNothing) {
  EXPECT_EQ(share(write(factor(0.5f))), 1);
  EXPECT_EQ(share(write(factor(0.2f) + R"(,"alphaCutoff":0.2)")), 1);
  EXPECT_EQ(share(write(factor(0) + R"(,"alphaCutoff":0)")), 1);
  EXPECT_TRUE(model_.notices.empty());
  for (const std::string& material : {factor(0.4f), factor(1) + R"(,"alphaCutoff":1.5)"})
    EXPECT_TRUE(
        contains(refusal(write(material), Exit::kUnsupported), "meshes[0].primitives[0] is below the cutoff"))
        << material;
}

TEST_F(Masked, PicturesBelowTheCutoffLeaveNothing) {
  const std::string texture = R"(,"baseColorTexture":{"index":0})";
  EXPECT_EQ(share(write(factor(1, texture), {200, 200})), 1);
  EXPECT_TRUE(anyContains(model_.notices, "nothing is cut out"));
  EXPECT_TRUE(contains(refusal(write(factor(1, texture), {100, 100}), Exit::kUnsupported),
                       "meshes[0].primitives[0] is below the cutoff"));
  EXPECT_TRUE(contains(refusal(write(factor(0.5f, texture), {200, 200}), Exit::kUnsupported),
                       "meshes[0].primitives[0] is below the cutoff"));
}

// alpha = x / 16: the half with x >= 8 is there; a factor or a picture of a half halves what is left.
TEST_F(Masked, ColorsOfCornersCount) {
  EXPECT_NEAR(share(write(factor(1), {}, {0, 1})), 0.5, 1.0 / 16);
  EXPECT_NEAR(share(write(factor(1) + R"(,"alphaCutoff":0.25)", {}, {0, 1})), 0.75, 1.0 / 16);
  EXPECT_NEAR(share(write(factor(0.5f) + R"(,"alphaCutoff":0.25)", {}, {0, 1})), 0.5, 1.0 / 16);
  EXPECT_NEAR(share(write(factor(1, R"(,"baseColorTexture":{"index":0})") + R"(,"alphaCutoff":0.25)",
                          {128, 128}, {0, 1})),
              0.5, 1.0 / 16);
  EXPECT_TRUE(contains(refusal(write(factor(1), {}, {0.25f, 0.25f}), Exit::kUnsupported),
                       "meshes[0].primitives[0] is below the cutoff"));
}

// The triangles are there, and so thin a rim of them is left that no voxel is.
TEST_F(Masked, APartOfWhichNoVoxelIsLeftSaysWhy) {
  Settings settings;
  settings.resolution = 16;
  const std::filesystem::path path = write(factor(1) + R"(,"alphaCutoff":0.99)", {}, {0, 1});
  try {
    Report report;
    bake(path, settings, report);
    ADD_FAILURE() << "was baked";
  } catch (const ToolError& error) {
    EXPECT_EQ(error.exit, Exit::kUnsupported);
    EXPECT_TRUE(contains(error.what(), "the alpha of its materials cuts all of it out")) << error.what();
  }
}

}  // namespace
}  // namespace kelp::bake::test
