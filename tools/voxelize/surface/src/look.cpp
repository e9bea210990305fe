// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/look.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

// Half a voxel's side, and the rounding of a point that lies on its face.
constexpr double kHalfSide = 0.5 + kLatticeStep;
constexpr double kHalfDiagonal = 1.7320508 * kHalfSide;
// Side of what a voxel's color is averaged over, as log2 of voxels. All of a voxel (0) blurs pictures that
// are finer than the voxels; less than this is further from the voxel's mean than what it gains at its middle
// (the spider: 0.027 and 0.014 off in OKLab, here 0.019 and 0.015).
constexpr float kLook = -1.2f;
constexpr float kWhole = 0.0f;  // for coverage

}  // namespace

SurfaceLook::SurfaceLook(const SourceModel& model, const TriangleSoup& soup, const Topology& mesh)
    : model_(model), soup_(soup), mesh_(mesh), textures_(model.images.size()) {
  for (const TriangleSoup::Triangle& triangle : soup.triangles) {
    if (triangle.material >= model.materials.size())
      throw ToolError(Exit::kInvalid, fmt::format("a triangle uses material {} of {}; export the model again",
                                                  triangle.material, model.materials.size()));
    const SurfaceMaterial& material = model.materials[triangle.material];
    for (const SurfaceMap& map :
         {SurfaceMap{soup.uvs.empty() ? -1 : material.texture}, material.glow_map, material.metal_map}) {
      if (map.texture < 0) continue;
      const std::size_t index = static_cast<std::size_t>(map.texture);
      if (index >= textures_.size())
        throw ToolError(Exit::kInvalid,
                        fmt::format("material '{}' uses image {} of {}; export the model again",
                                    material.name, index, textures_.size()));
      if (map.coordinates < 0 || static_cast<std::size_t>(map.coordinates) > soup.more_uvs.size())
        throw ToolError(Exit::kInvalid,
                        fmt::format("material '{}' uses texture coordinates {} of {}; export the model again",
                                    material.name, map.coordinates, soup.more_uvs.size() + 1));
      if (!textures_[index]) textures_[index].emplace(model.images[index]);
    }
  }
  cuts_out_ = anyCutOut();
}

bool SurfaceLook::anyCutOut() const {
  return std::any_of(mesh_.triangles.begin(), mesh_.triangles.end(), [&](const SolidTriangle& t) {
    return t.source != kCap && !mesh_.components[t.component].solid && materialOf(t).alpha_cutoff > 0;
  });
}

void SurfaceLook::openCutOuts(Topology& mesh) {
  const std::vector<double> cut = cutAreas();
  for (std::size_t i = 0; i < cut.size(); ++i) mesh.components[i].cut_area = cut[i];
  kelp::bake::openCutOuts(mesh);
  cuts_out_ = anyCutOut();
}

std::vector<double> SurfaceLook::cutAreas() const {
  constexpr double kMostSteps = 32;  // along a side; a large triangle's picture is known well enough by then
  std::vector<double> areas(mesh_.components.size(), 0);
  for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
    const SolidTriangle& solid = mesh_.triangles[i];
    if (solid.source == kCap || !(materialOf(solid).alpha_cutoff > 0)) continue;
    const double area = glm::length(mesh_.areaVector(solid));
    // The middles of steps^2 equal triangles.
    const int steps = static_cast<int>(std::clamp(std::ceil(std::sqrt(2 * area)), 1.0, kMostSteps));
    int cut = 0;
    for (int row = 0; row < steps; ++row)
      for (int k = 0; k < 2 * row + 1; ++k) {
        // Upright ones and, between them, those that stand on their heads.
        const double third = k % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        Nearest at;
        at.triangle = i;
        at.weights.x = 1 - (row + (k % 2 == 0 ? 2.0 / 3 : 1.0 / 3)) / steps;
        at.weights.y = (k / 2 + third) / steps;
        at.weights.z = 1 - at.weights.x - at.weights.y;
        if (colorAt(at, kWhole).a < materialOf(solid).alpha_cutoff) ++cut;
      }
    areas[solid.component] += area * cut / (static_cast<double>(steps) * steps);
  }
  return areas;
}

Material SurfaceLook::materialAt(const Nearest& nearest) const {
  const SurfaceMaterial& source = materialOf(mesh_.triangles[nearest.triangle]);
  Material material;
  material.base_color = colorAt(nearest, kLook);
  if (source.alpha_cutoff > 0) material.base_color.a = 1;
  material.emissive = source.emissive;
  material.metallic = source.metallic;
  material.roughness = source.roughness;
  if (source.glow_map.texture >= 0) material.emissive *= glm::vec3(mapAt(nearest, source.glow_map, kLook));
  if (source.metal_map.texture >= 0) {
    const glm::vec4 texel = mapAt(nearest, source.metal_map, kLook);
    material.roughness *= texel.g;
    material.metallic *= texel.b;
  }
  return material;
}

