// SPDX-License-Identifier: MIT
// How much memory a bake will need, known before it is needed.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// What is known of a part before its voxels are.
struct PartSize {
  glm::ivec3 size{0};
  std::uint64_t triangles = 0;
  double surface_voxels = 0, surface_bricks = 0, solid_voxels = 0;  // surface_bricks: that the surface passes through
  glm::dvec3 crossings{0};   // of triangles with scanlines along each axis, about
  double volume_voxels = 0;  // of a volume, before it is padded to `size`
  double source_bytes = 0;   // of the grids that a volume is sampled from
  int fog_channels = 0;      // 1: density, 2: heat too

  double voxels() const { return static_cast<double>(size.x) * size.y * size.z; }
  // Whether thousands of triangles lie over each other nearly everywhere, so often that it takes long.
  bool isPile() const;
};
// `frame`, for meshes, has been padded; a volume has not.
PartSize partSize(const SourcePart& part, const Frame& frame, const glm::ivec3& pad);
// Of a volume: `size` before it is padded.
PartSize volumeSize(const glm::ivec3& size, const glm::ivec3& pad, double surface_voxels, double solid_voxels);
PartSize fogSize(const glm::ivec3& size, const glm::ivec3& pad, bool heat);

// Bytes at the peak of a bake: parts one after the other, the images (image_bytes as they are in memory) with their reductions, and the program itself.
std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes);

// The estimate of `parts`, as `settings` make them; where it is beyond what they allow, BakeError kRuntime with the largest resolution, or the smallest voxels, and the widest
// padding, that would fit.
// sizes(other settings): the parts as they would be with those; asked for smaller resolutions than `resolution`, the one in force, or for larger voxels, or for less padding.
std::uint64_t requireMemory(std::span<const PartSize> parts, const std::function<std::vector<PartSize>(const Settings&)>& sizes, std::uint64_t image_bytes, const Settings& settings, int resolution, const std::filesystem::path& input);

// The machine's physical memory; bytes.
std::uint64_t physicalMemory();
// The most that this program has held so far; bytes of physical memory. It never falls.
std::uint64_t peakMemory();
// Gives back to the system what has been freed in small pieces, as OpenVDB's trees are: the next stage then does not come on top of it.
void returnFreedMemory();
// "1.5 GiB".
std::string printBytes(std::uint64_t bytes);

}  // namespace kelp::bake
