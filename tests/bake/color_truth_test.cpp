// SPDX-License-Identifier: MIT
// The colors of real textured models at 256 voxels against their textures, sampled anew at the nearest point
// of the mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>

#include "kelp/bake/bake.h"
#include "support/assets.h"
#include "truth.h"

namespace kelp {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

double linearOf(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

// Ottosson's matrices, as published.
dvec3 oklab(const dvec3& c) {
  const double l = std::cbrt(0.4122214708 * c.x + 0.5363325363 * c.y + 0.0514459929 * c.z);
  const double m = std::cbrt(0.2119034982 * c.x + 0.6806995451 * c.y + 0.1073969566 * c.z);
  const double s = std::cbrt(0.0883024619 * c.x + 0.2817188376 * c.y + 0.6299787005 * c.z);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

// The texel that a whole number of repeats leads to.
int wrapped(int i, int n, bake::Wrap wrap) {
  if (wrap == bake::Wrap::kClamp) return std::min(std::max(i, 0), n - 1);
  int turns = 0;
  for (; i < 0; i += n) ++turns;
  for (; i >= n; i -= n) ++turns;
  return wrap == bake::Wrap::kMirror && turns % 2 == 1 ? n - 1 - i : i;
}

// Bilinear, in linear light.
dvec3 sample(const bake::Image& image, dvec2 uv, const bake::SurfaceMaterial& material) {
  const dvec2 at = uv * dvec2(image.width, image.height) - (material.nearest ? 0.0 : 0.5);
  dvec3 sum(0);
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const dvec2 part = at - glm::floor(at);
      const double share = material.nearest ? (dx == 0 && dy == 0 ? 1 : 0)
                                            : (dx ? part.x : 1 - part.x) * (dy ? part.y : 1 - part.y);
      if (share == 0) continue;
      const int x = wrapped(static_cast<int>(std::floor(at.x)) + dx, image.width, material.wrap_u);
      const int y = wrapped(static_cast<int>(std::floor(at.y)) + dy, image.height, material.wrap_v);
      const std::uint8_t* texel =
          &image.rgba[4 * (static_cast<std::size_t>(x) +
                           static_cast<std::size_t>(image.width) * static_cast<std::size_t>(y))];
      for (int c = 0; c < 3; ++c) sum[c] += share * linearOf(texel[c] / 255.0);
    }
  }
  return sum;
}

dvec3 colorAt(const bake::SourceModel& model, const test::NearestPoint& at) {
  const bake::TriangleSoup& soup = model.parts[0].soup;
  const bake::SurfaceMaterial& material = model.materials[soup.triangles[at.triangle].material];
  dvec3 color(material.base_color);
  const auto mix = [&](const auto& corner) {
    return at.weights.x * dvec3(corner[0]) + at.weights.y * dvec3(corner[1]) +
           at.weights.z * dvec3(corner[2]);
  };
  if (!soup.colors.empty()) color *= mix(soup.colors[at.triangle]);
  if (material.texture >= 0 && !soup.uvs.empty()) {
    const auto& uv = soup.uvs[at.triangle];
    color *= sample(model.images[static_cast<std::size_t>(material.texture)],
                    at.weights.x * dvec2(uv[0]) + at.weights.y * dvec2(uv[1]) + at.weights.z * dvec2(uv[2]),
                    material);
  }
  return color;
}

struct TexturedFile {
  const char* name;
  const char* path;
};

void PrintTo(const TexturedFile& file, std::ostream* out) { *out << file.path; }

class ColorTruth : public testing::TestWithParam<TexturedFile> {};

TEST_P(ColorTruth, IsTheTextures) {
  KELP_ASSET(path, GetParam().path);
  const bake::SourceModel model = bake::importFile(path, {});
  const bake::TriangleSoup& soup = model.parts[0].soup;
  const bake::Frame frame = test::frameOf(soup, 256);
  const bake::VoxelizeResult result = bake::voxelize(model, model.parts[0], frame, bake::Fill::kAuto, 2, {});
  const bake::Palette palette = bake::choosePalette({&result.grid}, 2);

  const test::MeshTruth truth(soup, frame);
  // Where a texture is finer than the voxels, what lies at a voxel's middle and the mean over the voxel
  // differ by its detail: both must be near.
  const auto overVoxel = [&](const dvec3& center) {
    dvec3 sum(0);
    for (int k = 0; k < 27; ++k)
      sum += colorAt(model, truth.nearest(center + (dvec3(k % 3, k / 3 % 3, k / 9) - 1.0) / 3.0));
    return sum / 27.0;
  };
  double error = 0, mean_error = 0, light = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.grid.surface.size(); i += 29) {
    const std::uint64_t index = result.grid.surface[i].index;
    const dvec3 center(static_cast<double>(index % static_cast<std::uint64_t>(frame.size.x)) + 0.5,
                       static_cast<double>(index / static_cast<std::uint64_t>(frame.size.x) %
                                           static_cast<std::uint64_t>(frame.size.y)) +
                           0.5,
                       static_cast<double>(index / static_cast<std::uint64_t>(frame.size.x) /
                                           static_cast<std::uint64_t>(frame.size.y)) +
                           0.5);
    const dvec3 want = oklab(colorAt(model, truth.nearest(center))), mean = oklab(overVoxel(center));
    const dvec3 got = oklab(dvec3(palette.entries[palette.indices[0][i]].base_color));
    error += glm::distance(want, got);
    mean_error += glm::distance(mean, got);
    light += got.x - mean.x;
    ++count;
  }
  error /= static_cast<double>(count);
  mean_error /= static_cast<double>(count);
  light /= static_cast<double>(count);
  std::printf(
      "%s: %zu voxels, OKLab error %.4f at the nearest point, %.4f against the mean over the voxel, %+.4f in "
      "lightness; palette %.4f\n",
      GetParam().name, count, error, mean_error, light, palette.mean_error);
  EXPECT_LT(error, 0.02);
  EXPECT_LT(mean_error, 0.02);
  EXPECT_LT(std::abs(light), 0.01) << "too dark or too light in the mean";
}

INSTANTIATE_TEST_SUITE_P(
    Textured, ColorTruth,
    testing::Values(
        TexturedFile{"duck", "gltf/draco_testdata/Duck.glb"},
        TexturedFile{"fox", "gltf/draco_testdata/Fox/Fox.gltf"},
        TexturedFile{"truck", "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf"},
        TexturedFile{"box", "gltf/assimp/BoxTextured.glb"}, TexturedFile{"rocks", "gltf/aquarium/rocks.glb"},
        TexturedFile{"spider", "mesh/assimp/OBJ/spider.obj"}, TexturedFile{"fern", "gltf/plants/fern_02.glb"},
        TexturedFile{"barrel", "gltf/plants/barrel.glb"},
        TexturedFile{"sphere",
                     "gltf/draco_testdata/SphereTwoMaterials/sphere_two_materials_mesh_and_point_cloud.gltf"},
        TexturedFile{"wraps", "gltf/draco_testdata/TextureSettingsTest/TextureSettingsTest.gltf"},
        TexturedFile{"vertex_colors", "gltf/draco_testdata/VertexColorTest/VertexColorTest.gltf"}),
    [](const auto& file) { return std::string(file.param.name); });

}  // namespace
}  // namespace kelp
