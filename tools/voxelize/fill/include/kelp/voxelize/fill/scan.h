// SPDX-License-Identifier: MIT
// Solid fill by scanlines through voxel centres.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kelp/voxelize/fill/winding.h"

namespace kelp::bake {

// Of a voxel.
constexpr double kHalfDiagonal = 0.8660254037844387;

// What a voxel is during the fill; anything but kEmpty is solid in the end.
enum : std::uint8_t { kEmpty = 0, kInside = 1, kKept = 2 };

// What the scanlines met of a component. Whole numbers have one sum, in any order.
struct Scanned {
  std::int64_t faces = 0;  // where scanlines along x, y and z enter or leave it
  // of these, how many lie within another solid component, or where one begins or ends
  std::int64_t shared = 0;
  // Along x alone; lengths in units of 2^-kLatticeBits voxel.
  std::int64_t centres = 0;  // of voxels within it
  std::int64_t length = 0;   // of the scanlines, within it
  std::int64_t wound = 0;    // the same times the winding number: more where the component overlaps itself
};

// Where triangles cross scanlines: so many are held at a time, by all threads together, and for each thread
// those of one column. Bytes of one, with a vector's reserve.
inline constexpr std::size_t kMostCrossings = std::size_t{1} << 22;
inline constexpr std::size_t kCrossingBytes = 48;

// Sets to kInside the voxels whose centre lies in a solid component (winding number not 0, or where in doubt
// one half at least; the union of components), and to kKept those that keep what centres miss: a sheet that a
// scanline through voxel centres crosses along x, y or z, and a stretch of the inside between two centres. So
// along the three axes a scanline meets a voxel exactly where it meets the mesh. `voxels` holds size.x size.y
// size.z values. Returns what was met of each component; where caps are in doubt, by the caps.
std::vector<Scanned> fillScanlines(const Topology& mesh, std::span<const Doubt> doubts,
                                   const glm::ivec3& size, int threads, std::vector<std::uint8_t>& voxels);

}  // namespace kelp::bake
