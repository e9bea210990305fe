// SPDX-License-Identifier: MIT
#include "pool.h"

#include <algorithm>
#include <bit>

#include "kelp/formats/page.h"
#include "residency.h"

namespace kelp::draw {

namespace {
constexpr std::uint64_t kMostRows = (std::uint64_t{1} << 22) - 1;  // an address has 32 bits
}

Result<void> Pool::create(std::uint64_t bytes) {
  if (bytes < kLeast || bytes / kRowBytes > kMostRows || bytes % kRowBytes > 0)
    return Error{ErrorCode::kMisuse,
                 "the pool has less than 256 KiB, 16 GiB and more, or not whole blocks of 4 KiB"};
  rows_ = static_cast<std::uint32_t>(bytes / kRowBytes);
  if (!read_.reset(rows_) || !take({0, 1, nullptr, Block::kGrid}))
    return Error{ErrorCode::kOutOfMemory, "no memory to keep account of the pool"};
  return {};
}

std::uint32_t Pool::findFree(std::uint32_t rows) {
  const std::uint32_t least = std::bit_floor(rows);
  std::uint32_t& from = from_[std::bit_width(rows) - 1];
  std::uint32_t end = from;  // of the block before
  std::uint32_t first = rows_;
  std::uint32_t found = 0;
  for (auto i = static_cast<std::size_t>(blockAt(from) - blocks_.data()); found == 0 && i <= count_; ++i) {
    const std::uint32_t next = i < count_ ? blocks_[i].row : rows_;
    if (next - end >= least) first = std::min(first, end);
    if (next - end >= rows) found = end;
    if (i < count_) end = blocks_[i].row + blocks_[i].rows;
  }
  from = first;
  return found;
}

std::span<const Pool::Block> Pool::findVictims(std::uint32_t rows, float priority) const {
  std::size_t first = 0;
  std::span<const Block> best;
  float best_price = priority;
  for (std::size_t i = 0; i < count_; ++i) {
    // The shortest run that ends with block i, and room up to the block after it. Runs begin after the last
    // block that may not go.
    if (!(blocks_[i].level && worthOf(blocks_[i]) < priority)) {
      first = i + 1;
      continue;
    }
    const std::uint32_t end = i + 1 < count_ ? blocks_[i + 1].row : rows_;
    const auto begin = [&](std::size_t n) { return n > 0 ? blocks_[n - 1].row + blocks_[n - 1].rows : 0u; };
    while (first < i && end - begin(first + 1) >= rows) ++first;
    if (end - begin(first) < rows) continue;
    float price = -1e30f;
    for (std::size_t n = first; n <= i; ++n) price = std::max(price, worthOf(blocks_[n]));
    if (price < best_price) {
      best_price = price;
      best = {&blocks_[first], i + 1 - first};
    }
  }
  return best;
}

bool Pool::take(const Block& block) {
  if (!blocks_.grow(std::max<std::size_t>(64, count_ + 1))) return false;
  const auto before = [](const Block& a, const Block& b) { return a.row < b.row; };
  Block* const place = std::lower_bound(blocks_.begin(), blocks_.begin() + count_, block, before);
  std::copy_backward(place, blocks_.begin() + count_, blocks_.begin() + count_ + 1);
  *place = block;
  ++count_;
  used_ += block.rows;
  return true;
}

Pool::Block* Pool::blockAt(std::uint32_t row) const {
  const auto before = [](const Block& a, std::uint32_t b) { return a.row < b; };
  return const_cast<Block*>(std::lower_bound(blocks_.begin(), blocks_.begin() + count_, row, before));
}

void Pool::assign(std::uint32_t row, ResidentLevel* level, std::uint32_t page) {
  Block* const place = blockAt(row);
  place->level = level;
  place->page = page;
}

void Pool::giveBack(std::uint32_t row) {
  Block* const place = blockAt(row);
  free(*place);
  mayBeginAt(place == blocks_.begin() ? 0 : place[-1].row + place[-1].rows);
  std::copy(place + 1, blocks_.begin() + count_, place);
  --count_;
}

std::uint64_t Pool::lastRead(std::uint32_t row, std::uint32_t rows) const {
  return *std::max_element(read_.begin() + row, read_.begin() + row + rows);
}

}  // namespace kelp::draw
