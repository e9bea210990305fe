// SPDX-License-Identifier: MIT
// A pack with other rigs, without a copy of its voxels: new chunks first, the rest read from the original.
#pragma once

#include <vector>

#include "rig_sketch.h"

namespace kelp::view {

class Rerigged {
 public:
  // The original and the file of its source must outlive this object; the sketch need not.
  Rerigged(const Source& original, const Pack& pack, const RigSketch& rigs);
  Rerigged(const Rerigged&) = delete;
  Rerigged& operator=(const Rerigged&) = delete;

  Source source() { return {&Rerigged::read, this, size_}; }

 private:
  // `bytes`, or if empty `size` bytes of the original from `from` on. The bytes between pieces are zero.
  struct Piece {
    std::uint64_t offset = 0, size = 0, from = 0;
    std::vector<std::byte> bytes;
  };

  static Read read(void* user, std::uint64_t offset, std::span<std::byte> bytes);

  Source original_;
  std::vector<Piece> pieces_;  // ascending
  std::uint64_t size_ = 0;
};

}  // namespace kelp::view
