// SPDX-License-Identifier: MIT
#include "distance_store.h"

#include <algorithm>
#include <cstring>

namespace kelp::runtime {
namespace {

constexpr std::uint64_t kMostBricks = 113;  // of a page: formats/SPEC.md, section 5.4

std::uint64_t bytesOfLevel(std::uint64_t cells, std::uint64_t bricks, std::uint64_t pages) {
  return cells * sizeof(std::uint32_t) + bricks * (sizeof(std::uint32_t) + kBrickVoxels) +
         pages * (sizeof(PageInfo) + sizeof(Stage));
}

}  // namespace

std::uint64_t DistanceState::estimate(const Part& of) const {
  const glm::ivec3 bricks = brickGrid(levelSize(of.size, level));
  const std::uint64_t cells = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) *
                              static_cast<std::uint64_t>(bricks.z);
  const std::uint64_t before = 8 + (cells + 7) / 8 * 8;  // the page table follows; 32 bytes a page
  const std::uint64_t page_count = (grid_raw - std::min(grid_raw, before)) / 32;
  return bytesOfLevel(cells, std::min(cells, kMostBricks * page_count), page_count);
}

std::uint64_t DistanceState::bytes() const {
  return bytesOfLevel(grid.cells.size(), grid.bricks.size(), grid.pages.size());
}

Result<void> DistanceState::load(const Pack& pack, const Allocator& allocator) {
  Result<DistanceGrid> read = pack.readDistanceGrid(part, level);
  if (!read) return read.error();
  pages = Buffer<Stage>(allocator);
  codes = Buffer<std::uint8_t>(allocator);
  if (!pages.reset(read->pages.size()) || !codes.reset(std::uint64_t{read->bricks.size()} * kBrickVoxels))
    return Error{ErrorCode::kOutOfMemory, "no memory for a level of distances"};
  grid = *std::move(read);
  absent = static_cast<std::uint32_t>(grid.pages.size());
  data = {grid.size, grid.grid, grid.band, grid.cells.span(), codes.span()};
  return {};
}

Result<void> DistanceState::loadPage(const Pack& pack, std::uint32_t page, DistancePage& memory) {
  if (Result<void> read = pack.readDistancePage(grid, page, memory); !read) return read;
  std::memcpy(codes.data() + std::size_t{memory.first_slot} * kBrickVoxels, memory.codes.data(),
              std::size_t{memory.count} * kBrickVoxels);
  return {};
}

}  // namespace kelp::runtime
