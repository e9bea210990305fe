// SPDX-License-Identifier: MIT
// Decompression, apart from compression so that a game links no compressor.
#pragma once

#include <cstddef>
#include <span>

namespace kelp {

// Bytes of workspace that decodeFrame needs, whatever the frame.
std::size_t decodeWorkspaceBytes();

// Decodes the one zstd frame that fills `frame` exactly into `out`, which it fills exactly; the frame must state its content size
// and use no dictionary. False if anything is otherwise. Safe for hostile frames; allocates nothing. workspace: aligned to 8
// bytes.
bool decodeFrame(std::span<const std::byte> frame, std::span<std::byte> out, std::span<std::byte> workspace);

}  // namespace kelp
