// SPDX-License-Identifier: MIT
#include "surface_samples.h"

#include <cmath>
#include <limits>

#include "fill_thin.h"
#include "parallel.h"

namespace kelp::bake {
namespace {

constexpr std::size_t kGrain = 2048;
// Nearer than this the direction to the nearest point is rounding; the triangle's own normal is not.
constexpr double kTooNear = 0.02;

class Sampler {
 public:
  Sampler(const SurfaceLook& look, const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels, const glm::ivec3& size)
      : look_(look), mesh_(mesh), bvh_(bvh), voxels_(voxels), size_(size) {}

  SurfaceSample sample(std::uint64_t index) const {
    const std::uint64_t x = static_cast<std::uint64_t>(size_.x), y = static_cast<std::uint64_t>(size_.y);
    const glm::ivec3 voxel(static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / (x * y)));
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const glm::dvec3 open = openSide(voxel);

    Nearest nearest = bvh_.nearest(centre);
    if (look_.isCutOut(nearest)) {
      const Nearest shown = look_.nearestShown(bvh_, centre);
      if (shown.triangle != kCap) nearest = shown;
    }
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
    sample.material = look_.materialAt(nearest);
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

  const SurfaceLook& look_;
  const Topology& mesh_;
  const TriangleBvh& bvh_;
  const std::vector<std::uint8_t>& voxels_;
  glm::ivec3 size_;
};

}  // namespace

std::vector<SurfaceSample> sampleSurface(const SurfaceLook& look, const Topology& mesh, const TriangleBvh& bvh, const std::vector<std::uint8_t>& voxels,
                                         const glm::ivec3& size, const std::vector<std::uint64_t>& surface, int threads) {
  const Sampler sampler(look, mesh, bvh, voxels, size);
  std::vector<SurfaceSample> samples(surface.size());
  parallelRanges(surface.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) samples[i] = sampler.sample(surface[i]);
  });
  return samples;
}

}  // namespace kelp::bake
