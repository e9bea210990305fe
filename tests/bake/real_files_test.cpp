// SPDX-License-Identifier: MIT
// Real files, baked at 256 voxels, against a picture of their own triangles: silhouette and color, at rest
// and bent.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <ostream>
#include <span>
#include <string>
#include <utility>

#include "kelp/bake/bake.h"
#include "kelp/runtime/instance.h"
#include "level_set_mesh.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "support/rasterizer.h"
#include "support/test_pack.h"
#include "support/voxel_knots.h"

namespace kelp {
namespace {

using glm::dmat4;
using glm::dvec2;
using glm::dvec3;

// Under a sanitizer, where a voxel takes ten times as long, an eighth of the voxels. What is off lies along
// the outline, and is a share of it as large as a voxel.
constexpr int kSide = test::kSanitized ? 128 : 256;
constexpr double kLeastIou = 1 - 0.05 * 256 / kSide;

dmat4 asMatrix(const glm::mat4x3& m) {
  dmat4 out(1);
  for (int c = 0; c < 4; ++c) out[c] = glm::dvec4(dvec3(m[c]), c == 3 ? 1.0 : 0.0);
  return out;
}

double linearOf(std::uint8_t srgb) {
  const double c = srgb / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double wrapped(double u, bake::Wrap wrap) {
  switch (wrap) {
    case bake::Wrap::kClamp:
      return std::clamp(u, 0.0, 1.0);
    case bake::Wrap::kMirror:
      return 1.0 - std::abs(1.0 - (u - 2.0 * std::floor(0.5 * u)));
    case bake::Wrap::kRepeat:
      break;
  }
  return u - std::floor(u);
}

// Base color at a point of a triangle: nearest texel, no filter.
dvec3 colorAt(const bake::SourceModel& model, const bake::TriangleSoup& soup, std::size_t triangle, double u,
              double v) {
  const bake::SurfaceMaterial& material = model.materials[soup.triangles[triangle].material];
  const auto mix = [&](const auto& corners) {
    return (1.0 - u - v) * dvec3(corners[0]) + u * dvec3(corners[1]) + v * dvec3(corners[2]);
  };
  dvec3 color = dvec3(material.base_color);
  if (!soup.colors.empty()) color *= mix(soup.colors[triangle]);
  if (material.texture >= 0 && !soup.uvs.empty()) {
    const auto& uv = soup.uvs[triangle];
    const dvec2 at = (1.0 - u - v) * dvec2(uv[0]) + u * dvec2(uv[1]) + v * dvec2(uv[2]);
    const bake::Image& image = model.images[static_cast<std::size_t>(material.texture)];
    const int x = std::min(static_cast<int>(wrapped(at.x, material.wrap_u) * image.width), image.width - 1);
    const int y = std::min(static_cast<int>(wrapped(at.y, material.wrap_v) * image.height), image.height - 1);
    const std::uint8_t* texel =
        &image.rgba[4 * (static_cast<std::size_t>(x) +
                         static_cast<std::size_t>(image.width) * static_cast<std::size_t>(y))];
    color *= dvec3(linearOf(texel[0]), linearOf(texel[1]), linearOf(texel[2]));
  }
  return color;
}

// The paper's map, forwards, in double precision: a point of the undeformed volume to where the spline takes
// it.
class ForwardMap {
 public:
  ForwardMap(const Knot& k0, const Knot& k1, double height)
      : p0_(k0.position), p1_(k1.position), m0_(k0.tangent), m1_(k1.tangent), height_(height) {}
  dvec3 operator()(const dvec3& rest) const {
    const double y = p0_.y + rest.y / height_ * (p1_.y - p0_.y);
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) (at(0.5 * (low + high)).y < y ? low : high) = 0.5 * (low + high);
    const dvec3 s = at(low);
    return {rest.x + s.x, y, rest.z + s.z};
  }

 private:
  dvec3 at(double t) const {
    const double a = t * t * (3 - 2 * t), b = t * (1 - t) * (1 - t), c = t * t * (t - 1);
    return (1 - a) * p0_ + a * p1_ + b * m0_ + c * m1_;
  }
  dvec3 p0_, p1_, m0_, m1_;
  double height_;
};

struct Comparison {
  double iou = 0;
  // mean absolute difference per channel, linear, where both pictures are well inside the silhouette
  double color_error = 0;
};

class Baked {
 public:
  explicit Baked(const std::filesystem::path& path) {
    bake::Settings settings;
    settings.resolution = kSide;
    settings.resolution_given = true;
    if (path.stem() == "Fox") settings.rig_preset = "none";  // one part, which a spline bends
    bake::Report report;
    pack_ = bake::bake(path, settings, report);
    if (path.extension() == ".vdb") {
      model_.materials.resize(1);
      model_.materials[0].base_color = pack_.palette[0].base_color;
      model_.parts.resize(1);
      model_.parts[0].soup = test::levelSetMesh(path);
    } else {
      model_ = bake::importFile(path, settings);
    }
    bytes_ = test::bytesOf(pack_);
    source_.emplace(bytes_);
    auto opened = runtime::Asset::open(source_->source());
    EXPECT_TRUE(opened);
    asset_ = *std::move(opened);
    EXPECT_TRUE(asset_->loadAll());
  }

