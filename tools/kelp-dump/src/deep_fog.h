// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "deep_level.h"

namespace kelp::dump {

// The deep check of a part of fog (see deep_check.h): what empty bricks promise (bit for bit), whether bricks agree about the samples that they share, and every
// level's samples and extinction against the next finer one. Where bricks disagree it is unsure what a level means: the rest about it is then left out.
void checkFogDeeply(PackFile& file, int part, int threads, VerifyReport& report);

// Memory that this takes at most for a level of `voxels` voxels, beside what fields::peakBytes tells.
std::uint64_t deepFogBytes(std::uint64_t voxels, int channels);

}  // namespace kelp::dump
