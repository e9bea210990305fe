// SPDX-License-Identifier: MIT
// How much memory a bake will need, known before it is needed.
#pragma once

#include <span>

#include "kelp/bake/bake.h"

namespace kelp::bake {

struct PartSize {
  glm::ivec3 size{0};
  std::uint64_t triangles = 0;
};

// Bytes at the peak: the dense arrays of the largest part while its distances are computed, beside the voxels of all the others, the
// images (image_bytes as they are in memory) with their reductions, and the program itself. The number of surface voxels is guessed as
// three times the box's faces.
std::uint64_t estimateMemory(std::span<const PartSize> parts, std::uint64_t image_bytes);
// The machine's physical memory; bytes.
std::uint64_t physicalMemory();
// The most that this program has held so far; bytes of physical memory. It never falls.
std::uint64_t peakMemory();
// "1.5 GiB".
std::string printBytes(std::uint64_t bytes);

}  // namespace kelp::bake
