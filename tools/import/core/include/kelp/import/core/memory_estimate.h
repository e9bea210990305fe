// SPDX-License-Identifier: MIT
// Estimates the memory that a bake needs, before it takes it.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/import_settings.h"

namespace kelp::bake {

// What is known of a part before it is voxelized.
struct PartSize {
  glm::ivec3 size{0};
  std::uint64_t triangles = 0, vertices = 0;
  // surface_bricks: those that the surface passes through
  double surface_voxels = 0, surface_bricks = 0, solid_voxels = 0;
  glm::dvec3 crossings{0};   // approximate number of crossings of triangles with scanlines along each axis
  double scan_bytes = 0;     // bytes for those crossings at the peak
  double volume_voxels = 0;  // of a volume file, before it is padded to `size`
  double source_bytes = 0;   // memory of the grids that a volume is sampled from
  int fog_channels = 0;      // 1: density; 2: density and heat

  double voxels() const { return static_cast<double>(size.x) * size.y * size.z; }
};
// For a volume file. `size` is that before padding.
PartSize volumeSize(const glm::ivec3& size, const glm::ivec3& pad, double surface_voxels,
                    double solid_voxels);
PartSize fogSize(const glm::ivec3& size, const glm::ivec3& pad, bool heat);

// The estimated peak of a bake in bytes: its parts one after the other, the images (`image_bytes` as they are
// decoded) with their reductions, and the program itself.
std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes);

// Returns estimateMemory(parts, image_bytes). If that is more than the settings allow: ToolError kRuntime
// that names the largest resolution (or the smallest voxels) and the widest padding that would fit. sizes(s)
// gives the parts as they would be with other settings; it is asked for lower resolutions than `resolution`,
// the one in force, for larger voxels and for less padding.
std::uint64_t requireMemory(std::span<const PartSize> parts,
                            const std::function<std::vector<PartSize>(const ImportSettings&)>& sizes,
                            std::uint64_t image_bytes, const ImportSettings& settings, int resolution,
                            const std::filesystem::path& input);

}  // namespace kelp::bake
