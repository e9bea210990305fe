// SPDX-License-Identifier: MIT
// Clips, sockets and rest rigs of a finished pack, as rigs and edits of rigs handle them.
#pragma once

#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// Copies of a pack's clips and sockets.
std::vector<RawClip> rawClips(const Pack& pack);
std::vector<RawSocket> rawSockets(const Pack& pack);
// The rest rig of a part as plain structs.
RawRig rawRig(const Part& part);

// For each part, the clips that move it, with only the waves and tracks of that part. A clip of several parts
// is as long as the longest share needs, so each share gets the length that it needs itself. A clip whose
// length is not what its content needs keeps that length.
std::vector<std::vector<RawClip>> clipsOfParts(const std::vector<RawClip>& clips, std::size_t parts);

}  // namespace kelp
