// SPDX-License-Identifier: MIT
// Where and how large a model is in the object: its up axis, its unit, and the empty voxels around it.
#pragma once

#include "frame.h"

namespace kelp::bake {

// Units a file may be in; metres.
inline constexpr double kSmallestUnit = 1e-6, kLargestUnit = 1e6;
inline constexpr int kMaxPad = 1024;

// Turns Settings::up to the object's +y and scales by Settings::unit: only matrices change, so voxels, rigs and clips stay in the file's own axes and units.
void placeInObject(SourceModel& model, const Settings& settings);

// Settings::pad in voxels a side, by axis. Not along y where a rig bends the part: the rig's unit is the source's length, and its spline ends where the box does.
glm::ivec3 paddingOf(const SourcePart& part, int pad);
void padFrame(Frame& frame, const glm::ivec3& pad);
void padGrid(VoxelGrid& grid, const glm::ivec3& pad);
void padFog(FogGrid& fog, const glm::ivec3& pad);

}  // namespace kelp::bake
