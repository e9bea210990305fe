// SPDX-License-Identifier: MIT
// The bytes of a pack that have arrived in the page, and those that are wanted next. A Source over it answers
// kNotYet until somebody has fed the bytes, so nothing waits.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kelp/formats/source.h"

namespace kelp::web {

// Keeps blocks of 16 KiB, at most kMostBytes of them; those that were not read for longest make room. Nothing
// here trusts the server: what it sends beyond the pack's size is dropped.
class RangeStore {
 public:
  static constexpr std::uint32_t kBlock = 16 << 10;
  static constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;
  static constexpr std::uint64_t kLargestPack = std::uint64_t{2} << 30;

  struct Range {
    std::uint64_t offset = 0, length = 0;  // length 0: nothing is wanted
  };

  explicit RangeStore(std::uint64_t size);  // at most kLargestPack
  Source source() { return {&RangeStore::read, this, size_, nullptr, nullptr}; }
  std::uint64_t size() const { return size_; }
  std::uint64_t arrived() const { return arrived_; }

  // Forgets what was wanted: the next reads say it anew.
  void beginPass() { wanted_.clear(); }
  // The next range to fetch: the most urgent block that nobody fetches yet, and what is wanted right behind
  // it, at most `most` bytes, but at least a block. It counts as being fetched until feed() or giveUp().
  Range take(std::uint64_t most);
  bool wantsMore() const;
  // Somebody fetches these bytes already.
  void expect(const Range& range) { mark(range, true); }
  // Bytes that have arrived. A block is filled from its begin on; bytes that leave a gap are dropped.
  void feed(std::uint64_t offset, std::span<const std::byte> bytes);
  // Nobody fetches these bytes any more: the request ended, whether or not they all arrived.
  void giveUp(const Range& range) { mark(range, false); }

 private:
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::uint32_t filled = 0;
    std::uint32_t used = 0;  // when it was read or filled last
    bool in_flight = false;
  };

  static Read read(void* user, std::uint64_t offset, std::span<std::byte> bytes);
  std::uint32_t lengthOf(std::size_t block) const;
  bool isWhole(std::size_t block) const { return blocks_[block].filled == lengthOf(block); }
  void mark(const Range& range, bool in_flight);
  void makeRoom();

  std::uint64_t size_ = 0, arrived_ = 0, held_ = 0;
  std::uint32_t clock_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::size_t> wanted_;  // blocks, the most urgent first
};

}  // namespace kelp::web
