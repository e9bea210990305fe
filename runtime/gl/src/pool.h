// SPDX-License-Identifier: MIT
// The GPU memory of all voxels: one texture array of 32-bit words, made once and never again. Blocks of whole rows are given out; whoever
// holds one and is worth less has to give it back when there is no other room.
#pragma once

#include <algorithm>
#include <span>

#include "gl_api.h"
#include "kelp/formats/buffer.h"

namespace kelp::gl {

struct ResidentLevel;

class Pool {
 public:
  static constexpr std::uint32_t kRowWords = 1024;
  static constexpr std::uint32_t kRowBytes = kRowWords * sizeof(std::uint32_t);
  static constexpr std::uint32_t kLayerRows = 1024;
  static constexpr std::uint64_t kLeast = 64 * kRowBytes;

  // Rows that belong to somebody. `page`: of the level; kGrid: its grid; no level: an asset's tables, never given back.
  struct Block {
    static constexpr std::uint32_t kGrid = ~0u;
    std::uint32_t row = 0;
    std::uint32_t rows = 0;
    ResidentLevel* level = nullptr;
    std::uint32_t page = kGrid;
  };

  explicit Pool(const Allocator& allocator) : blocks_(allocator), zeros_(allocator) {}

  // Makes the texture: as many whole rows as `budget` holds and one texture array of the context can. Within an UploadGuard.
  Result<void> create(const Api& api, std::uint64_t budget);
  void destroy(const Api& api);
  Name texture() const { return texture_; }
  std::uint32_t rows() const { return rows_; }
  std::uint64_t usedBytes() const { return std::uint64_t{used_} * kRowBytes; }

  static std::uint32_t rowsFor(std::uint64_t words) { return static_cast<std::uint32_t>((words + kRowWords - 1) / kRowWords); }

  // The first row of a free place; 0, which is no place, if there is none.
  std::uint32_t findFree(std::uint32_t rows);
  // The blocks of a run that would be place enough if they were given back, all worth less than `priority`; of all such runs one whose
  // dearest block is cheapest. Empty: there is none. Good until the next take() or giveBack().
  std::span<const Block> findVictims(std::uint32_t rows, float priority) const;
  // False: no memory to keep account of it.
  [[nodiscard]] bool take(const Block& block);
  // Says whose the block at `row` is from now on.
  void assign(std::uint32_t row, ResidentLevel* level, std::uint32_t page);
  void giveBack(std::uint32_t row);
  // Gives back all blocks for which `goes` is true: in one walk, whatever their number.
  template <class Goes>
  void giveBackIf(const Goes& goes) {
    std::uint32_t end = 0;  // of the block before
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Block block = blocks_[i];
      if (goes(block)) {
        used_ -= block.rows;
        mayBeginAt(end);
      } else {
        end = block.row + block.rows;
        blocks_[kept++] = block;
      }
    }
    count_ = kept;
  }
  std::uint32_t rowsOf(std::uint32_t row) const { return blockAt(row)->rows; }

  // Copies words to the address, a word's index in the pool. Within an UploadGuard.
  void write(const Api& api, std::uint64_t address, std::span<const std::uint32_t> words);
  void writeZeros(const Api& api, std::uint64_t address, std::uint64_t words);
  // Bytes written since beginCount().
  std::uint64_t written() const { return written_; }
  void beginCount() { written_ = 0; }

 private:
  Block* blockAt(std::uint32_t row) const;
  void mayBeginAt(std::uint32_t row) {
    for (std::uint32_t& from : from_) from = std::min(from, row);
  }

  Name texture_ = 0;
  std::uint32_t rows_ = 0;
  std::uint32_t used_ = 0;
  std::uint64_t written_ = 0;
  std::uint32_t from_[32] = {};  // [n]: no 2^n free rows begin before this row, which is none within free ones
  std::size_t count_ = 0;
  Buffer<Block> blocks_;  // the first count_, ascending
  Buffer<std::uint32_t> zeros_;
};

}  // namespace kelp::gl
