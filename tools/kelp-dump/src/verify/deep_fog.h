// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "verify/deep_level.h"

namespace kelp::dump {

// The deep check of a part of fog (see deep_check.h). It compares the clearances to the voxel, the samples
// that bricks share, and every level's samples and extinction with those of the next finer level. If bricks
// disagree about shared samples, nothing else is checked in that level.
void checkFogDeeply(PackFile& file, int part, int threads, VerifyReport& report);

// The most memory that this takes for a level of `voxels` voxels, in addition to fields::peakBytes.
std::uint64_t deepFogBytes(std::uint64_t voxels, int channels);

}  // namespace kelp::dump
