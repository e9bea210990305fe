// SPDX-License-Identifier: MIT
// RawPack -> bytes of the metadata chunks: the reverse of metadata.h.
#pragma once

#include <cstddef>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// The error if one of these functions returns false.
inline constexpr Error kNoMemory{ErrorCode::kOutOfMemory, "no memory to write the pack"};

// Each returns false if memory is short. They do not check the content; the functions of metadata.h do.
[[nodiscard]] bool buildParts(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildPalette(const RawPack& pack, Buffer<std::byte>& out);
// Empty if no part is fog.
[[nodiscard]] bool buildFogs(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildRigs(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildClips(const RawPack& pack, Buffer<std::byte>& out);
[[nodiscard]] bool buildSockets(const RawPack& pack, Buffer<std::byte>& out);

}  // namespace kelp
