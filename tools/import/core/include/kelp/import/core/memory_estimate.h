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

// A part before it is voxelized.
struct PartSize {
  glm::ivec3 size{0};
  std::uint64_t triangles = 0, vertices = 0;
  glm::dvec3 crossings{0};    // of triangles with scanlines along each axis, about
  double surface_voxels = 0;  // at most
  double source_bytes = 0;    // the grids that a volume is sampled from, the fields of a skin
  int fog_channels = 0;       // 1: density; 2: density and heat

  double voxels() const { return static_cast<double>(size.x) * size.y * size.z; }
};

// The estimated peak of a bake in bytes, within a factor of two of real ones: what all parts keep, what the
// largest part needs while it is made, the images (`image_bytes` as they are decoded) with their reductions,
// and the program. tests/bench/HISTORY.md has the peaks of real files.
std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes);

// Returns estimateMemory(parts, image_bytes). If that is more than the settings allow: ToolError kRuntime
// that names the largest resolution, or the smallest voxels, that would fit. sizes(s) gives the parts as they
// would be with other settings: with lower resolutions than `resolution`, the one in force, with larger
// voxels and without padding.
std::uint64_t requireMemory(std::span<const PartSize> parts,
                            const std::function<std::vector<PartSize>(const ImportSettings&)>& sizes,
                            std::uint64_t image_bytes, const ImportSettings& settings, int resolution,
                            const std::filesystem::path& input);

}  // namespace kelp::bake
