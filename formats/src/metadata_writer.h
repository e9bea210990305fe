// SPDX-License-Identifier: MIT
// The pack writer's checks, and its metadata chunks: the reverse of metadata.h.
#pragma once

#include <cstddef>
#include <cstdint>

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
[[nodiscard]] bool buildJoints(const RawPack& pack, Buffer<std::byte>& out);
// For a pack with a cage. kMisuse if a cage breaks a rule or a part lacks one; kOutOfMemory.
Result<void> buildCages(const RawPack& pack, Buffer<std::byte>& out);

// The lowest minor version of a pack that has these.
constexpr std::uint16_t minorVersionOf(bool cages, bool joints, bool empty_parts) {
  return cages ? 3 : joints ? 2 : empty_parts ? 1 : 0;
}

inline Error misuse(const char* detail) { return {ErrorCode::kMisuse, detail}; }

// Checks that the voxels of a level keep the rules of SPEC.md. kMisuse, with a text, if not.
Result<void> checkRawLevel(const RawPart& part, std::size_t level, std::size_t palette_size);

// The same for a level of distances of `size` voxels, except for its codes, which are checked page by page.
Result<void> checkRawDistances(const RawDistances& level, const glm::ivec3& size);

}  // namespace kelp
