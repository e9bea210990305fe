// SPDX-License-Identifier: MIT
#pragma once

#include "pack/pack_file.h"
#include "verify/finding.h"

namespace kelp::dump {

// Recomputes what the voxels imply and appends to `report` every difference from what is stored. For each
// level of each solid part it compares: the clearances of all empty bricks, to the voxel; the
// occupancy with that of the next finer level; which voxels have an attribute (at level 0 the surface, above
// it the voxels over a surface voxel). deep_fog.h does the same for fog.
//
// Parts for which `report` lists errors already are left out, as nobody can say what their voxels mean.
// ToolError kRuntime if memory cannot hold the largest level.
void checkDeeply(PackFile& file, VerifyReport& report);

}  // namespace kelp::dump
