// SPDX-License-Identifier: MIT
// Rays through posed instances for a host's own shaders: mirrors, shadows, picking on the GPU.
// kelp::gl::Renderer::traceGlsl() returns this text with everything that it needs; bindTrace() sets the
// instances.
//
//     KelpSceneHit hit = kelpTrace(origin, direction, t_max);  // world; t in lengths of `direction`
//     if (hit.found) color = kelpSurface(hit.surface);         // kelp's own look, or yours (surface.glsl)
//     bool shadow = kelpBlocked(origin, direction, t_max);     // any hit: for shadows, and cheaper
//     float distance = kelpDistance(point);                    // with Features::kDistances
//
// For vertex and fragment shaders. A ray that starts on a surface should start a little off it, or it meets
// that surface. Right after kelpTrace, kelpVisible and kelpOccluded refer to the part that was hit. kelpTrace
// with four parameters is the core's (trace.glsl), in the space of one part. `direction` may have any length
// but 0.
//
// Cost: each ray tests the deformed bounds of every part, and traces the parts whose bounds it meets.

#include "solid.glsl"

#define KELP_MAX_PARTS 1048576  // more than there can be

struct KelpSceneHit {
  bool found;
  float t;              // position = origin + t * direction
  KelpSurface surface;  // undefined if nothing was found
};

// The nearest hit, or, with `any`, the first hit found. t: where it is, or t_max. Loads the part's record and
// level.
KelpHit kelpTraceParts(vec3 origin, vec3 direction, float t_max, bool any, out float t) {
  KelpHit nearest;
  nearest.found = false;
  t = t_max;
  int texel = 0;
  int level = 0;
  int count = min(kelp_part_count, KELP_MAX_PARTS);
  for (int i = 0; i < count; ++i) {
    kelpLoadRecord(kelpRecordOf(i));
    mat4 to_part = kelpRows(kelp_record, vec4(0.0, 0.0, 0.0, 1.0));
    vec3 o = (to_part * vec4(origin, 1.0)).xyz;
    vec3 d = mat3(to_part) * direction;
    float speed = length(d);  // voxels for each t
    if (!(speed > 0.0)) continue;
    vec3 slope = mix(d, vec3(1e-12 * speed), lessThan(abs(d), vec3(1e-12 * speed)));
    vec3 low = (kelp_bounds_min - o) / slope;
    vec3 high = (kelp_bounds_max - o) / slope;
    vec3 enter = min(low, high);
    vec3 leave = max(low, high);
    float t0 = max(max(max(enter.x, enter.y), enter.z), 0.0);
    float t1 = min(min(min(leave.x, leave.y), leave.z), t);
    if (!(t0 <= t1)) continue;
    if (!kelpLoadLevel(int(kelpRecordBits(kelp_record + 11).w & 255u))) continue;
    // s = 0 where the ray enters, so that numbers are small where the voxels are.
    KelpHit hit = kelpTrace(o + t0 * d, d / speed, 0.0, (t1 - t0) * speed);
    if (!hit.found) continue;
    nearest = hit;
    t = t0 + hit.s / speed;
    texel = kelp_record;
    level = kelp_level + hit.coarser;
    if (any) break;
  }
  if (nearest.found && !any) {
    kelpLoadRecord(texel);
    kelpLoadLevel(level);
  }
  return nearest;
}

KelpSceneHit kelpTrace(vec3 origin, vec3 direction, float t_max) {
  KelpSceneHit result;
  KelpHit hit = kelpTraceParts(origin, direction, t_max, false, result.t);
  result.found = hit.found;
  if (hit.found) {
    mat4 to_part = kelpRows(kelp_record, vec4(0.0, 0.0, 0.0, 1.0));
    kelp_jitter = kelpJitter(vec2(hit.voxel.xy + 37 * hit.voxel.z));
    result.surface = kelpSurfaceAt(hit, (to_part * vec4(origin + result.t * direction, 1.0)).xyz,
                                   normalize(mat3(to_part) * direction));
  }
  return result;
}

bool kelpBlocked(vec3 origin, vec3 direction, float t_max) {
  float t;
  return kelpTraceParts(origin, direction, t_max, true, t).found;
}

#ifdef KELP_DISTANCES
// How far a point is from the nearest solid part, in the world; negative inside. An estimate: distance.glsl.
// kKelpFar if there is none whose distances are uploaded.
float kelpDistance(vec3 point) {
  float nearest = kKelpFar;
  int count = min(kelp_part_count, KELP_MAX_PARTS);
  for (int i = 0; i < count; ++i) {
    kelpLoadRecord(kelpRecordOf(i));
    kelpLoadDistances();
    vec3 p = (kelpRows(kelp_record, vec4(0.0, 0.0, 0.0, 1.0)) * vec4(point, 1.0)).xyz;
    float voxel = length(kelpPartToWorld()[0]);
    vec3 gap = max(max(kelp_bounds_min - p, p - kelp_bounds_max), vec3(0.0));
    if (kelp_distance_levels == 0 || voxel * length(gap) >= nearest) continue;
    nearest = min(nearest, voxel * kelpPartDistance(p));
  }
  return nearest;
}
#endif
