// SPDX-License-Identifier: MIT
// Solid fill by scanlines through voxel centres.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kelp/voxelize/fill/winding.h"

namespace kelp::bake {

// Half the diagonal of a voxel, in voxels.
constexpr double kHalfDiagonal = 0.8660254037844387;

// A voxel's state during the fill. Everything except kEmpty ends as solid.
enum : std::uint8_t { kEmpty = 0, kInside = 1, kKept = 2 };

// What the scanlines counted of a component. Integers, so that their sum does not depend on the order.
struct Scanned {
  std::int64_t faces = 0;  // where scanlines along x, y and z enter or leave it
  // of `faces`: inside another solid component, or where one begins or ends
  std::int64_t shared = 0;
  // Only along x. Lengths in units of 2^-kLatticeBits voxel.
  std::int64_t centres = 0;  // voxel centres inside it
  std::int64_t length = 0;   // of scanlines inside it
  std::int64_t wound = 0;    // length times winding number: larger where the component overlaps itself
};

// Crossings of triangles with scanlines that all threads together hold at a time; each thread also holds
// those of one column. kCrossingBytes is the memory of one crossing, a vector's spare capacity included.
inline constexpr std::size_t kMostCrossings = std::size_t{1} << 22;
inline constexpr std::size_t kCrossingBytes = 48;

// Sets a voxel to kInside if its centre is inside a solid component: winding number not 0, or in a voxel of
// `doubts` at least one half. Sets it to kKept where the centres miss something: a sheet that a scanline
// through voxel centres crosses along x, y or z, or a stretch of the inside between two centres. So along the
// three axes a scanline meets a solid voxel exactly where it meets the mesh. `voxels` holds size.x * size.y *
// size.z values. Returns the counts of each component, as if its caps were part of the mesh.
std::vector<Scanned> fillScanlines(const Topology& mesh, std::span<const Doubt> doubts,
                                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake
