// SPDX-License-Identifier: MIT
// XXH3 and zstd. Compression and decompression have sources of their own, so that a game links no compressor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kelp {

// XXH3-64 (seed 0), the checksum of packs.
std::uint64_t checksum(std::span<const std::byte> bytes);

// The same for bytes that come in pieces.
class RunningChecksum {
 public:
  RunningChecksum();
  void add(std::span<const std::byte> bytes);
  std::uint64_t value() const;

 private:
  alignas(64) std::byte state_[576];  // an XXH3_state_t; this header does not include xxhash.h
};

// Bytes of workspace that decodeFrame needs for any frame.
std::size_t decodeWorkspaceBytes();

// Decodes a zstd frame. `frame` must be exactly one frame that states its content size and uses no
// dictionary, and it must fill `out` exactly. False if not. Safe for hostile frames. Allocates nothing.
// workspace: aligned to 8 bytes.
bool decodeFrame(std::span<const std::byte> frame, std::span<std::byte> out, std::span<std::byte> workspace);

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
