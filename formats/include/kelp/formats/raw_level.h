// SPDX-License-Identifier: MIT
// Reads a level of a pack back, as the writer takes it.
#pragma once

#include <algorithm>
#include <utility>

#include "kelp/formats/level.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// All of one level as in raw_pack.h, with boxes and ranks. Errors of LevelReader::open and
// readPage. allocator: for decoding. In a header, because its lists may throw std::bad_alloc.
inline Result<RawLevel> readRawLevel(const Pack& pack, int part, int level, const Allocator& allocator = {}) {
  const Result<LevelReader> reader = LevelReader::open(pack, part, level, allocator);
  if (!reader) return reader.error();
  const LevelGrid& grid = reader->grid();
  RawLevel raw;
  raw.cells.reserve(grid.cells.size());
  for (const std::uint32_t cell : grid.cells)
    raw.cells.push_back(grid.isInside(cell) ? kCellInside
                        : cell & kCellSolid ? kCellSolid | grid.slotOf(cell)
                                            : cell);
  const Part& of = pack.parts()[static_cast<std::size_t>(part)];
  if (of.fog) raw.extinction = of.fog->extinction[static_cast<std::size_t>(level)];
  std::size_t raw_bytes = 0;
  for (const PageInfo& info : grid.pages) raw_bytes += info.raw;
  if (of.fog) {
    raw.density.reserve(raw_bytes / grid.pages[0].channels);
    raw.heat.reserve(grid.pages[0].channels == 2 ? raw_bytes / 2 : 0);
  } else {
    raw.codes.reserve(grid.bricks.size() * kBrickVoxels);
    raw.attributes.reserve((raw_bytes - grid.bricks.size() * kBrickVoxels) / sizeof(std::uint32_t));
  }
  PageData page(allocator);
  for (std::size_t i = 0; i < grid.pages.size(); ++i) {
    if (const Result<void> read = reader->readPage(i, page); !read) return read.error();
    for (std::uint32_t brick = 0; !of.fog && brick < page.info.count; ++brick) {
      const std::span<const std::uint8_t> codes = page.codes(brick);
      raw.codes.insert(raw.codes.end(), codes.begin(), codes.end());
    }
    const std::span<const std::uint32_t> attributes = page.attributes();
    raw.attributes.insert(raw.attributes.end(), attributes.begin(), attributes.end());
    // Of fog: all densities of a page, then all heats, if there are any.
    const auto* const heats =
        page.fog.begin() + (grid.pages[i].channels == 2 ? page.fog.size() / 2 : page.fog.size());
    raw.density.insert(raw.density.end(), std::as_const(page).fog.begin(), heats);
    raw.heat.insert(raw.heat.end(), heats, std::as_const(page).fog.end());
  }
  return raw;
}

}  // namespace kelp
