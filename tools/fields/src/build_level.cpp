// SPDX-License-Identifier: MIT
// From occupancy and surface to cells, codes and attributes.
#include <algorithm>
#include <utility>

#include "bricks.h"
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
  LevelBuilder(const SolidBits& bits, std::span<const SurfaceVoxel> surface, int threads)
      : bits_(bits), grid_(brickGrid(bits.size())), threads_(threads), surface_(surface) {
    BrickCells built = buildCells(bits_, findSurface(), threads);
    level_.cells = std::move(built.cells);
    stored_ = std::move(built.stored);
  }

  // All solid voxels of stored bricks start as inner: those that get an attribute become surface.
  void makeCodes() {
    level_.codes.resize(stored_.size() * kBrickVoxels);
    parallelFor(
        static_cast<std::int64_t>(stored_.size()), grainOf(kBrickVoxels), threads_,
        [&](std::int64_t begin, std::int64_t end) {
          for (auto slot = static_cast<std::size_t>(begin); slot < static_cast<std::size_t>(end); ++slot) {
            const glm::ivec3 low = stored_[slot] * kBrickSide;
            std::uint8_t* code = level_.codes.data() + slot * kBrickVoxels;
            for (int row = 0; row < kBrickVoxels / kBrickSide; ++row) {
              const std::uint8_t eight = bits_.eight(stored_[slot].x, low.y + (row & 7), low.z + (row >> 3));
              for (int x = 0; x < kBrickSide; ++x, ++code)
                if (eight >> x & 1) *code = kInnerCode;
            }
          }
        });
  }

  // Ranks of the surface voxels, and their attributes in the order of slots and codes. A layer of bricks
  // holds no code of another.
  void makeAttributes() {
    forEachLayer([&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) level_.codes[codeOf(surface_[i].index)] = kSurfaceCode;
    });
    // Slices are 64 consecutive codes. Counts in them, and notes where in the list of attributes each begins.
    std::vector<std::uint32_t> slice_base(level_.codes.size() / kSliceVoxels);
    parallelFor(static_cast<std::int64_t>(slice_base.size()), grainOf(kSliceVoxels), threads_,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto slice = static_cast<std::size_t>(begin); slice < static_cast<std::size_t>(end);
                       ++slice) {
                    std::uint8_t rank = 0;
                    std::uint8_t* const codes = level_.codes.data() + slice * kSliceVoxels;
                    for (std::size_t i = 0; i < kSliceVoxels; ++i) {
                      if (codes[i] == kSurfaceCode)
                        codes[i] = static_cast<std::uint8_t>(kSurfaceCode + rank++);
                    }
                    slice_base[slice] = rank;
                  }
                });
    std::uint32_t total = 0;
    for (std::uint32_t& base : slice_base) total += std::exchange(base, total);
    level_.attributes.resize(surface_.size());
    forEachLayer([&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t code = codeOf(surface_[i].index);
        level_.attributes[slice_base[code / kSliceVoxels] + level_.codes[code] - kSurfaceCode] =
            surface_[i].attribute;
      }
    });
  }

  bool isEmpty() const {
    return std::none_of(level_.cells.begin(), level_.cells.end(),
                        [](std::uint32_t cell) { return (cell & kCellSolid) != 0; });
  }

  RawLevel take() { return std::move(level_); }

 private:
  // A byte for each brick: 1 if it holds surface voxels.
  std::vector<std::uint8_t> findSurface() const {
    std::vector<std::uint8_t> found(checkedVolume(grid_));
    const std::size_t voxels = denseCount(bits_.size());
    for (std::size_t i = 1; i < surface_.size(); ++i)
      if (surface_[i].index <= surface_[i - 1].index)
        throw std::invalid_argument("surface voxels are not in ascending order");
    if (!surface_.empty() && surface_.back().index >= voxels)
      throw std::invalid_argument("surface voxel " + std::to_string(surface_.back().index) +
                                  " lies outside the volume");
    forEachLayer([&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const glm::ivec3 voxel = voxelAt(bits_.size(), surface_[i].index);
        if (!bits_.isSolid(voxel))
          throw std::invalid_argument("surface voxel " + std::to_string(surface_[i].index) + " is empty");
        found[denseIndex(grid_, voxel / kBrickSide)] = 1;
      }
    });
    return found;
  }

  // Calls body(begin, end) for the surface voxels of each layer of bricks, on all threads.
  template <class Body>
  void forEachLayer(const Body& body) const {
    const auto firstOf = [&](std::size_t layer) {
      const std::uint64_t first = denseIndex(bits_.size(), 0, 0, static_cast<int>(layer) * kBrickSide);
      return static_cast<std::size_t>(std::lower_bound(surface_.begin(), surface_.end(), first,
                                                       [](const SurfaceVoxel& voxel, std::uint64_t index) {
                                                         return voxel.index < index;
                                                       }) -
                                      surface_.begin());
    };
    parallelRanges(static_cast<std::size_t>(grid_.z), 1, threads_,
                   [&](std::size_t layer, std::size_t next) { body(firstOf(layer), firstOf(next)); });
  }

  static constexpr std::size_t kSliceVoxels = kBrickSide * kBrickSide;

  // Place in the codes of a voxel of a stored brick.
  std::size_t codeOf(std::uint64_t index) const {
    const glm::ivec3 voxel = voxelAt(bits_.size(), index);
    const std::size_t slot = level_.cells[denseIndex(grid_, voxel / kBrickSide)] & kCellSlotMask;
    return slot * kBrickVoxels + static_cast<std::size_t>(codeIndex(voxel));
  }

  const SolidBits& bits_;
  glm::ivec3 grid_;
  int threads_;
  std::span<const SurfaceVoxel> surface_;
  std::vector<glm::ivec3> stored_;  // bricks by slot
  RawLevel level_;
};

}  // namespace

RawLevel buildLevel(const SolidBits& bits, std::span<const SurfaceVoxel> surface, int threads) {
  LevelBuilder builder(bits, surface, threads);
  if (builder.isEmpty()) throw std::invalid_argument("a level needs at least one solid voxel");
  builder.makeCodes();
  builder.makeAttributes();
  return builder.take();
}

RawLevel buildLevel(const Occupancy& occupancy, std::span<const SurfaceVoxel> surface, int threads) {
  return buildLevel(SolidBits(occupancy, threads), surface, threads);
}

std::uint64_t peakBytes(const glm::ivec3& size, std::uint64_t stored_bricks) {
  checkedVolume(size);
  const glm::ivec3 grid = brickGrid(size);
  const std::uint64_t bricks = checkedVolume(grid);
  // A brick: its cell, whether it holds surface. A stored one: its place in the order of slots (with growth),
  // its position, the first attribute of each slice, its codes.
  const std::uint64_t stored = 3 * 24 + 12 + 8 * 4 + kBrickVoxels;
  return SolidBits::bytes(size) + brickClearanceBytes(grid) + (sizeof(std::uint32_t) + 1) * bricks +
         stored * std::min(stored_bricks, bricks);
}

}  // namespace kelp::fields
