// SPDX-License-Identifier: MIT
#pragma once

#include "kelp/formats/error.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

inline Error misuse(const char* detail) { return {ErrorCode::kMisuse, detail}; }

// Checks that the voxels of a level keep the rules of SPEC.md. kMisuse, with a text, if not.
Result<void> checkRawLevel(const RawPart& part, std::size_t level, std::size_t palette_size);

// The same for a level of distances, except for its codes, which are checked page by page. Returns the number
// of stored bricks.
Result<std::uint32_t> checkRawDistances(const RawDistances& level, const glm::ivec3& grid);

}  // namespace kelp