bool SurfaceLook::isCutOut(const Nearest& nearest) const {
  if (!cuts_out_) return false;
  const SolidTriangle& solid = mesh_.triangles[nearest.triangle];
  if (solid.source == kCap || mesh_.components[solid.component].solid) return false;
  const float cutoff = materialOf(solid).alpha_cutoff;
  return cutoff > 0 && colorAt(nearest, kWhole).a < cutoff;
}

Nearest SurfaceLook::nearestShown(const TriangleBvh& bvh, const glm::dvec3& center) const {
  return bvh.nearest(center, kHalfDiagonal, [&](std::uint32_t i) {
    const SolidTriangle& solid = mesh_.triangles[i];
    if (solid.source == kCap) return false;
    Nearest at;
    at.triangle = i;
    at.point = nearestOnTriangle(center, mesh_.position(solid.vertex[0]), mesh_.position(solid.vertex[1]),
                                 mesh_.position(solid.vertex[2]), at.weights);
    const glm::dvec3 away = glm::abs(at.point - center);
    return std::max({away.x, away.y, away.z}) <= kHalfSide && !isCutOut(at);
  });
}

std::vector<std::string> SurfaceLook::notices() const {
  std::vector<std::uint32_t> ignored;  // materials
  std::vector<bool> is_ignored(model_.materials.size());
  for (const SolidTriangle& t : mesh_.triangles) {
    if (t.source == kCap || !mesh_.components[t.component].solid || materialOf(t).alpha_cutoff <= 0) continue;
    const std::uint32_t material = soup_.triangles[t.source].material;
    if (is_ignored[material]) continue;
    is_ignored[material] = true;
    ignored.push_back(material);
  }
  std::vector<std::string> lines;
  lines.reserve(ignored.size());
  for (const std::uint32_t material : ignored)
    lines.push_back(fmt::format(
        "material '{}' has cut-outs, which solid bodies are baked without; --fill surface cuts them out",
        model_.materials[material].name));
  return lines;
}

// Base color, vertex color and texture multiplied; each channel 0 to 1.
glm::vec4 SurfaceLook::colorAt(const Nearest& nearest, float footprint) const {
  const SolidTriangle& solid = mesh_.triangles[nearest.triangle];
  const SurfaceMaterial& source = materialOf(solid);
  glm::vec4 color = source.base_color;
  const std::array<float, 3> weights = cornerWeights(nearest);
  if (!soup_.colors.empty()) {
    const auto& c = soup_.colors[solid.source];
    // One color stays that color: rounding would make many of it.
    color *= c[0] == c[1] && c[1] == c[2] ? c[0] : c[0] * weights[0] + c[1] * weights[1] + c[2] * weights[2];
  }
  if (source.texture >= 0 && !soup_.uvs.empty())
    color *= mapAt(nearest, {source.texture, source.wrap_u, source.wrap_v, source.nearest}, footprint);
  for (int i = 0; i < 4; ++i) color[i] = color[i] > 0 ? std::min(color[i], 1.0f) : 0.0f;  // NaN too
  return color;
}

// A picture's texel, averaged over a footprint (as kLook). Parts without the coordinates have its corner
// everywhere.
glm::vec4 SurfaceLook::mapAt(const Nearest& nearest, const SurfaceMap& map, float footprint) const {
  const SolidTriangle& solid = mesh_.triangles[nearest.triangle];
  const auto& uvs =
      map.coordinates == 0 ? soup_.uvs : soup_.more_uvs[static_cast<std::size_t>(map.coordinates - 1)];
  const std::array<glm::vec2, 3> uv = uvs.empty() ? std::array<glm::vec2, 3>{} : uvs[solid.source];
  const std::array<float, 3> weights = cornerWeights(nearest);
  return textures_[static_cast<std::size_t>(map.texture)]->sample(
      uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2],
      texelsPerVoxel(solid, uv, map.texture) + footprint, map.wrap_u, map.wrap_v, map.nearest);
}

// Weights for the soup's corners: winding may have swapped two of the mesh's.
std::array<float, 3> SurfaceLook::cornerWeights(const Nearest& nearest) const {
  const glm::vec3 w(nearest.weights);
  return mesh_.triangles[nearest.triangle].swapped ? std::array<float, 3>{w.x, w.z, w.y}
                                                   : std::array<float, 3>{w.x, w.y, w.z};
}

// log2 of how many texels of the texture a voxel's side covers on this triangle.
float SurfaceLook::texelsPerVoxel(const SolidTriangle& solid, const std::array<glm::vec2, 3>& uv,
                                  int texture) const {
  const Image& image = model_.images[static_cast<std::size_t>(texture)];
  const glm::vec2 side1 = uv[1] - uv[0], side2 = uv[2] - uv[0];
  const double texels =
      std::abs(static_cast<double>(side1.x) * side2.y - static_cast<double>(side1.y) * side2.x) *
      image.width * image.height;
  const glm::dvec3 a = mesh_.position(solid.vertex[0]);
  const double voxels =
      glm::length(glm::cross(mesh_.position(solid.vertex[1]) - a, mesh_.position(solid.vertex[2]) - a));
  return texels > voxels && voxels > 0 ? static_cast<float>(0.5 * std::log2(texels / voxels)) : 0.0f;
}

}  // namespace kelp::bake
