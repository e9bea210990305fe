// SPDX-License-Identifier: MIT
#include "brick_reader.h"

#include <algorithm>
#include <utility>

#include "deep_level.h"
#include "kelp/formats/fog.h"
#include "level_voxels.h"

namespace kelp::dump {

BrickReader::BrickReader(PackFile& file, int part, int level) : file_(file), part_(part), level_(level) {
  Result<LevelGrid> grid = file.pack().readGrid(part, level);
  if (!grid) file.fail(grid.error(), levelText(file.pack(), static_cast<std::uint32_t>(part), level));
  grid_ = *std::move(grid);
  positions_.resize(grid_.bricks);
  for (std::size_t c = 0; c < grid_.cells.size(); ++c)
    if (grid_.cells[c] & kCellSolid) positions_[grid_.cells[c] & kCellSlotMask] = positionOf(c, grid_.grid);
}

bool BrickReader::next() {
  if (begun_ && slot_ + 1 >= grid_.bricks) return false;
  slot_ += begun_;
  const bool turn = !begun_ || inPage() >= page_.count;
  if (turn) {
    page_index_ += begun_;
    if (const Result<void> read = file_.pack().readPage(grid_.pages[page_index_], page_); !read)
      file_.fail(read.error(), levelText(file_.pack(), static_cast<std::uint32_t>(part_), level_));
  }
  begun_ = true;
  if (channels() > 0) return true;
  first_attribute_ = turn ? 0 : first_attribute_ + attributes_;
  const std::span<const std::uint8_t> all = codes();
  attributes_ = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), isSurfaceCode));
  return true;
}

std::span<const std::uint8_t> BrickReader::samples(int channel) const {
  const std::size_t bricks = page_.count;
  return std::span<const std::uint8_t>(page_.fog.span()).subspan((static_cast<std::size_t>(channel) * bricks + inPage()) * kFogSamples, kFogSamples);
}

}  // namespace kelp::dump
