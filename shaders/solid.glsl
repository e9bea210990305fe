// SPDX-License-Identifier: MIT
// The texts that trace and shade solid parts, in their order.

#include "uniforms.glsl"
#include "instance.glsl"
#include "spline.glsl"
#include "curve.glsl"
#include "trace.glsl"
#include "arc.glsl"
#include "sweep_record.glsl"
#include "sweep.glsl"
#include "cage.glsl"
#include "cage_walk.glsl"
#include "cage_tree.glsl"
#ifdef KELP_DISTANCES
#include "distance.glsl"
#endif
#include "surface.glsl"
#include "shading.glsl"
