// SPDX-License-Identifier: MIT
// A pack with other rigs, without a copy of its voxels: new chunks in front, all else read from where it is.
#pragma once

#include <vector>

#include "rig_sketch.h"

namespace viewer {

class Rerigged {
 public:
  // The original and what its source reads from must outlive this; the sketch need not.
  Rerigged(const kelp::Source& original, const kelp::Pack& pack, const RigSketch& rigs);
  Rerigged(const Rerigged&) = delete;
  Rerigged& operator=(const Rerigged&) = delete;

  kelp::Source source() { return {&Rerigged::read, this, size_}; }

 private:
  // `bytes` if there are any, else `size` bytes of the original from `from` on. What lies between pieces is zero.
  struct Piece {
    std::uint64_t offset = 0, size = 0, from = 0;
    std::vector<std::byte> bytes;
  };

  static bool read(void* user, std::uint64_t offset, std::span<std::byte> bytes);

  kelp::Source original_;
  std::vector<Piece> pieces_;  // ascending
  std::uint64_t size_ = 0;
};

}  // namespace viewer
