// SPDX-License-Identifier: MIT
#pragma once

#include "finding.h"
#include "pack_file.h"

namespace kelp::dump {

// Recomputes what a pack's voxels imply, level by level and part by part, and appends to `report` whatever differs from what is stored:
//   what every empty brick and voxel promises to be empty around it (bit for bit), occupancy of each level against the next finer one, and
//   which voxels have an attribute (the surface at level 0; above, those over a surface voxel). Of fog, see deep_fog.h.
// Parts for which `report` already lists errors are left alone: what their voxels mean is unsure. DumpError (kFailure) if memory can not hold the
// largest level.
void checkDeeply(PackFile& file, VerifyReport& report);

}  // namespace kelp::dump
