// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "kelp/formats/level.h"

namespace kelp {

Result<LevelReader> LevelReader::open(const Pack& pack, int part, int level, const Allocator& allocator) {
  LevelReader reader(pack, allocator);
  const std::span<const Part> parts = pack.parts();
  const bool solid = part >= 0 && static_cast<std::size_t>(part) < parts.size() &&
                     parts[static_cast<std::size_t>(part)].kind == PartKind::kSolid && level >= 0;
  const int first = solid ? std::max(level, parts[static_cast<std::size_t>(part)].levels - 1) : level;
  Result<LevelGrid> grid = pack.readGrid(part, first);
  if (!grid) return grid.error();
  reader.grid_ = *std::move(grid);
  for (int l = first; l > level; --l) {
    if (const Result<void> next = reader.refine(); !next) return next.error();
  }
  return Result<LevelReader>(std::move(reader));
}

Result<void> LevelReader::readPage(std::size_t page, PageData& out) const {
  return pack_->readPage(grid_, page, {&above_, shapes_.span()}, out);
}

Result<void> LevelReader::refine() {
  Buffer<BrickShape> shapes(allocator_);
  if (pack_->parts()[static_cast<std::size_t>(grid_.part)].kind == PartKind::kSolid) {
    if (!shapes.reset(grid_.bricks.size())) return Error{ErrorCode::kOutOfMemory, "no memory for a level"};
    PageData page(allocator_);
    for (std::size_t i = 0; i < grid_.pages.size(); ++i) {
      if (const Result<void> read = readPage(i, page); !read) return read;
      std::copy(page.shapes.begin(), page.shapes.end(), shapes.begin() + page.info.first_slot);
    }
  }
  Result<LevelGrid> finer = pack_->readGrid(grid_.part, grid_.level - 1);
  if (!finer) return finer.error();
  above_ = std::exchange(grid_, *std::move(finer));
  shapes_ = std::move(shapes);
  return {};
}

}  // namespace kelp
