// SPDX-License-Identifier: MIT
#include "level.h"

#include <algorithm>
#include <new>

#include "kelp/formats/fog.h"
#include "kelp/formats/level.h"

namespace kelp::runtime {
namespace {

constexpr std::uint64_t kMostDistanceBricks = 113;  // of a page: formats/SPEC.md, section 5.4

}  // namespace

Result<void> LevelState::load(const Pack& pack, const Allocator& allocator) {
  constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory for the pages of a level"};
  Result<LevelGrid> read = distances ? pack.readDistanceGrid(part, level) : pack.readGrid(part, level);
  if (!read) return read.error();
  const std::size_t count = read->pages.size();
  if (distances) {
    words = Buffer<std::uint32_t>(allocator);
    first_slots = Buffer<std::uint32_t>(allocator);
    if (!words.reset(std::uint64_t{read->bricks.size()} * kCodeWords) || !first_slots.reset(count))
      return kNoMemory;
    for (std::size_t page = 0; page < count; ++page) first_slots[page] = read->pages[page].first_slot;
  } else if (pack.parts()[static_cast<std::size_t>(part)].kind == PartKind::kSolid) {
    shapes = Buffer<BrickShape>(allocator);
    needs = PagesAbove(allocator);
    if ((level > 0 && !shapes.reset(read->bricks.size())) || (coarser && !needs.make(*read, coarser->grid)))
      return kNoMemory;
  }
  void* const memory = allocator.allocate(allocator.user, (count + 1) * sizeof(PageSlot));
  if (!memory) return kNoMemory;
  grid = *std::move(read);
  pages = static_cast<PageSlot*>(memory);
  for (std::size_t page = 0; page <= count; ++page) new (&pages[page]) PageSlot;
  pages[count].words.store(const_cast<std::uint32_t*>(kSolidBrick.data()),  // NOLINT: only read
                           std::memory_order_relaxed);
  absent = static_cast<std::uint32_t>(count);
  page_bytes = 0;
  for (std::uint32_t page = 0; page < absent; ++page) page_bytes += pageBytes(page);
  data = {grid.size, grid.grid, grid.cells.span(), grid.pages.span(), grid.band, first_slots.span(), {}};
  if (distances)
    data.codes = {reinterpret_cast<const std::uint8_t*>(words.data()), words.size() * sizeof(std::uint32_t)};
  return {};
}

Result<void> LevelState::loadPage(const Pack& pack, std::uint32_t page, std::uint32_t round, PageData& memory,
                                  const Allocator& allocator) {
  const PageInfo& info = grid.pages[page];
  PageSlot& slot = pages[page];
  const std::uint32_t count = pageWords(info);
  std::uint32_t* const to =
      distances
          ? words.data() + std::size_t{info.first_slot} * kCodeWords
          : static_cast<std::uint32_t*>(allocator.allocate(allocator.user, count * sizeof(std::uint32_t)));
  if (!to) return Error{ErrorCode::kOutOfMemory, "no memory for a page", info.offset};
  LevelAbove above;
  if (coarser) above = {&coarser->grid, coarser->shapes.span()};
  if (const Result<void> read = pack.readPage(grid, page, above, {to, count}, memory); !read) {
    if (!distances) allocator.deallocate(allocator.user, to, count * sizeof(std::uint32_t));
    return read;
  }
  if (!slot.shaped && !shapes.empty())
    std::copy(memory.shapes.begin(), memory.shapes.end(), shapes.begin() + info.first_slot);
  slot.used.store(round, std::memory_order_relaxed);
  slot.words.store(to, std::memory_order_release);
  return {};
}

void LevelState::release(const Allocator& allocator) {
  if (!pages) return;
  for (std::uint32_t page = 0; page < grid.pages.size(); ++page) {
    std::uint32_t* const of_page = pages[page].words.load(std::memory_order_relaxed);
    if (of_page && !distances)
      allocator.deallocate(allocator.user, of_page, static_cast<std::size_t>(pageBytes(page)));
    pages[page].~PageSlot();
  }
  pages[grid.pages.size()].~PageSlot();
  allocator.deallocate(allocator.user, pages, (grid.pages.size() + 1) * sizeof(PageSlot));
  pages = nullptr;
}

std::uint64_t LevelState::estimatedBytes(const Part& of) const {
  const glm::ivec3 bricks = brickGrid(latticeSize(of.kind, levelSize(of.size, level)));
  const std::uint64_t cells = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) *
                              static_cast<std::uint64_t>(bricks.z);
  const std::uint64_t page_count = (grid_raw - std::min(grid_raw, cells)) / 32;  // a page has 32 bytes
  const std::uint64_t stored =
      std::min(cells, page_count * (distances ? kMostDistanceBricks : kMaxPageBricks));
  std::uint64_t a_brick = sizeof(std::uint32_t), a_page = sizeof(PageInfo) + sizeof(PageSlot);
  if (distances) {
    a_brick += kBrickVoxels;
    a_page += sizeof(std::uint32_t);
  } else if (of.kind == PartKind::kSolid && level > 0) {
    a_brick += sizeof(BrickShape);
  }
  return cells * sizeof(std::uint32_t) + stored * a_brick + page_count * a_page + sizeof(PageSlot);
}

std::uint64_t LevelState::bytes() const {
  return (grid.cells.size() + grid.bricks.size() + needs.first.size() + needs.pages.size() + words.size() +
          first_slots.size()) *
             sizeof(std::uint32_t) +
         shapes.size() * sizeof(BrickShape) + grid.pages.size() * (sizeof(PageInfo) + sizeof(PageSlot)) +
         sizeof(PageSlot);
}

}  // namespace kelp::runtime
