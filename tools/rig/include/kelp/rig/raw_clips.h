// SPDX-License-Identifier: MIT
// Clips, sockets and rest rigs of a finished pack, as rigs and edits of rigs handle them.
#pragma once

#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/rig/rig.h"

namespace kelp {

// Copies of a pack's clips and sockets.
std::vector<RawClip> rawClips(const Pack& pack);
std::vector<RawSocket> rawSockets(const Pack& pack);
// The rest rig of a part as plain structs.
RestRig restRig(const Part& part);

}  // namespace kelp