  // Longest side, in voxels, of the largest part.
  int longestSide() const {
    int longest = 0;
    for (const RawPart& part : pack_.parts)
      longest = std::max({longest, part.size.x, part.size.y, part.size.z});
    return longest;
  }

  // A picture of the voxels beside a picture of the triangles, both bent by tangents in units of the height
  // (zero knots: at rest).
  Comparison compare(double yaw, double pitch, const test::FigurePose* figure, int side = 240) const {
    runtime::Pose pose = *runtime::Pose::create(*asset_);
    for (int i = 0; figure && i < pose.parts(); ++i) {
      (void)pose.setKnots(i, test::figureKnots(*figure));
    }
    const runtime::Instance instance{asset_.get(), &pose};
    const Box box = runtime::bounds(instance);
    const auto camera = test::OrthographicCamera::around(dvec3(box.min), dvec3(box.max), yaw, pitch, side);
    const double back = 2.0 * camera.depthRange(dvec3(box.min), dvec3(box.max));

    test::Rasterizer triangles(camera);
    std::vector<std::pair<std::size_t, std::size_t>> origin;  // part, triangle
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const bake::SourcePart& part = model_.parts[p];
      const dmat4 to_object = asMatrix(pack_.parts[p].to_object);
      const dmat4 to_voxel = glm::inverse(to_object) * asMatrix(part.to_object);
      const std::vector<Knot> knots =
          test::inVoxels(pose.knots(static_cast<int>(p)), static_cast<float>(pack_.parts[p].size.y));
      const ForwardMap map(knots.front(), knots.back(), pack_.parts[p].size.y);
      for (std::size_t t = 0; t < part.soup.triangles.size(); ++t) {
        std::array<dvec3, 3> rest;
        for (std::size_t c = 0; c < 3; ++c)
          rest[c] =
              dvec3(to_voxel * glm::dvec4(dvec3(part.soup.positions[part.soup.triangles[t].vertex[c]]), 1.0));
        const auto number = static_cast<std::uint32_t>(origin.size());
        origin.emplace_back(p, t);
        drawBent(triangles, number, rest, {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)}, figure ? &map : nullptr,
                 to_object, 0);
      }
    }

