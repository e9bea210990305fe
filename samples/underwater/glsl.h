// SPDX-License-Identifier: MIT
// The .glsl, .vert and .frag files of this folder as text, embedded when kelp is built.
#pragma once

namespace underwater::glsl {

extern const char* const kWater;
extern const char* const kVoxels;
extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;
extern const char* const kFloorVertex;
extern const char* const kFloorFragment;

}  // namespace underwater::glsl
