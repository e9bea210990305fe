// SPDX-License-Identifier: MIT
// Compression; only the writer uses it.
#pragma once

#include <cstddef>
#include <span>

namespace kelp {

// Compresses blocks. A frame depends on its block alone. Not thread-safe.
class FrameEncoder {
 public:
  FrameEncoder();
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  // Size of `frame` that is enough for any block of `bytes`.
  static std::size_t bound(std::size_t bytes);
  // Writes one zstd frame that states its content size. Returns the size of the frame; 0 if memory is short.
  std::size_t encode(std::span<const std::byte> block, std::span<std::byte> frame);

 private:
  void* context_;
};

}  // namespace kelp