    int both = 0, either = 0, colored = 0;
    double error = 0;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const dvec3 from = camera.pixelOrigin(x, y, back);
        const auto hit = runtime::raycast(instance, {glm::vec3(from), glm::vec3(camera.forward)});
        const auto& seen = triangles.at(x, y);
        either += hit || seen.hit();
        if (!hit || !seen.hit()) continue;
        ++both;
        // Colors are compared where both pictures show the same place: within two voxels in depth.
        if (std::abs((double{hit->t} - back) - seen.depth) > 2.5 * voxelSize()) continue;
        const auto [part, triangle] = origin[seen.triangle];
        const dvec3 expected = colorAt(model_, model_.parts[part].soup, triangle, seen.u, seen.v);
        const dvec3 got = dvec3(asset_->pack().palette()[hit->material].base_color);
        const dvec3 d = glm::abs(expected - got);
        error += (d.x + d.y + d.z) / 3;
        ++colored;
      }
    }
    EXPECT_GT(colored, both / 3) << "the surfaces are not where the triangles are";
    return {static_cast<double>(both) / either, error / std::max(colored, 1)};
  }

 private:
  double voxelSize() const { return static_cast<double>(glm::length(pack_.parts[0].to_object[0])); }

  // Large triangles are split until they follow the bend.
  void drawBent(test::Rasterizer& to, std::uint32_t number, const std::array<dvec3, 3>& rest,
                const std::array<dvec2, 3>& weight, const ForwardMap* map, const dmat4& to_object,
                int depth) const {
    if (map && depth < 14) {
      std::size_t longest = 0;
      double length = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double l = std::abs(rest[i].y - rest[(i + 1) % 3].y);
        if (l > length) {
          length = l;
          longest = i;
        }
      }
      if (length > 1.5) {
        const std::size_t i = longest, j = (longest + 1) % 3, k = (longest + 2) % 3;
        const dvec3 middle = 0.5 * (rest[i] + rest[j]);
        const dvec2 w = 0.5 * (weight[i] + weight[j]);
        drawBent(to, number, {rest[i], middle, rest[k]}, {weight[i], w, weight[k]}, map, to_object,
                 depth + 1);
        drawBent(to, number, {middle, rest[j], rest[k]}, {w, weight[j], weight[k]}, map, to_object,
                 depth + 1);
        return;
      }
    }
    std::array<dvec3, 3> world;
    for (std::size_t c = 0; c < 3; ++c)
      world[c] = dvec3(to_object * glm::dvec4(map ? (*map)(rest[c]) : rest[c], 1.0));
    to.draw(number, world[0], world[1], world[2], weight[0], weight[1], weight[2]);
  }

  RawPack pack_;
  bake::SourceModel model_;
  std::vector<std::byte> bytes_;
  std::optional<MemorySource> source_;
  std::unique_ptr<runtime::Asset> asset_;
};

struct RealFile {
  const char* name;
  const char* path;
  // allowed mean, linear: what a nearest texel differs from one filtered over a voxel (a flipped texture is
  // off by 0.08 and more)
  double color_error;
};

void PrintTo(const RealFile& file, std::ostream* out) { *out << file.path; }

class RealFiles : public testing::TestWithParam<RealFile> {};

TEST_P(RealFiles, LookLikeTheirTriangles) {
  KELP_ASSET(path, GetParam().path);
  const Baked baked(path);
  EXPECT_NEAR(baked.longestSide(), kSide, 1);
  constexpr std::pair<double, double> kViews[] = {{35, 20}, {0, 0}, {120, -25}, {90, 60}};
  for (const auto& [yaw, pitch] : std::span(kViews).first(test::shareOf(4))) {
    const Comparison rest = baked.compare(yaw, pitch, nullptr);
    std::printf("%s yaw %g pitch %g: IoU %.4f, color %.4f\n", GetParam().name, yaw, pitch, rest.iou,
                rest.color_error);
    EXPECT_GE(rest.iou, kLeastIou) << "yaw " << yaw << " pitch " << pitch;
    EXPECT_LE(rest.color_error, GetParam().color_error) << "yaw " << yaw << " pitch " << pitch;
  }
  constexpr std::size_t kFigures[] = {1, 2};
  for (const std::size_t figure : std::span(kFigures).first(test::shareOf(2))) {
    const Comparison bent = baked.compare(35, 20, &test::kFigure6[figure]);
    std::printf("%s %s: IoU %.4f, color %.4f\n", GetParam().name, test::kFigure6[figure].name, bent.iou,
                bent.color_error);
    EXPECT_GE(bent.iou, kLeastIou) << test::kFigure6[figure].name;
    EXPECT_LE(bent.color_error, GetParam().color_error) << test::kFigure6[figure].name;
  }
}

INSTANTIATE_TEST_SUITE_P(At256, RealFiles,
                         testing::Values(RealFile{"Duck", "gltf/draco_testdata/Duck.glb", 0.02},
                                         RealFile{"Fox", "gltf/draco_testdata/Fox/Fox.gltf", 0.03},
                                         RealFile{"CesiumMilkTruck",
                                                  "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf",
                                                  0.04},
                                         RealFile{"Box_Draco", "gltf/draco_testdata/Box_Draco.glb", 0.01},
                                         RealFile{"bunny_draco", "gltf/pmndrs/bunny.glb", 0.01},
                                         RealFile{"spot", "mesh/common3d/spot.obj", 0.01},
                                         RealFile{"stanford_bunny", "mesh/common3d/stanford-bunny.obj", 0.01},
                                         RealFile{"dragon", "mesh/stanford/dragon_vrip_res3.ply", 0.01},
                                         RealFile{"vdb_sphere", "vdb/gaffer_sphere.vdb", 0.01}),
                         [](const auto& file) { return std::string(file.param.name); });

}  // namespace
}  // namespace kelp
