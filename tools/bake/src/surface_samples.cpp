// SPDX-License-Identifier: MIT
#include "surface_samples.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "fill_thin.h"
#include "parallel.h"
#include "surface_texture.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kGrain = 2048;
// Nearer than this the direction to the nearest point is rounding; the triangle's own normal is not.
constexpr double kTooNear = 0.02;

class Sampler {
 public:
  Sampler(const SourceModel& model, const TriangleSoup& soup, const Topology& mesh, const TriangleBvh& bvh,
          const std::vector<std::uint8_t>& voxels, const glm::ivec3& size)
      : model_(model), soup_(soup), mesh_(mesh), bvh_(bvh), voxels_(voxels), size_(size), textures_(model.images.size()) {
    for (const TriangleSoup::Triangle& triangle : soup.triangles) {
      if (triangle.material >= model.materials.size()) throw BakeError(Exit::kInvalid, fmt::format("a triangle uses material {} of {}; export the model again", triangle.material, model.materials.size()));
      const int texture = model.materials[triangle.material].texture;
      if (texture < 0 || soup.uvs.empty()) continue;
      if (static_cast<std::size_t>(texture) >= textures_.size()) throw BakeError(Exit::kInvalid, fmt::format("material '{}' uses image {} of {}; export the model again", model.materials[triangle.material].name, texture, textures_.size()));
      std::optional<TexturePyramid>& pyramid = textures_[static_cast<std::size_t>(texture)];
      if (!pyramid) pyramid.emplace(model.images[static_cast<std::size_t>(texture)]);
    }
  }

