// SPDX-License-Identifier: MIT
// Compression, for the writer alone.
#pragma once

#include <cstddef>
#include <span>

namespace kelp {

// Compresses blocks one after the other. The frame depends on the block alone, not on what came before. Not thread-safe.
class FrameEncoder {
 public:
  FrameEncoder();
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  // Room that encode needs in `frame` for any block of `bytes`.
  static std::size_t bound(std::size_t bytes);
  // One zstd frame that states its content size. Answers its size, 0 when memory is short.
  std::size_t encode(std::span<const std::byte> block, std::span<std::byte> frame);

 private:
  void* context_;
};

}  // namespace kelp
