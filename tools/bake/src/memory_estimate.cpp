// SPDX-License-Identifier: MIT
#include "memory_estimate.h"

#include <algorithm>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "kelp/fields/fields.h"

namespace kelp::bake {

std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes) {
  // A triangle with its welded copy, edges and hierarchy; a touched voxel in OpenVDB's tree and lists; the attributes of two levels at once.
  constexpr std::uint64_t kTriangle = 400, kTouched = 40, kAttribute = 140;
  // Reductions hold a third as many texels, each four times as large.
  constexpr std::uint64_t kProgram = std::uint64_t{32} << 20;
  std::uint64_t kept = kProgram + image_bytes + image_bytes / 3 * 4, peak = 0;
  for (const PartSize& part : parts) {
    const std::uint64_t x = static_cast<std::uint64_t>(part.size.x), y = static_cast<std::uint64_t>(part.size.y), z = static_cast<std::uint64_t>(part.size.z);
    const std::uint64_t voxels = x * y * z;
    const std::uint64_t surface = std::min(voxels, 3 * 2 * (x * y + y * z + z * x));
    kept += voxels + surface * sizeof(SurfaceSample) + part.triangles * 100;
    const std::uint64_t voxelize = voxels + surface * kTouched + part.triangles * kTriangle;
    const std::uint64_t levels = voxels + surface * kAttribute + fields::peakBytes(part.size, voxels);
    peak = std::max({peak, voxelize, levels});
  }
  return kept + peak;
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
