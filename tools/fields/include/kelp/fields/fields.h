// SPDX-License-Identifier: MIT
// Exact Euclidean distance transform, clearance and levels of voxel volumes. The baker computes
// with it, kelp-dump verifies with it. Every function gives the same result for any number of threads, with
// or without SIMD. Arrays are dense, x fastest, then y, then z.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/fields/solid_bits.h"
#include "kelp/formats/raw_pack.h"

namespace kelp::fields {

// Answered where there is no set voxel at all.
inline constexpr std::uint32_t kNoFeature = 0xffffffffu;
// Largest side a volume may have, so that squared distances fit 32 bits.
inline constexpr int kMaxSide = 32768;

// Dense occupancy: 0 empty, anything else solid.
struct Occupancy {
  glm::ivec3 size{0};
  std::vector<std::uint8_t> solid;

  std::size_t index(const glm::ivec3& v) const { return denseIndex(size, v); }
};

// squared[i] = squared distance, in voxels, from the center of voxel i to the center of the nearest voxel
// whose `set` is not 0; exact. Separable lower envelopes after Felzenszwalb and Huttenlocher / Maurer et al.
// 2003, in integers. Throws std::invalid_argument on sizes that do not match or exceed kMaxSide.
void squaredDistance(std::span<const std::uint8_t> set, const glm::ivec3& size,
                     std::span<std::uint32_t> squared, int threads);

// The index (x + size.x (y + size.y z)) of a set voxel whose center is nearest to voxel i's; kNoFeature if
// none is set. Plain loops. Throws std::invalid_argument as above, and for volumes of 2^32 - 1 voxels and
// more.
std::vector<std::uint32_t> nearestSet(std::span<const std::uint8_t> set, const glm::ivec3& size, int threads);

// Occupancy dilated by one voxel in the 26-neighborhood, clipped to the volume.
std::vector<std::uint8_t> dilate26(const Occupancy& occupancy, int threads);

// Squared clearance of every voxel: for empty voxels the squared distance between its closed cube and the
// nearest solid closed cube, in voxels, an integer; 0 for solid voxels too; kNoFeature when nothing is solid.
// Equals squaredDistance of dilate26.
std::vector<std::uint32_t> squaredClearance(const Occupancy& occupancy, int threads);

// A surface voxel with its attribute. Lists are sorted by index (x + size.x (y + size.y z)), each at most
// once.
struct SurfaceVoxel {
  std::uint64_t index = 0;
  std::uint32_t attribute = 0;
};

// Indices of the solid voxels with an empty voxel, or the outside, among their 26 neighbors; ascending.
std::vector<std::uint64_t> surfaceVoxels(const SolidBits& bits, int threads);
std::vector<std::uint64_t> surfaceVoxels(const Occupancy& occupancy, int threads);

// The next coarser occupancy: size ceil(size / 2), solid where any of the (up to) eight voxels is.
SolidBits coarser(const SolidBits& bits, int threads);
Occupancy coarser(const Occupancy& occupancy, int threads = 1);

// Cells, codes and attributes of one level: what brick.h describes, without boxes, which the reader of a pack
// makes. `surface` must list exactly the voxels
// that get an attribute, all solid; full bricks without any become kCellInside. Throws std::invalid_argument
// if nothing is solid or `surface` does not fit.
RawLevel buildLevel(const SolidBits& bits, std::span<const SurfaceVoxel> surface, int threads);
RawLevel buildLevel(const Occupancy& occupancy, std::span<const SurfaceVoxel> surface, int threads);

// The distances of one level, exact within the band: what kelp/formats/distance.h describes. Brick by brick,
// from the bits around each, without a dense array. Throws std::invalid_argument if nothing is solid, for
// cells and codes that do not fit, and for bands that the format does not know.
RawDistances buildDistances(const RawLevel& level, const glm::ivec3& size, DistanceBand band, int threads);
RawDistances buildDistances(const Occupancy& occupancy, DistanceBand band, int threads);

// The occupancy that a level's cells and codes hold (the inverse of buildLevel, for checks). Throws on slots
// out of range.
Occupancy occupancyOf(const RawLevel& level, const glm::ivec3& size);

// Samples of one level of fog: codes as kelp/formats/fog.h has them, dense. Heat may be empty.
struct FogSamples {
  glm::ivec3 size{0};
  std::vector<std::uint8_t> density, heat;
};

// The cubes between samples, 1 where one is not clear.
Occupancy fogCubes(const FogSamples& fog, int threads);

// Cells and samples of one level of fog, but for its extinction. Throws std::invalid_argument if all is clear
// or sizes do not match.
RawLevel buildFogLevel(const FogSamples& fog, int threads);

// The next coarser level: means over the voxels that each covers, of what is stored. Where anything is, codes
// are at least 1: what is clear is clear at all finer levels. `extinction` is the finer level's, and becomes
// the coarser one's: its greatest density has the code 255.
FogSamples coarserFog(const FogSamples& fine, float& extinction, int threads);

// The samples that a level's bricks hold (the inverse of buildFogLevel, for checks). Where two bricks
// disagree about a sample that they share, the later one counts. Throws on slots out of range.
FogSamples fogSamplesOf(const RawLevel& level, const glm::ivec3& size);

// Bytes that buildLevel needs at its peak for a volume of `size` voxels of which so many bricks hold
// something, its bits included, but not the surface itself, nor 4 bytes of result for each surface voxel.
std::uint64_t peakBytes(const glm::ivec3& size, std::uint64_t stored_bricks);

}  // namespace kelp::fields
