// SPDX-License-Identifier: MIT
// From occupancy and surface to cells, codes and attributes.
#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "check.h"
#include "empty_boxes.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "parallel.h"

namespace kelp::fields {
namespace {

glm::ivec3 wholeBricks(const glm::ivec3& size) { return brickGrid(size) * kBrickSide; }

// The occupancy with empty voxels up to whole bricks, and the squared clearance of them all.
struct PaddedVolume {
  glm::ivec3 size{0};
  std::unique_ptr<std::uint32_t[]> squared;

  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size.x) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(size.y) * static_cast<std::size_t>(z));
  }
};

PaddedVolume paddedClearance(const Occupancy& occupancy, int threads) {
  const glm::ivec3 size = occupancy.size;
  PaddedVolume padded{wholeBricks(size), nullptr};
  const std::size_t volume = checkedVolume(padded.size);
  std::vector<std::uint8_t> dilated;
  if (padded.size == size) {
    dilated = dilate26(occupancy, threads);
  } else {
    Occupancy larger{padded.size, std::vector<std::uint8_t>(volume)};
    for (int z = 0; z < size.z; ++z) {
      for (int y = 0; y < size.y; ++y) {
        const std::uint8_t* const row = occupancy.solid.data() + occupancy.index({0, y, z});
        std::copy_n(row, size.x, larger.solid.begin() + static_cast<std::ptrdiff_t>(larger.index({0, y, z})));
      }
    }
    dilated = dilate26(larger, threads);
  }
  // Not set to zero first: the threads that fill it touch its pages first.
  padded.squared = std::make_unique_for_overwrite<std::uint32_t[]>(volume);
  squaredDistance(dilated, padded.size, {padded.squared.get(), volume}, threads);
  return padded;
}

class LevelBuilder {
 public:
  LevelBuilder(const Occupancy& occupancy, int threads)
      : occupancy_(occupancy), grid_(brickGrid(occupancy.size)), threads_(threads), bits_(occupancy, threads) {}

  // Empty bricks get their box and their clearance; the others a slot, in Morton order.
  void makeCells(const PaddedVolume& padded) {
    level_.cells.resize(checkedVolume(grid_));
    const BrickSums sums(bits_, grid_);
    parallelFor(
        grid_.z, grainOf(std::int64_t{grid_.x} * grid_.y * kBrickVoxels), threads_, [&](std::int64_t begin, std::int64_t end) {
          glm::ivec3 brick{0};
          for (brick.z = static_cast<int>(begin); brick.z < end; ++brick.z) {
            for (brick.y = 0; brick.y < grid_.y; ++brick.y) {
              for (brick.x = 0; brick.x < grid_.x; ++brick.x) {
                level_.cells[cellIndex(brick)] =
                    bits_.holdsSolid(brick) ? kCellSolid : sums.grownBox(brick) | clearance(padded, brick) << kCellClearanceShift;
              }
            }
          }
        });
    std::vector<std::pair<std::uint64_t, glm::ivec3>> ordered;
    glm::ivec3 brick{0};
    for (brick.z = 0; brick.z < grid_.z; ++brick.z) {
      for (brick.y = 0; brick.y < grid_.y; ++brick.y) {
        for (brick.x = 0; brick.x < grid_.x; ++brick.x) {
          if (level_.cells[cellIndex(brick)] & kCellSolid) ordered.emplace_back(mortonCode(brick), brick);
        }
      }
    }
    if (ordered.size() > std::size_t{kCellSlotMask} + 1) {
      throw std::invalid_argument("a level holds at most 16777216 bricks, this one would need " + std::to_string(ordered.size()));
    }
    std::sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    stored_.reserve(ordered.size());
    for (const auto& [code, position] : ordered) {
      level_.cells[cellIndex(position)] = kCellSolid | static_cast<std::uint32_t>(stored_.size());
      stored_.push_back(position);
    }
  }

