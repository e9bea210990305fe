// SPDX-License-Identifier: MIT
// From occupancy and surface to cells, codes and attributes.
#include <algorithm>
#include <utility>

#include "brick_cells.h"
#include "brick_clearance.h"
#include "check.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

class LevelBuilder {
 public:
  // Throws if the surface is not in ascending order or not solid.
  LevelBuilder(const Occupancy& occupancy, std::span<const SurfaceVoxel> surface, int threads)
      : occupancy_(occupancy),
        grid_(brickGrid(occupancy.size)),
        threads_(threads),
        surface_(surface),
        bits_(occupancy, threads) {
    BrickCells built = buildCells(bits_, findSurface(), grid_, threads);
    level_.cells = std::move(built.cells);
    stored_ = std::move(built.stored);
  }

  // All solid voxels of stored bricks start as inner: those that get an attribute become surface.
  void makeCodes() {
    level_.codes.resize(stored_.size() * kBrickVoxels);
    parallelFor(static_cast<std::int64_t>(stored_.size()), grainOf(kBrickVoxels), threads_,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto slot = static_cast<std::size_t>(begin); slot < static_cast<std::size_t>(end);
                       ++slot) {
                    const glm::ivec3 low = stored_[slot] * kBrickSide;
                    std::uint8_t* code = level_.codes.data() + slot * kBrickVoxels;
                    for (int i = 0; i < kBrickVoxels; ++i, ++code)
                      if (bits_.row(stored_[slot].x, low.y + (i >> 3 & 7), low.z + (i >> 6)) >> (i & 7) & 1)
                        *code = kInnerCode;
                  }
                });
  }

  // Ranks of the surface voxels, and their attributes in the order of slots and codes.
  void makeAttributes() {
    for (const SurfaceVoxel& voxel : surface_) level_.codes[codeOf(voxel.index)] = kSurfaceCode;
    // Slices are 64 consecutive codes. Count in them, and note where in the list of attributes each begins.
    std::vector<std::uint32_t> slice_base(level_.codes.size() / kSliceVoxels);
    std::uint32_t total = 0;
    for (std::size_t slice = 0; slice < slice_base.size(); ++slice) {
      slice_base[slice] = total;
      std::uint8_t rank = 0;
      std::uint8_t* const codes = level_.codes.data() + slice * kSliceVoxels;
      for (std::size_t i = 0; i < kSliceVoxels; ++i) {
        if (codes[i] == kSurfaceCode) codes[i] = static_cast<std::uint8_t>(kSurfaceCode + rank++);
      }
      total += rank;
    }
    level_.attributes.resize(surface_.size());
    for (const SurfaceVoxel& voxel : surface_) {
      const std::size_t code = codeOf(voxel.index);
      level_.attributes[slice_base[code / kSliceVoxels] + level_.codes[code] - kSurfaceCode] =
          voxel.attribute;
    }
  }

  RawLevel take() { return std::move(level_); }

 private:
  // Which bricks hold surface voxels.
  std::vector<std::uint8_t> findSurface() const {
    std::vector<std::uint8_t> found(checkedVolume(grid_));
    for (std::size_t i = 0; i < surface_.size(); ++i) {
      const std::uint64_t index = surface_[i].index;
      if (index >= occupancy_.solid.size())
        throw std::invalid_argument("surface voxel " + std::to_string(index) + " lies outside the volume");
      if (i > 0 && index <= surface_[i - 1].index)
        throw std::invalid_argument("surface voxels are not in ascending order");
      if (!occupancy_.solid[index])
        throw std::invalid_argument("surface voxel " + std::to_string(index) + " is empty");
      found[denseIndex(grid_, voxelAt(occupancy_.size, index) / kBrickSide)] = 1;
    }
    return found;
  }

  static constexpr std::size_t kSliceVoxels = kBrickSide * kBrickSide;

  // Place in the codes of a voxel of a stored brick.
  std::size_t codeOf(std::uint64_t index) const {
    const glm::ivec3 voxel = voxelAt(occupancy_.size, index);
    const std::size_t slot = level_.cells[denseIndex(grid_, voxel / kBrickSide)] & kCellSlotMask;
    return slot * kBrickVoxels + static_cast<std::size_t>(codeIndex(voxel));
  }

  const Occupancy& occupancy_;
  glm::ivec3 grid_;
  int threads_;
  std::span<const SurfaceVoxel> surface_;
  SolidBits bits_;
  std::vector<glm::ivec3> stored_;  // bricks by slot
  RawLevel level_;
};

}  // namespace

RawLevel buildLevel(const Occupancy& occupancy, std::span<const SurfaceVoxel> surface, int threads) {
  checkedVolume(occupancy.solid.size(), occupancy.size);
  if (std::all_of(occupancy.solid.begin(), occupancy.solid.end(),
                  [](std::uint8_t solid) { return solid == 0; })) {
    throw std::invalid_argument("a level needs at least one solid voxel");
  }
  LevelBuilder builder(occupancy, surface, threads);
  builder.makeCodes();
  builder.makeAttributes();
  return builder.take();
}

std::uint64_t peakBytes(const glm::ivec3& size, std::uint64_t stored_bricks) {
  checkedVolume(size);
  const glm::ivec3 grid = brickGrid(size);
  const std::uint64_t bricks = checkedVolume(grid);
  // A brick: its cell, whether it holds surface. A stored one: its place in the order of slots (with growth),
  // its position, the first attribute of each slice, its codes.
  const std::uint64_t stored = 3 * 24 + 12 + 8 * 4 + kBrickVoxels;
  return SolidBits::bytes(grid) + brickClearanceBytes(grid) + (sizeof(std::uint32_t) + 1) * bricks +
         stored * std::min(stored_bricks, bricks);
}

}  // namespace kelp::fields
