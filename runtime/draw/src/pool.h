// SPDX-License-Identifier: MIT
// The layout of the pool, the GPU memory of all voxels: 32-bit words, divided into blocks of whole rows. When
// there is no free place, blocks of lower value are given back.
#pragma once

#include <algorithm>
#include <span>

#include "kelp/formats/buffer.h"
#include "kelp/formats/page.h"

namespace kelp::draw {

struct ResidentLevel;

class Pool {
 public:
  static constexpr std::uint32_t kRowWords = 1024;
  static constexpr std::uint32_t kRowBytes = kRowWords * sizeof(std::uint32_t);
  static constexpr std::uint64_t kLeast = 64 * kRowBytes;
  // Where kelp::kSolidBrick is, in row 0. Address 0 is nobody's.
  static constexpr std::uint32_t kSolidBrick = 4;

  // Rows in use. `page`: a page of the level, or kGrid, its grid. No level: an asset's tables, which stay, or
  // a transfer in progress.
  struct Block {
    static constexpr std::uint32_t kGrid = ~0u;
    std::uint32_t row = 0;
    std::uint32_t rows = 0;
    ResidentLevel* level = nullptr;
    std::uint32_t page = kGrid;
  };

  explicit Pool(const Allocator& allocator) : read_(allocator), blocks_(allocator) {}

  // Whole rows, at least kLeast bytes.
  Result<void> create(std::uint64_t bytes);
  std::uint32_t rows() const { return rows_; }
  std::uint64_t usedBytes() const { return std::uint64_t{used_} * kRowBytes; }

  static std::uint32_t rowsFor(std::uint64_t words) {
    return static_cast<std::uint32_t>((words + kRowWords - 1) / kRowWords);
  }

  // The first row of a free place. 0: there is none (row 0 is in use).
  std::uint32_t findFree(std::uint32_t rows);
  // A run of blocks, all of a value below `priority`, that would make enough room if they were given back. Of
  // all such runs one whose most valuable block has the least value. Empty: there is none. Valid until the
  // next take() or giveBack().
  std::span<const Block> findVictims(std::uint32_t rows, float priority) const;
  // False: no memory to record it.
  [[nodiscard]] bool take(const Block& block);
  // Sets the owner of the block at `row`.
  void assign(std::uint32_t row, ResidentLevel* level, std::uint32_t page);
  void giveBack(std::uint32_t row);
  // Gives back all blocks for which `goes` is true, in one pass.
  template <class Goes>
  void giveBackIf(const Goes& goes) {
    std::uint32_t end = 0;  // of the block before
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Block block = blocks_[i];
      if (goes(block)) {
        free(block);
        mayBeginAt(end);
      } else {
        end = block.row + block.rows;
        blocks_[kept++] = block;
      }
    }
    count_ = kept;
  }
  std::uint32_t rowsOf(std::uint32_t row) const { return blockAt(row)->rows; }

  // The last draw that may read what is in these rows; 0: none.
  std::uint64_t lastRead(std::uint32_t row, std::uint32_t rows) const;
  // Draws are numbered; this is the last one's.
  void setFrame(std::uint64_t frame) { frame_ = frame; }
  std::uint64_t frame() const { return frame_; }

 private:
  Block* blockAt(std::uint32_t row) const;
  void mayBeginAt(std::uint32_t row) {
    for (std::uint32_t& from : from_) from = std::min(from, row);
  }

  void free(const Block& block) {
    used_ -= block.rows;
    std::fill_n(read_.begin() + block.row, block.rows, frame_);
  }

  std::uint32_t rows_ = 0;
  std::uint32_t used_ = 0;
  std::uint64_t frame_ = 0;
  Buffer<std::uint64_t> read_;  // [row]: its last draw, when it was given back
  // [n]: no 2^n free rows begin before this row. It never lies inside a free run
  std::uint32_t from_[32] = {};
  std::size_t count_ = 0;
  Buffer<Block> blocks_;  // the first count_, ascending
};

}  // namespace kelp::draw
