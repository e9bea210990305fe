// SPDX-License-Identifier: MIT
#pragma once

#include "kelp/formats/error.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

inline Error misuse(const char* detail) { return {ErrorCode::kMisuse, detail}; }

// Checks that the voxels of a level keep the rules of SPEC.md. kMisuse, with a text, if not.
Result<void> checkRawLevel(const RawPart& part, std::size_t level, std::size_t palette_size);

}  // namespace kelp
