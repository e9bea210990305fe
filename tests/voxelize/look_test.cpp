// SPDX-License-Identifier: MIT
// The look of a mesh at a point, against the formulas of glTF: factor x vertex color x texture.
#include "kelp/voxelize/surface/look.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kelp/common/error.h"
#include "shapes.h"

namespace kelp::bake {
namespace {

// One triangle in voxels, in a frame that leaves it where it is.
struct Sheet {
  SourceModel model;
  Topology mesh;
  TriangleSoup& soup() { return model.parts[0].soup; }
  void analyze(Fill fill = Fill::kSurface) {
    Frame frame;
    frame.size = glm::ivec3(16);
    frame.voxel_size = 1;
    mesh = bake::analyze(soup(), frame, fill);
  }
};
Sheet triangle() {
  TriangleSoup soup;
  test::addTriangle(soup, {1, 1, 4}, {9, 1, 4}, {1, 9, 4});
  Sheet sheet;
  sheet.model = test::makeModel(soup);
  return sheet;
}

// The nearest point with these weights of the soup's corners, on a triangle of the mesh.
Nearest at(const Topology& mesh, std::uint32_t triangle, glm::dvec3 weights) {
  if (mesh.triangles[triangle].swapped) std::swap(weights.y, weights.z);
  Nearest nearest;
  nearest.triangle = triangle;
  nearest.weights = weights;
  return nearest;
}

Image plain(glm::u8vec4 color) {
  Image image;
  image.width = image.height = 1;
  image.srgb = false;
  image.rgba = {color.r, color.g, color.b, color.a};
  return image;
}

TEST(Look, MultipliesFactorVertexColorAndTexture) {
  Sheet sheet = triangle();
  sheet.model.materials[0].base_color = {0.5f, 1, 1, 1};
  sheet.model.materials[0].texture = 0;
  sheet.model.images.push_back(plain({255, 51, 255, 255}));
  sheet.soup().uvs = {{glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1)}};
  sheet.soup().colors = {{glm::vec4(1, 0, 0, 1), glm::vec4(0, 1, 0, 1), glm::vec4(0, 0, 1, 1)}};
  sheet.analyze();
  for (const bool turned : {false, true}) {
    if (turned) sheet.mesh.triangles[0].turn();
    const SurfaceLook look(sheet.model, sheet.soup(), sheet.mesh);
    for (const glm::dvec3& w : {glm::dvec3(1, 0, 0), glm::dvec3(0.2, 0.3, 0.5), glm::dvec3(0, 0, 1)}) {
      const Material material = look.materialAt(at(sheet.mesh, 0, w));
      EXPECT_NEAR(material.base_color.r, 0.5 * w.x, 1e-6);
      EXPECT_NEAR(material.base_color.g, 0.2 * w.y, 1e-6);
      EXPECT_NEAR(material.base_color.b, w.z, 1e-6);
    }
  }
}

// A texture of many texels to a voxel is averaged: the same picture, laid 64 times over the triangle, shows
// its mean.
TEST(Look, AveragesTexturesThatAreFinerThanVoxels) {
  Sheet sheet = triangle();
  sheet.model.materials[0].texture = 0;
  Image checkers;
  checkers.width = checkers.height = 2;
  checkers.srgb = false;
  for (int i = 0; i < 4; ++i) {
    const std::uint8_t value = i == 1 || i == 2 ? 255 : 0;
    checkers.rgba.insert(checkers.rgba.end(), {value, value, value, 255});
  }
  sheet.model.images.push_back(checkers);
  sheet.soup().uvs = {{glm::vec2(0), glm::vec2(64, 0), glm::vec2(0, 64)}};
  sheet.analyze();
  const SurfaceLook fine(sheet.model, sheet.soup(), sheet.mesh);
  for (const double w : {0.1, 0.23, 0.41})
    EXPECT_NEAR(fine.materialAt(at(sheet.mesh, 0, {1 - w, w / 2, w / 2})).base_color.r, 0.5, 1e-3);
  // A picture as coarse as the voxels is not blurred: in the middle of a texel of 4 voxels it shows that.
  sheet.soup().uvs = {{glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1)}};
  const SurfaceLook coarse(sheet.model, sheet.soup(), sheet.mesh);
  EXPECT_NEAR(coarse.materialAt(at(sheet.mesh, 0, {0.5, 0.25, 0.25})).base_color.r, 0, 1e-3);
  EXPECT_NEAR(coarse.materialAt(at(sheet.mesh, 0, {0, 0.75, 0.25})).base_color.r, 1, 1e-3);
}

