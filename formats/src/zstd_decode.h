// SPDX-License-Identifier: MIT
// Decompression. Separate from compression, so that a game links no compressor.
#pragma once

#include <cstddef>
#include <span>

namespace kelp {

// Bytes of workspace that decodeFrame needs for any frame.
std::size_t decodeWorkspaceBytes();

// Decodes a zstd frame. `frame` must be exactly one frame that states its content size and uses no
// dictionary, and it must fill `out` exactly. False if not. Safe for hostile frames. Allocates nothing.
// workspace: aligned to 8 bytes.
bool decodeFrame(std::span<const std::byte> frame, std::span<std::byte> out, std::span<std::byte> workspace);

}  // namespace kelp
