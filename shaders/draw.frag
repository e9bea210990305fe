// SPDX-License-Identifier: MIT
// Traces the pixel's ray through a posed part, calls kelpSurface with the hit, writes real depth.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "solid.glsl"
#ifdef KELP_DEBUG
#include "debug.glsl"
#elif defined(KELP_HOST_SURFACE)
#include "kelp_surface.glsl"
#endif
#include "pixel.glsl"
#include "output.glsl"

layout(location = 0) out vec4 kelp_color;

// Where the point of a hit was in clip space in the frame before.
vec4 kelpPreviousClip(KelpHit hit) {
  vec3 rest = hit.rest;
  if (KELP_CAGED) {
    int rows = kelpTreeAt() + 4 * kelpCageLeaves();
    int nodes = rows + 4;
    uvec4 corners = kelpCageCorners(hit);
    vec4 shares = kelpCageShares(hit);
    vec4 at = shares.x * kelpRecord(nodes + int(corners.x)) + shares.y * kelpRecord(nodes + int(corners.y)) +
              shares.z * kelpRecord(nodes + int(corners.z)) + shares.w * kelpRecord(nodes + int(corners.w));
    return kelpRows(rows, kelpRecord(rows + 3)) * vec4(at.xyz, 1.0);
  }
  if (KELP_SWEPT) {
    int rows = kelpJointsAt() + 2 * (kelp_arc_count + 1);
    int count = min(int(kelpRecordBits(rows + 4).x), KELP_MAX_ARCS);
    int arcs = rows + 5;
    int joints = arcs + 4 * count;
    int i = 0;
    while (i + 1 < count && rest.y > kelpRecord(joints + 2 * i + 3).w) ++i;
    vec3 at =
        kelpSweepPoint(kelpArcOf(arcs, i), rest.x - 0.5 * kelp_size.x, rest.y, rest.z - 0.5 * kelp_size.z);
    return kelpRows(rows, kelpRecord(rows + 3)) * vec4(at, 1.0);
  }
  int rows = kelp_record + KELP_RECORD + 3 * kelp_segment_count;
  int spline = rows + 4;
  float low = kelpP0(spline, 0).y;
  float y = low + rest.y / kelp_size.y * (kelpP1(spline, kelp_segment_count - 1).y - low);
  int i = 0;
  while (i + 1 < kelp_segment_count && y > kelpP1(spline, i).y) ++i;
  KelpSegment g = KELP_SEGMENT_AT(spline, i);
  vec3 shift = kelpSplineAt(g, kelpSplineParameter(g, y - g.p0.y, g.p1.y - y));
  return kelpRows(rows, kelpRecord(rows + 3)) * vec4(rest.x + shift.x, y, rest.z + shift.z, 1.0);
}

// The color of a hit; clip: where it is in clip space.
vec4 kelpShade(KelpHit hit, vec3 position, vec3 ray, vec4 clip) {
  kelpLoadLevel(kelp_level + hit.coarser);
  KelpSurface s = kelpSurfaceAt(hit, position, ray);
  s.clip = clip;
  s.previous_clip = kelp_motion ? kelpPreviousClip(hit) : clip;
  return kelpSurface(s);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  KelpPixelRay p = kelpPixelRay(pixel);
  if (!p.good) discard;
  kelp_jitter = kelpJitter(vec2(pixel));
  int level = kelpPixelLevel(pixel);
  if (!kelpLoadLevel(level)) discard;
#ifdef KELP_CAGED_ONLY
  KelpHit hit = kelpWalkCaged(kelp_face, kelp_near, p.ray, p.range.x, p.range.y);
#else
  KelpHit hit = kelpTrace(kelp_near, p.ray, p.range.x, p.range.y);
#endif
  if (!hit.found) discard;

  vec4 clip = p.clip_at + hit.s * p.clip_slope;
  gl_FragDepth = kelpDepthOf(clip);
  kelp_color =
      kelp_depth_only ? vec4(0.0) : kelpOutput(kelpShade(hit, kelp_near + hit.s * p.ray, p.ray, clip));
}