// glTF: green multiplies roughness, blue metal; the glow's picture multiplies its factor.
TEST(Look, TakesGlossAndGlowFromTheirOwnPictures) {
  Sheet sheet = triangle();
  SurfaceMaterial& material = sheet.model.materials[0];
  material.roughness = 0.5f;
  material.metallic = 0.8f;
  material.emissive = {2, 4, 6};
  material.metal_map.texture = 0;
  material.glow_map.texture = 1;
  material.glow_map.coordinates = 1;
  sheet.model.images = {plain({0, 51, 102, 255}), plain({255, 0, 51, 255})};
  sheet.soup().more_uvs[0] = {{glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1)}};
  sheet.analyze();
  const Material got =
      SurfaceLook(sheet.model, sheet.soup(), sheet.mesh).materialAt(at(sheet.mesh, 0, {1, 0, 0}));
  EXPECT_NEAR(got.roughness, 0.1, 1e-6);
  EXPECT_NEAR(got.metallic, 0.32, 1e-6);
  EXPECT_NEAR(got.emissive.x, 2, 1e-6);
  EXPECT_NEAR(got.emissive.y, 0, 1e-6);
  EXPECT_NEAR(got.emissive.z, 1.2, 1e-5);
}

TEST(Look, ColorsFromFilesStayWithinBounds) {
  Sheet sheet = triangle();
  sheet.soup().colors = {{glm::vec4(std::nanf("")), glm::vec4(-3, 7, 0.5f, 1), glm::vec4(1)}};
  sheet.analyze();
  const SurfaceLook look(sheet.model, sheet.soup(), sheet.mesh);
  EXPECT_EQ(look.materialAt(at(sheet.mesh, 0, {1, 0, 0})).base_color, glm::vec4(0));
  EXPECT_EQ(look.materialAt(at(sheet.mesh, 0, {0, 1, 0})).base_color.r, 0);
}

// Two sheets a third of a voxel apart: the nearer one is cut out, so the other one is seen.
TEST(Look, LooksThroughWhatIsCutOut) {
  TriangleSoup soup;
  test::addTriangle(soup, {1, 1, 4.4f}, {9, 1, 4.4f}, {1, 9, 4.4f});
  test::addTriangle(soup, {1, 1, 4.8f}, {9, 1, 4.8f}, {1, 9, 4.8f});
  soup.triangles[0].material = 1;
  Sheet sheet;
  sheet.model = test::makeModel(soup);
  sheet.model.materials.emplace_back();
  sheet.model.materials[1].alpha_cutoff = 0.5f;
  sheet.model.materials[1].base_color.a = 0.4f;
  sheet.analyze();
  const TriangleBvh bvh(sheet.mesh);
  {
    const SurfaceLook look(sheet.model, sheet.soup(), sheet.mesh);
    EXPECT_TRUE(look.cutsOut());
    const Nearest nearest = bvh.nearest({3.5, 3.5, 4.5});
    EXPECT_EQ(look.sourceAt(nearest), 1u);
    EXPECT_TRUE(look.isCutOut(nearest));
    const Nearest shown = look.nearestShown(bvh, {3.5, 3.5, 4.5});
    ASSERT_NE(shown.triangle, kCap);
    EXPECT_EQ(look.sourceAt(shown), 0u);
    EXPECT_FALSE(look.isCutOut(shown));
    // One voxel deeper no sheet passes.
    EXPECT_EQ(look.nearestShown(bvh, {3.5, 3.5, 5.5}).triangle, kCap);
  }
  sheet.model.materials[1].base_color.a = 0.6f;
  EXPECT_FALSE(SurfaceLook(sheet.model, sheet.soup(), sheet.mesh).isCutOut(bvh.nearest({3.5, 3.5, 4.5})));
  sheet.model.materials[1].base_color.a = 0.4f;
  sheet.mesh.components[sheet.mesh.triangles[0].component].solid = true;  // bodies are never cut
  const SurfaceLook solid(sheet.model, sheet.soup(), sheet.mesh);
  EXPECT_FALSE(solid.isCutOut(bvh.nearest({3.5, 3.5, 4.5})));
  EXPECT_EQ(solid.notices().size(), 1u);
}

TEST(Look, RefusesIndicesBeyondTheModel) {
  Sheet sheet = triangle();
  sheet.analyze();
  const auto make = [&] { SurfaceLook(sheet.model, sheet.soup(), sheet.mesh); };
  sheet.soup().triangles[0].material = 1;
  EXPECT_THROW(make(), ToolError);
  sheet.soup().triangles[0].material = 0;
  sheet.model.materials[0].glow_map.texture = 0;
  EXPECT_THROW(make(), ToolError);
  sheet.model.images.push_back(plain({0, 0, 0, 255}));
  EXPECT_NO_THROW(make());
  sheet.model.materials[0].glow_map.coordinates = 3;
  EXPECT_THROW(make(), ToolError);
}

}  // namespace
}  // namespace kelp::bake
