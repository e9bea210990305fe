// SPDX-License-Identifier: MIT
// RawPack -> the bytes of the metadata chunks. The inverse of metadata.h.
#pragma once

#include <cstddef>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// What a writer answers where one of these is false.
inline constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to write the pack"};

// Each answers false when memory is short. Only sizes are looked at: whether the content keeps the rules is for the functions of
// metadata.h to say.
[[nodiscard]] bool buildParts(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildPalette(const RawPack& pack, Buffer<std::byte>& out);
// Empty if no part is fog.
[[nodiscard]] bool buildFogs(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildRigs(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildClips(const RawPack& pack, Buffer<std::byte>& out);

}  // namespace kelp
