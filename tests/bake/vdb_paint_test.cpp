// SPDX-License-Identifier: MIT
// The grids that kelp-dump extract writes beside a solid: what they give back, and when they are left alone.
#include <cmath>
#include <cstdlib>

#include "import_scratch.h"
#include "kelp/formats/brick.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

constexpr double kRadius = 4.2;
const glm::ivec3 kLow(-9, -6, -5), kHigh(5, 7, 11);  // of the part; the ball goes from -4 to 4

VdbSpec grid(const std::string& name, const std::string& type) {
  VdbSpec spec;
  spec.name = name;
  spec.type = type;
  spec.low = glm::ivec3(-12);
  spec.high = glm::ivec3(12);
  return spec;
}

VdbSpec ball() {
  VdbSpec spec = grid("ball", "float");
  spec.grid_class = "level set";
  spec.background = glm::dvec3(3);
  spec.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    return glm::dvec3(std::min(glm::length(glm::dvec3(p)) - kRadius, 3.0));
  };
  return spec;
}

const std::vector<Material> kPalette{{glm::vec4(0.25f, 0.5f, 0.125f, 0.5f), glm::vec3(3, 0, 1), 0.75f, 0.25f},
                                     {glm::vec4(1), glm::vec3(0), 0, 1},
                                     {glm::vec4(0.5f, 0, 0, 1), glm::vec3(0), 1, 0.5f}};
// Not its normal: what is stored counts.
const std::uint32_t kNormal = encodeNormal(glm::vec3(0.6f, -0.64f, 0.48f));
int entryOf(const glm::ivec3& p) { return p.x > 0 ? 2 : 0; }

std::vector<VdbSpec> painted() {
  VdbSpec color = grid("Cd", "vec3s"), attribute = grid("kelp_attribute", "vec3s"),
          palette = grid("kelp_palette", "vec3s");
  color.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    return glm::dvec3(kPalette[static_cast<std::size_t>(entryOf(p))].base_color);
  };
  attribute.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    if (p == kLow || p == kHigh) return glm::dvec3(-1);
    if (glm::length(glm::dvec3(p)) > kRadius) return std::nullopt;
    return glm::dvec3(entryOf(p), kNormal & 0xfffu, kNormal >> 12);
  };
  palette.value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    if (p.x < 0 || p.x > 2 || p.y < 0 || p.y > 2 || p.z != 0) return std::nullopt;
    const Material& m = kPalette[static_cast<std::size_t>(p.x)];
    return p.y == 0   ? glm::dvec3(m.base_color)
           : p.y == 1 ? glm::dvec3(m.emissive)
                      : glm::dvec3(m.base_color.a, m.metallic, m.roughness);
  };
  return {ball(), color, attribute, palette};
}

SourceModel read(const std::vector<VdbSpec>& grids, const Settings& settings = {}) {
  const Scratch scratch;
  writeVdb(scratch.folder() / "ball.vdb", grids);
  return importFile(scratch.folder() / "ball.vdb", settings);
}

TEST(VdbPaint, GivesBackPaletteNormalsAndBox) {
  const SourceModel model = read(painted());
  ASSERT_EQ(model.palette.size(), 3u);
  for (std::size_t e = 0; e < 3; ++e) {
    EXPECT_EQ(model.palette[e].base_color, kPalette[e].base_color);
    EXPECT_EQ(model.palette[e].emissive, kPalette[e].emissive);
    EXPECT_EQ(model.palette[e].metallic, kPalette[e].metallic);
    EXPECT_EQ(model.palette[e].roughness, kPalette[e].roughness);
  }
  EXPECT_TRUE(model.palette_blends);
  const VoxelGrid& part = *model.parts[0].grid;
  ASSERT_EQ(part.size, kHigh - kLow + 1);
  EXPECT_EQ(part.to_node * glm::vec4(0, 0, 0, 1), glm::vec3(kLow) - 0.5f);
  for (const SurfaceSample& sample : part.surface) {
    const int x = static_cast<int>(sample.index % static_cast<std::uint64_t>(part.size.x)) + kLow.x;
    EXPECT_EQ(sample.source, x > 0 ? 2u : 0u);
    EXPECT_EQ(encodeNormal(sample.normal), kNormal);
  }
}

// Painted over in another program, a palette that cannot be, and one without the voxels' indices.
TEST(VdbPaint, EditedGridsCount) {
  std::vector<VdbSpec> grids = painted();
  grids[1].value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    return p.x == 4 ? glm::dvec3(0, 0, 1)
                    : glm::dvec3(kPalette[static_cast<std::size_t>(entryOf(p))].base_color);
  };
  SourceModel model = read(grids);
  EXPECT_TRUE(model.palette.empty());
  std::size_t blue = 0;
  for (const SurfaceSample& sample : model.parts[0].grid->surface) {
    blue += sample.material.base_color == glm::vec4(0, 0, 1, 1) ? 1 : 0;
    EXPECT_EQ(sample.source, 0u);
  }
  EXPECT_EQ(blue, 5u);  // (4, 0, 0) and the four beside it

  grids = painted();
  grids[3].value = [](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    return p.y < 3 && p.y >= 0 && p.z == 0 ? std::optional(glm::dvec3(1.5)) : std::nullopt;
  };
  EXPECT_TRUE(read(grids).palette.empty());
  grids.pop_back();
  model = read(grids);
  EXPECT_TRUE(model.palette.empty());
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(9));

  // Other voxels were asked for.
  Settings coarser;
  coarser.resolution = 7;
  coarser.resolution_given = true;
  model = read(painted(), coarser);
  EXPECT_TRUE(model.palette.empty());
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(7));
}

// Of several parts each has its own grids beside it.
TEST(VdbPaint, PartsHaveTheirOwn) {
  std::vector<VdbSpec> grids = painted();
  for (std::size_t i = 1; i < grids.size(); ++i) grids[i].name = "ball." + grids[i].name;
  VdbSpec other = ball(), white = grid("other.Cd", "vec3s");
  other.name = "other";
  white.value = [](const glm::ivec3&) -> std::optional<glm::dvec3> { return glm::dvec3(1); };
  grids.insert(grids.begin(), {other, white});
  Settings settings;
  settings.grid = "ball";
  EXPECT_EQ(read(grids, settings).palette.size(), 3u);
  settings.grid = "other";
  const SourceModel model = read(grids, settings);
  EXPECT_TRUE(model.palette.empty());
  EXPECT_EQ(model.parts[0].grid->surface[0].material.base_color, glm::vec4(1));
}

}  // namespace
}  // namespace kelp::bake::test