  SurfaceSample sample(std::uint64_t index) const {
    const std::uint64_t x = static_cast<std::uint64_t>(size_.x), y = static_cast<std::uint64_t>(size_.y);
    const glm::ivec3 voxel(static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y)));
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const glm::dvec3 open = openSide(voxel);

    Nearest nearest = bvh_.nearest(centre);
    glm::dvec3 normal = outward(nearest, centre, index, open);
    if (glm::dot(normal, open) < -0.1 * glm::length(open)) {
      // The nearest triangle is hidden inside another body: look for one that faces the open.
      const Nearest facing = bvh_.nearest(centre, 3.0, [&](std::uint32_t i) { return mesh_.components[mesh_.triangles[i].component].solid && glm::dot(faceNormal(i), open) > 0; });
      if (facing.triangle != kCap) {
        nearest = facing;
        normal = faceNormal(facing.triangle);
      } else {
        normal = glm::normalize(open);
      }
    }
    if (mesh_.triangles[nearest.triangle].source == kCap) {
      nearest = bvh_.nearest(centre, std::numeric_limits<double>::infinity(), [&](std::uint32_t i) { return mesh_.triangles[i].source != kCap; });
    }

    SurfaceSample sample;
    sample.index = index;
    sample.normal = glm::vec3(normal);
    sample.material = materialAt(nearest);
    return sample;
  }

 private:
  glm::dvec3 faceNormal(std::uint32_t triangle) const {
    const auto& v = mesh_.triangles[triangle].vertex;
    const glm::dvec3 a = mesh_.position(v[0]);
    const glm::dvec3 n = glm::cross(mesh_.position(v[1]) - a, mesh_.position(v[2]) - a);
    const double length = glm::length(n);
    return length > 0 ? n / length : glm::dvec3(0);
  }

  // Sum of the directions to the empty voxels around.
  glm::dvec3 openSide(const glm::ivec3& voxel) const {
    const std::uint32_t mask = neighbourMask(voxels_, size_, voxel);
    glm::dvec3 sum(0);
    for (int cell = 0; cell < 27; ++cell) {
      if (!(mask & (1u << cell))) sum += glm::dvec3(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1);
    }
    return sum;
  }

  glm::dvec3 outward(const Nearest& nearest, const glm::dvec3& centre, std::uint64_t index, const glm::dvec3& open) const {
    glm::dvec3 normal = faceNormal(nearest.triangle);
    if (!mesh_.components[mesh_.triangles[nearest.triangle].component].solid) {
      // A sheet has no inside. One voxel thick, it is open on both sides alike: then its own winding decides.
      if (glm::dot(normal, open) < -0.5) normal = -normal;
    } else if (const double distance = std::sqrt(nearest.squared); distance > kTooNear) {
      normal = (voxels_[index] == kInside ? nearest.point - centre : centre - nearest.point) / distance;
    }
    if (normal == glm::dvec3(0)) normal = open;
    const double length = glm::length(normal);
    return length > 0 ? normal / length : glm::dvec3(0, 1, 0);
  }

  Material materialAt(const Nearest& nearest) const {
    const SolidTriangle& solid = mesh_.triangles[nearest.triangle];
    const TriangleSoup::Triangle& triangle = soup_.triangles[solid.source];
    const SurfaceMaterial& source = model_.materials[triangle.material];
    Material material;
    material.base_color = source.base_color;
    material.emissive = source.emissive;
    material.metallic = source.metallic;
    material.roughness = source.roughness;
    const std::array<float, 3> weights = cornerWeights(nearest);
    if (!soup_.colors.empty()) {
      const auto& c = soup_.colors[solid.source];
      material.base_color *= c[0] * weights[0] + c[1] * weights[1] + c[2] * weights[2];
    }
    if (source.texture >= 0 && !soup_.uvs.empty()) {
      const auto& uv = soup_.uvs[solid.source];
      const TexturePyramid& texture = *textures_[static_cast<std::size_t>(source.texture)];
      material.base_color *= texture.sample(uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2], texelsPerVoxel(solid, uv, source.texture), source.wrap_u, source.wrap_v, source.nearest);
    }
    for (int i = 0; i < 4; ++i) material.base_color[i] = material.base_color[i] > 0 ? std::min(material.base_color[i], 1.0f) : 0.0f;  // NaN too
    return material;
  }

  // Weights for the soup's corners: winding may have swapped two of the mesh's.
  std::array<float, 3> cornerWeights(const Nearest& nearest) const {
    const glm::vec3 w(nearest.weights);
    return mesh_.triangles[nearest.triangle].swapped ? std::array<float, 3>{w.x, w.z, w.y} : std::array<float, 3>{w.x, w.y, w.z};
  }

  // log2 of how many texels of the texture a voxel's side covers on this triangle.
  float texelsPerVoxel(const SolidTriangle& solid, const std::array<glm::vec2, 3>& uv, int texture) const {
    const Image& image = model_.images[static_cast<std::size_t>(texture)];
    const glm::vec2 side1 = uv[1] - uv[0], side2 = uv[2] - uv[0];
    const double texels = std::abs(static_cast<double>(side1.x) * side2.y - static_cast<double>(side1.y) * side2.x) * image.width * image.height;
    const glm::dvec3 a = mesh_.position(solid.vertex[0]);
    const double voxels = glm::length(glm::cross(mesh_.position(solid.vertex[1]) - a, mesh_.position(solid.vertex[2]) - a));
    return texels > voxels && voxels > 0 ? static_cast<float>(0.5 * std::log2(texels / voxels)) : 0.0f;
  }

  const SourceModel& model_;
  const TriangleSoup& soup_;
  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint8_t>& voxels_;
  glm::ivec3 size_;
  std::vector<std::optional<TexturePyramid>> textures_;
};

}  // namespace

std::vector<SurfaceSample> sampleSurface(const SourceModel& model, const TriangleSoup& soup, const Topology& mesh, const TriangleBvh& bvh,
                                         const std::vector<std::uint8_t>& voxels, const glm::ivec3& size, const std::vector<std::uint64_t>& surface, int threads) {
  const Sampler sampler(model, soup, mesh, bvh, voxels, size);
  std::vector<SurfaceSample> samples(surface.size());
  parallelRanges(surface.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) samples[i] = sampler.sample(surface[i]);
  });
  return samples;
}

}  // namespace kelp::bake
