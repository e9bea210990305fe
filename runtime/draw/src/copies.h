// SPDX-License-Identifier: MIT
// The copies that one call of the planner asks for.
#pragma once

#include "kelp/draw/planner.h"
#include "kelp/formats/buffer.h"

namespace kelp::draw {

class Copies {
 public:
  explicit Copies(const Allocator& allocator) : copies_(allocator), words_(allocator) {}

  void clear() { count_ = used_ = 0; }
  // Room for so many more, and so many words of their own. False: no memory.
  [[nodiscard]] bool reserve(std::size_t copies, std::size_t words) {
    return copies_.grow(count_ + copies) && words_.grow(used_ + words);
  }
  // Within what is reserved. `address`: a word of the pool; `words` stay where they are.
  void add(std::uint64_t address, std::span<const std::uint32_t> words, std::uint64_t frame) {
    copies_[count_++] = {address * sizeof(std::uint32_t), words, frame};
  }
  // The same with words of its own, to be written before the next call.
  std::span<std::uint32_t> add(std::uint64_t address, std::size_t words, std::uint64_t frame) {
    add(address, std::span(static_cast<const std::uint32_t*>(nullptr), words), frame);
    used_ += words;
    return words_.span().subspan(used_ - words, words);
  }
  // Leaves out what goes to these rows of the pool; of words of its own, after all() alone.
  void forget(std::uint32_t row, std::uint32_t rows);
  bool empty() const { return count_ == 0; }
  std::span<const Copy> all();

 private:
  std::size_t count_ = 0, used_ = 0;
  Buffer<Copy> copies_;          // the first count_; those with words of their own have null
  Buffer<std::uint32_t> words_;  // the first used_: theirs, one after the other
};

}  // namespace kelp::draw
