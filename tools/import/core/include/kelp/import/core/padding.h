// SPDX-License-Identifier: MIT
// The empty voxels around a part.
#pragma once

#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

inline constexpr int kMaxPad = 1024;

// The padding in voxels on each side, by axis. None along y where places along the part's axis matter,
// because a rig bends the part, it has sockets, or another part hangs on it: the rig's unit is the part's
// height.
glm::ivec3 paddingOf(const SourcePart& part, int pad);
void padFrame(Frame& frame, const glm::ivec3& pad);
void padGrid(VoxelGrid& grid, const glm::ivec3& pad);
void padFog(FogGrid& fog, const glm::ivec3& pad);

}  // namespace kelp::bake
