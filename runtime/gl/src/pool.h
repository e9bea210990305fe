// SPDX-License-Identifier: MIT
// The GPU memory of all voxels: one texture array of 32-bit words, allocated once. It is divided into blocks
// of whole rows. When there is no free place, blocks of lower value are given back.
#pragma once

#include <algorithm>
#include <span>

#include "gl_api.h"
#include "kelp/formats/buffer.h"
#include "kelp/formats/page.h"

namespace kelp::gl {

struct ResidentLevel;

class Pool {
 public:
  static constexpr std::uint32_t kRowWords = 1024;
  static constexpr std::uint32_t kRowBytes = kRowWords * sizeof(std::uint32_t);
  static constexpr std::uint32_t kLayerRows = 1024;
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

  explicit Pool(const Allocator& allocator) : blocks_(allocator), zeros_(allocator) {}

  // Allocates the texture: as many whole rows as `budget` and one texture array of the context hold. Within
  // an UploadGuard.
  Result<void> create(const Api& api, std::uint64_t budget);
  void destroy(const Api& api);
  Name texture() const { return texture_; }
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

  // Copies words to `address`, the index of a word in the pool. Within an UploadGuard.
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
  // [n]: no 2^n free rows begin before this row. It never lies inside a free run
  std::uint32_t from_[32] = {};
  std::size_t count_ = 0;
  Buffer<Block> blocks_;  // the first count_, ascending
  Buffer<std::uint32_t> zeros_;
};

}  // namespace kelp::gl