  // The boxes of the empty voxels of stored bricks; all solid ones inner for now.
  void makeCodes() {
    level_.codes.assign(stored_.size() * kBrickVoxels, kInnerCode);
    parallelFor(static_cast<std::int64_t>(stored_.size()), grainOf(kBrickVoxels), threads_,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto slot = static_cast<std::size_t>(begin); slot < static_cast<std::size_t>(end); ++slot)
                    chooseCodes(bits_, stored_[slot], level_.codes.data() + slot * kBrickVoxels);
                });
  }

  // Ranks of the surface voxels, and their attributes in the order of slots and codes.
  void makeAttributes(std::span<const SurfaceVoxel> surface) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const std::uint64_t index = surface[i].index;
      if (index >= occupancy_.solid.size())
        throw std::invalid_argument("surface voxel " + std::to_string(index) + " lies outside the volume");
      if (i > 0 && index <= surface[i - 1].index) throw std::invalid_argument("surface voxels are not in ascending order");
      if (!occupancy_.solid[index]) throw std::invalid_argument("surface voxel " + std::to_string(index) + " is empty");
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
      level_.attributes[slice_base[code / kSliceVoxels] + level_.codes[code] - kSurfaceCode] = voxel.attribute;
    }
  }

  RawLevel take() { return std::move(level_); }

 private:
  static constexpr std::size_t kSliceVoxels = kBrickSide * kBrickSide;

  std::size_t cellIndex(const glm::ivec3& brick) const {
    return static_cast<std::size_t>(brick.x) +
           static_cast<std::size_t>(grid_.x) *
               (static_cast<std::size_t>(brick.y) + static_cast<std::size_t>(grid_.y) * static_cast<std::size_t>(brick.z));
  }

  // Place in the codes of a voxel of a stored brick.
  std::size_t codeOf(std::uint64_t index) const {
    const auto width = static_cast<std::uint64_t>(occupancy_.size.x);
    const auto height = static_cast<std::uint64_t>(occupancy_.size.y);
    const glm::ivec3 voxel(static_cast<int>(index % width), static_cast<int>(index / width % height),
                           static_cast<int>(index / width / height));
    const std::size_t slot = level_.cells[cellIndex(voxel / kBrickSide)] & kCellSlotMask;
    return slot * kBrickVoxels + static_cast<std::size_t>(codeIndex(voxel));
  }

  // Of an empty brick.
  static std::uint32_t clearance(const PaddedVolume& padded, const glm::ivec3& brick) {
    const glm::ivec3 corner = brick * kBrickSide;
    std::uint32_t nearest = kNoFeature;
    for (int z = corner.z; z < corner.z + kBrickSide; ++z) {
      for (int y = corner.y; y < corner.y + kBrickSide; ++y) {
        const std::uint32_t* const squared = padded.squared.get() + padded.index(corner.x, y, z);
        for (int x = 0; x < kBrickSide; ++x) nearest = std::min(nearest, squared[x]);
      }
    }
    return std::min(quantizedClearance(nearest, 1), kCellMaxClearance);
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
  if (std::all_of(occupancy.solid.begin(), occupancy.solid.end(), [](std::uint8_t solid) { return solid == 0; })) {
    throw std::invalid_argument("a level needs at least one solid voxel");
  }
  LevelBuilder builder(occupancy, threads);
  builder.makeCells(paddedClearance(occupancy, threads));
  builder.makeCodes();
  builder.makeAttributes(surface);
  return builder.take();
}

std::uint64_t peakBytes(const glm::ivec3& size) {
  checkedVolume(size);
  const glm::ivec3 grid = brickGrid(size);
  const std::uint64_t bricks = checkedVolume(grid);
  const std::uint64_t voxels = bricks * kBrickVoxels;
  // A padded voxel: 4 bytes of squared clearance and a byte of dilated occupancy; or a code and an attribute. A brick: its cell,
  // its place in the order of slots (with growth), its position, the first attribute of each slice.
  const std::uint64_t per_brick = 4 + 3 * 24 + 12 + 8 * 4;
  return 5 * voxels + SolidBits::bytes(grid) + BrickSums::bytes(grid) + per_brick * bricks;
}

}  // namespace kelp::fields
