// SPDX-License-Identifier: MIT
#include "range_store.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>

namespace kelp::web {

RangeStore::RangeStore(std::uint64_t size)
    : size_(size), blocks_(static_cast<std::size_t>((size + kBlock - 1) / kBlock)) {}

std::uint32_t RangeStore::lengthOf(std::size_t block) const {
  const std::uint64_t begin = std::uint64_t{block} * kBlock;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlock, size_ - begin));
}

Read RangeStore::read(void* user, std::uint64_t offset, std::span<std::byte> bytes) {
  RangeStore& store = *static_cast<RangeStore*>(user);
  if (bytes.empty()) return Read::kDone;
  // Refuses requests that the store could never hold at once.
  if (offset > store.size_ || bytes.size() > store.size_ - offset || bytes.size() > kMostBytes / 2)
    return Read::kFailed;
  const std::uint64_t end = offset + bytes.size();
  const auto first = static_cast<std::size_t>(offset / kBlock),
             last = static_cast<std::size_t>((end - 1) / kBlock);
  bool complete = true;
  ++store.clock_;
  for (std::size_t i = first; i <= last; ++i) {
    Block& block = store.blocks_[i];
    block.used = store.clock_;
    const std::uint64_t needed = std::min<std::uint64_t>(kBlock, end - std::uint64_t{i} * kBlock);
    if (block.filled >= needed) continue;
    complete = false;
    store.wanted_.push_back(i);
  }
  if (!complete) return Read::kNotYet;
  for (std::size_t i = first; i <= last; ++i) {
    const std::uint64_t begin = std::uint64_t{i} * kBlock;
    const std::uint64_t from = std::max(offset, begin), to = std::min(end, begin + kBlock);
    std::memcpy(bytes.data() + (from - offset), store.blocks_[i].bytes.get() + (from - begin),
                static_cast<std::size_t>(to - from));
  }
  return Read::kDone;
}

bool RangeStore::wantsMore() const {
  return std::any_of(wanted_.begin(), wanted_.end(),
                     [&](std::size_t i) { return !blocks_[i].in_flight && !isWhole(i); });
}

RangeStore::Range RangeStore::take(std::uint64_t most) {
  const auto open = [&](std::size_t i) { return !blocks_[i].in_flight && !isWhole(i); };
  const auto found = std::find_if(wanted_.begin(), wanted_.end(), open);
  if (found == wanted_.end()) return {};
  const std::size_t first = *found;
  std::size_t end = first;
  const std::size_t most_blocks = std::max<std::size_t>(1, static_cast<std::size_t>(most / kBlock));
  while (end < blocks_.size() && end - first < most_blocks && open(end) &&
         std::find(wanted_.begin(), wanted_.end(), end) != wanted_.end())
    blocks_[end++].in_flight = true;
  // Bytes of the first block are not fetched again.
  const std::uint64_t from = std::uint64_t{first} * kBlock + blocks_[first].filled;
  return {from, std::min(size_, std::uint64_t{end} * kBlock) - from};
}

void RangeStore::mark(const Range& range, bool in_flight) {
  if (range.length == 0 || range.offset >= size_) return;
  const std::uint64_t end = std::min(size_, range.offset + range.length);
  for (auto i = static_cast<std::size_t>(range.offset / kBlock); std::uint64_t{i} * kBlock < end; ++i)
    blocks_[i].in_flight = in_flight;
}

void RangeStore::feed(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (offset >= size_) return;
  bytes = bytes.first(static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), size_ - offset)));
  ++clock_;
  while (!bytes.empty()) {
    const auto index = static_cast<std::size_t>(offset / kBlock);
    const auto within = static_cast<std::uint32_t>(offset % kBlock);
    const std::span<const std::byte> piece =
        bytes.first(std::min<std::size_t>(bytes.size(), lengthOf(index) - within));
    Block& block = blocks_[index];
    const std::uint32_t until = within + static_cast<std::uint32_t>(piece.size());
    if (within <= block.filled && until > block.filled) {
      if (!block.bytes) {
        makeRoom();
        block.bytes.reset(new (std::nothrow) std::byte[kBlock]);
        if (!block.bytes) return;  // it stays absent, and is asked for again
        held_ += kBlock;
      }
      std::memcpy(block.bytes.get() + within, piece.data(), piece.size());
      arrived_ += until - block.filled;
      block.filled = until;
      block.used = clock_;
    }
    offset += piece.size();
    bytes = bytes.subspan(piece.size());
  }
}

void RangeStore::makeRoom() {
  if (held_ < kMostBytes) return;
  Block* oldest = nullptr;
  for (Block& block : blocks_)
    if (block.bytes && !block.in_flight && (!oldest || block.used < oldest->used)) oldest = &block;
  if (!oldest) return;
  arrived_ -= oldest->filled;
  *oldest = Block();
  held_ -= kBlock;
}

}  // namespace kelp::web
