// SPDX-License-Identifier: MIT
#include "memory_estimate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"

namespace kelp::bake {

PartSize partSize(const SourcePart& part, const Frame& frame) {
  if (part.grid) {
    const auto solid = std::count_if(part.grid->solid.begin(), part.grid->solid.end(), [](std::uint8_t voxel) { return voxel != 0; });
    return {part.grid->size, 0, static_cast<double>(part.grid->surface.size()), static_cast<double>(solid)};
  }
  PartSize result{frame.size, part.soup.triangles.size()};
  // Seen along an axis, a triangle covers as many voxels as its projection has area; the three together are about the voxels it makes surface. Volume by
  // the divergence theorem, about the middle of the box: right for closed meshes, and something between for open ones.
  const glm::dmat3 turn(frame.node_to_voxel);
  const glm::dvec3 origin = glm::dvec3(frame.node_to_voxel[3]) - 0.5 * glm::dvec3(frame.size);
  double volume = 0;
  for (const auto& triangle : part.soup.triangles) {
    glm::dvec3 corner[3];
    for (std::size_t i = 0; i < 3; ++i) corner[i] = turn * glm::dvec3(part.soup.positions[triangle.vertex[i]]) + origin;
    const glm::dvec3 area = 0.5 * glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    result.surface_voxels += std::abs(area.x) + std::abs(area.y) + std::abs(area.z);
    volume += glm::dot(corner[0], area) / 3;
  }
  const double voxels = static_cast<double>(frame.size.x) * frame.size.y * frame.size.z;
  result.surface_voxels = std::min(result.surface_voxels, voxels);
  result.solid_voxels = std::min(std::abs(volume) + 0.5 * result.surface_voxels, voxels);
  return result;
}

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes, double scale) {
  // Measured on the bunny, the dragon, the armadillo, spot and the teapot at 256 to 2048 (--report, peak_bytes). A triangle with its welded copy, edges and
  // hierarchy; what a surface voxel costs beside its sample while voxels are found (OpenVDB's tree, lists) and while levels are built.
  constexpr double kTriangle = 330, kTriangleKept = 100, kFinding = 145, kLeveling = 165;
  // Reductions of images hold a third as many texels, each four times as large.
  constexpr double kProgram = 40e6;
  double kept = kProgram + static_cast<double>(image_bytes) * (1 + 4.0 / 3), peak = 0;
  for (const PartSize& part : parts) {
    const glm::dvec3 scaled = glm::min(glm::ceil(scale * glm::dvec3(part.size)), glm::dvec3(fields::kMaxSide));
    const double voxels = scaled.x * scaled.y * scaled.z, surface = std::min(voxels, scale * scale * part.surface_voxels);
    const double triangles = static_cast<double>(part.triangles);
    kept += voxels + surface * sizeof(SurfaceSample) + triangles * kTriangleKept;
    const double stored = scale * scale * scale * part.solid_voxels / kBrickVoxels + surface / 128;
    const double finding = surface * kFinding + triangles * kTriangle;
    const double leveling = surface * kLeveling + static_cast<double>(fields::peakBytes(glm::ivec3(scaled), static_cast<std::uint64_t>(stored)));
    peak = std::max({peak, finding, leveling});
  }
  return static_cast<std::uint64_t>(kept + peak);
}

std::uint64_t physicalMemory() { return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)); }

std::uint64_t peakMemory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;  // Linux counts KiB
}

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  if (kib < 1024) return fmt::format("{:.1f} KiB", kib);
  if (kib < 1024 * 1024) return fmt::format("{:.1f} MiB", kib / 1024);
  return fmt::format("{:.1f} GiB", kib / (1024 * 1024));
}

}  // namespace kelp::bake
