// SPDX-License-Identifier: MIT
// From occupancy and surface to cells, codes and attributes.
#include <algorithm>
#include <utility>

#include "brick_cells.h"
#include "brick_clearance.h"
#include "check.h"
#include "empty_boxes.h"
#include "kelp/common/dense_index.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

class LevelBuilder {
 public:
  LevelBuilder(const Occupancy& occupancy, int threads)
      : occupancy_(occupancy),
        grid_(brickGrid(occupancy.size)),
        threads_(threads),
        bits_(occupancy, threads) {
    BrickCells built = buildCells(bits_, grid_, threads);
    level_.cells = std::move(built.cells);
    stored_ = std::move(built.stored);
  }

  // The boxes of the empty voxels of stored bricks; all solid ones inner for now.
  void makeCodes() {
    level_.codes.assign(stored_.size() * kBrickVoxels, kInnerCode);
    parallelFor(static_cast<std::int64_t>(stored_.size()), grainOf(kBrickVoxels), threads_,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto slot = static_cast<std::size_t>(begin); slot < static_cast<std::size_t>(end);
                       ++slot)
                    chooseCodes(bits_, stored_[slot], level_.codes.data() + slot * kBrickVoxels);
                });
  }

  // Ranks of the surface voxels, and their attributes in the order of slots and codes.
  void makeAttributes(std::span<const SurfaceVoxel> surface) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const std::uint64_t index = surface[i].index;
      if (index >= occupancy_.solid.size())
        throw std::invalid_argument("surface voxel " + std::to_string(index) + " lies outside the volume");
      if (i > 0 && index <= surface[i - 1].index)
        throw std::invalid_argument("surface voxels are not in ascending order");
      if (!occupancy_.solid[index])
        throw std::invalid_argument("surface voxel " + std::to_string(index) + " is empty");
      level_.codes[codeOf(index)] = kSurfaceCode;
    }
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
    level_.attributes.resize(surface.size());
    for (const SurfaceVoxel& voxel : surface) {
      const std::size_t code = codeOf(voxel.index);
      level_.attributes[slice_base[code / kSliceVoxels] + level_.codes[code] - kSurfaceCode] =
          voxel.attribute;
    }
  }

  RawLevel take() { return std::move(level_); }

 private:
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
  LevelBuilder builder(occupancy, threads);
  builder.makeCodes();
  builder.makeAttributes(surface);
  return builder.take();
}

std::uint64_t peakBytes(const glm::ivec3& size, std::uint64_t stored_bricks) {
  checkedVolume(size);
  const glm::ivec3 grid = brickGrid(size);
  const std::uint64_t bricks = checkedVolume(grid);
  // A brick: its cell. A stored one: its place in the order of slots (with growth), its position, the first
  // attribute of each slice, its codes.
  const std::uint64_t stored = 3 * 24 + 12 + 8 * 4 + kBrickVoxels;
  return SolidBits::bytes(grid) + BrickSums::bytes(grid) + brickClearanceBytes(grid) +
         sizeof(std::uint32_t) * bricks + stored * std::min(stored_bricks, bricks);
}

}  // namespace kelp::fields
