// SPDX-License-Identifier: MIT
// How rays go through the fog of a sheared part: after fog.glsl. The curves are those of trace.glsl.

#ifdef KELP_FOG_SHADOW
float kelpFogSun(vec3 o, vec3 r, inout int steps) {
  int level = kelp_level;
  kelpLoadLevel(min(level + 2, level + kelp_coarser));
  float depth = 0.0;
  KelpWalk walk = kelpEnter(o, r, 0.0, length(kelp_bounds_max - kelp_bounds_min));
  while (walk.going && depth < KELP_FOG_DEEP && steps < KELP_FOG_STEPS) {
    KelpCurve c = kelpWalkCurve(walk, o, r);
    depth = kelpFogShade(c, walk.end, depth, steps);
    walk = kelpWalkOn(walk, r, c);
  }
  kelpLoadLevel(level);
  return exp(-depth);
}
#endif

KelpFog kelpFogThrough(vec3 o, vec3 r, float s_min, float s_max, vec3 sun, vec3 sun_at, KelpFog before) {
  KelpFog fog = before;
  KelpWalk walk = kelpEnter(o, r, s_min, s_max);
  int halves = 2 * kelp_segment_count;
  while (walk.going && halves > 0) {
    --halves;
    KelpCurve c = kelpWalkCurve(walk, o, r);
    fog = kelpFogAlong(c, o, r, walk.end, sun, sun_at, fog);
    if (fog.depth >= KELP_FOG_DEEP) break;
    walk = kelpWalkOn(walk, r, c);
  }
  return fog;
}
