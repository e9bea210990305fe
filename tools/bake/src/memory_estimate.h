// SPDX-License-Identifier: MIT
// How much memory a bake will need, known before it is needed.
#pragma once

#include <span>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// What is known of a part before its voxels are.
struct PartSize {
  glm::ivec3 size{0};
  std::uint64_t triangles = 0;
  double surface_voxels = 0, solid_voxels = 0;  // guessed for meshes, counted for volumes
};
PartSize partSize(const SourcePart& part, const Frame& frame);

// Bytes at the peak: the arrays of the part that needs most, beside the voxels of all the others, the images (image_bytes as they are in memory) with their
// reductions, and the program itself. `scale`: as if the resolution were that many times as high.
std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes, double scale = 1.0);
// The machine's physical memory; bytes.
std::uint64_t physicalMemory();
// The most that this program has held so far; bytes of physical memory. It never falls.
std::uint64_t peakMemory();
// "1.5 GiB".
std::string printBytes(std::uint64_t bytes);

}  // namespace kelp::bake
