// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "kelp/formats/raw_pack.h"

namespace kelp::dump {

// The clips of a pack, to be changed or described.
std::vector<RawClip> rawClips(const Pack& pack);

// What they do to each part, as clips of their own: those that do nothing to it are left out. A clip of several parts is as long as the longest of them
// asks for, so a share has the length that it asks for itself; where a clip is longer or shorter than what is in it, that is kept.
std::vector<std::vector<RawClip>> clipsOfParts(const std::vector<RawClip>& clips, std::size_t parts);

}  // namespace kelp::dump
