// SPDX-License-Identifier: MIT
#include "memory_estimate.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

#include "frame.h"
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

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes) {
  // Measured on 18 real files at 64 to 512 voxels (tools/bake/README.md). Bytes for each triangle: as it was read, while the mesh is analysed, and with its
  // hierarchy. For each surface voxel: while it is found and looked at, and while levels are built.
  constexpr double kProgram = 39e6, kVoxelizer = 15e6, kTriangle = 50, kAnalysing = 315, kHierarchy = 120, kFinding = 66, kLeveling = 42;
  // Reductions of images hold a third as many texels, each four times as large.
  double kept = kProgram + static_cast<double>(image_bytes) * (1 + 4.0 / 3);
  for (const PartSize& part : parts) kept += static_cast<double>(part.triangles) * kTriangle;
  double peak = kept;
  const auto gridBytes = [](const PartSize& part) { return part.voxels() + part.surface_voxels * sizeof(SurfaceSample); };
  for (const PartSize& part : parts) {
    const double triangles = static_cast<double>(part.triangles);
    if (part.triangles > 0) peak = std::max({peak, kept + triangles * kAnalysing, kept + kVoxelizer + part.voxels() + triangles * kHierarchy + part.surface_voxels * kFinding});
    kept += gridBytes(part);
  }
  if (std::any_of(parts.begin(), parts.end(), [](const PartSize& part) { return part.triangles > 0; })) kept += kVoxelizer;
  for (const PartSize& part : parts) {
    const double bricks = part.solid_voxels / kBrickVoxels + part.surface_voxels / 128;
    peak = std::max(peak, kept + part.surface_voxels * kLeveling + static_cast<double>(fields::peakBytes(part.size, static_cast<std::uint64_t>(bricks))));
    // The voxels go, the level stays.
    kept += bricks * kBrickVoxels + part.surface_voxels * sizeof(std::uint32_t) - gridBytes(part);
  }
  return static_cast<std::uint64_t>(peak);
}

std::uint64_t requireMemory(const std::function<std::vector<PartSize>(const Settings&)>& sizes, std::uint64_t image_bytes, const Settings& settings, int resolution, const std::filesystem::path& input) {
  const std::uint64_t limit = settings.max_memory > 0 ? settings.max_memory : physicalMemory();
  const auto need = [&](const Settings& changed) { return estimateMemory(sizes(changed), image_bytes); };
  const std::uint64_t estimate = need(settings);
  if (estimate <= limit) return estimate;
  // The least change that fits, by halves: steps of a voxel along the longest side, or of a hundredth of a voxel's edge.
  constexpr double kStep = 1.01;
  constexpr int kSteps = 1200;  // beyond a hundred thousand times as long
  Settings changed = settings;
  const auto fits = [&](int step) {
    if (settings.voxel_size) {
      // As it will be printed.
      changed.voxel_size = std::stod(fmt::format("{:.4g}", *settings.voxel_size * std::pow(kStep, step)));
      if (*changed.voxel_size <= *settings.voxel_size || *changed.voxel_size > kLargestVoxel) return false;
    } else {
      changed.resolution = resolution - step;
      changed.resolution_given = true;
    }
    return need(changed) <= limit;
  };
  int too_little = 0, enough = settings.voxel_size ? kSteps : resolution - 1;
  std::string advice = "no resolution would fit: the file itself is too large";
  if (enough > 0 && fits(enough)) {
    while (enough - too_little > 1) {
      const int middle = too_little + (enough - too_little) / 2;
      (fits(middle) ? enough : too_little) = middle;
    }
    fits(enough);
    advice = settings.voxel_size ? fmt::format("--voxel-size {:.4g} would fit; take that", *changed.voxel_size) : fmt::format("--resolution {} would fit; take that", changed.resolution);
  }
  throw BakeError(Exit::kRuntime, fmt::format("{}: baking needs about {} of memory, {} is the limit ({}); {}, or raise --max-memory", input.filename().string(), printBytes(estimate), printBytes(limit),
                                              settings.max_memory > 0 ? "--max-memory" : "this machine's memory", advice));
}

std::uint64_t physicalMemory() { return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)); }

std::uint64_t peakMemory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;  // Linux counts KiB
}

void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::string printBytes(std::uint64_t bytes) {
  const double kib = static_cast<double>(bytes) / 1024.0;
  if (kib < 1024) return fmt::format("{:.1f} KiB", kib);
  if (kib < 1024 * 1024) return fmt::format("{:.1f} MiB", kib / 1024);
  return fmt::format("{:.1f} GiB", kib / (1024 * 1024));
}

}  // namespace kelp::bake
