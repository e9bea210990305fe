// SPDX-License-Identifier: MIT
#include "pack/brick_reader.h"

#include <algorithm>

#include "kelp/formats/fog.h"
#include "pack/level_grid.h"

namespace kelp::dump {

BrickReader::BrickReader(PackFile& file, int part, int level)
    : file_(file), level_(openLevel(file, static_cast<std::uint32_t>(part), level)) {}

bool BrickReader::next() {
  if (begun_ && slot_ + 1 >= grid().bricks.size()) return false;
  slot_ += begun_;
  const bool turn = !begun_ || inPage() >= page_.info.count;
  if (turn) {
    page_index_ += begun_;
    readLevelPage(file_, level_, page_index_, page_);
  }
  begun_ = true;
  if (channels() > 0) return true;
  first_attribute_ = turn ? 0 : first_attribute_ + attributes_;
  const std::span<const std::uint8_t> all = codes();
  attributes_ = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), isSurfaceCode));
  return true;
}

std::span<const std::uint8_t> BrickReader::samples(int channel) const {
  const std::size_t bricks = page_.info.count;
  return std::span<const std::uint8_t>(page_.fog.span())
      .subspan((static_cast<std::size_t>(channel) * bricks + inPage()) * kFogSamples, kFogSamples);
}

}  // namespace kelp::dump
