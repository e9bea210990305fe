// SPDX-License-Identifier: MIT
// How rays go through the fog of a swept part: after fog.glsl, arc.glsl and sweep.glsl.
//
// In the slice of an arc a straight ray has its place at rest in closed form, but no polynomial. So it is cut
// into pieces, and in each it is replaced by the cubic that has the same places and slopes at both ends. Seen
// from the axis of curvature, at its distance g / k, a piece of the length h moves by the angle a = h k / g
// at most. The fourth derivative of x and z is at most 3 w^4 / R^3, and that of y at most 6 (w / R)^4 rise /
// k (R: the least distance from the axis, w: the ray's speed in the plane of the arc). Such a cubic errs by
// 1/384 of that times h^4, so by no more than max(rise, 1) a^4 / (64 k): a follows from how far off it may
// be.
//
// Where slices overlap, because coils do, densities add. The light of such a place is dimmed as if one slice
// came after the other.

// How far curves may be from the ray, voxels of the level; and those of shadows, which are coarse themselves.
#define KELP_FOG_OFF 0.001953125
#define KELP_FOG_SHADE_OFF 0.03125

// A ray in the slice of an arc, voxels of the level. `at` and `way`: its place where it enters and its
// change: inward, along, across.
struct KelpSlice {
  vec3 at;
  vec3 way;
  float curvature;
  float speed;  // in the plane of the arc
  float angle;  // of a piece, at most
  float rise;
  float middle_y;
  vec2 bend;
  vec3 half_extent;
};
KelpSlice kelpSlice(KelpArc g, vec3 o, vec3 r, float s, float most_off) {
  KelpSlice slice;
  vec3 across = cross(g.inward, g.along);
  vec3 e = (o - g.middle) + s * r;
  slice.at = kelp_level_scale * vec3(dot(e, g.inward), dot(e, g.along), dot(e, across));
  slice.way = kelp_level_scale * vec3(dot(r, g.inward), dot(r, g.along), dot(r, across));
  slice.curvature = g.curvature / kelp_level_scale;
  slice.speed = length(slice.way.xy);
  slice.angle = min(sqrt(sqrt(64.0 * most_off * slice.curvature / max(g.rise, 1.0))), 0.5);
  slice.rise = g.rise;
  slice.middle_y = kelp_level_scale * g.y;
  slice.bend = g.bend;
  slice.half_extent = 0.5 * kelp_level_scale * kelp_size;
  return slice;
}

// A place on it, at rest.
struct KelpSlicePlace {
  vec3 q;
  vec3 slope;    // dq / ds
  float room;    // 1 - k u
  float inward;  // du / ds
};
KelpSlicePlace kelpSlicePlace(KelpSlice slice, float s) {
  vec3 e = slice.at + s * slice.way;
  float k = slice.curvature;
  float kp = 1.0 - k * e.x;
  float kl = k * e.y;
  KelpSlicePlace place;
  place.room = max(sqrt(kp * kp + kl * kl), 1e-6);
  place.inward = (slice.way.x * kp - slice.way.y * kl) / place.room;
  float u = (2.0 * e.x - k * dot(e.xy, e.xy)) / (1.0 + place.room);
  float tangent = e.y / max(kp, 1e-3);
  float a = tangent * kelpArcTangent(k * k * tangent * tangent);
  float along = (slice.way.y * kp + slice.way.x * kl) / (place.room * place.room);
  vec2 c = slice.bend;
  place.q = vec3(c.x * u - c.y * e.z, slice.middle_y + slice.rise * a, c.y * u + c.x * e.z) +
            vec3(slice.half_extent.x, 0.0, slice.half_extent.z);
  place.slope = vec3(c.x * place.inward - c.y * slice.way.z, slice.rise * along,
                     c.y * place.inward + c.x * slice.way.z);
  return place;
}

// How long the piece that begins there may be.
float kelpPieceLength(KelpSlice slice, KelpSlicePlace from) {
  // The distance from the axis shrinks by no more than its slope here.
  float speed = slice.curvature * (slice.speed + slice.angle * max(from.inward, 0.0));
  return speed > 1e-12 ? slice.angle * from.room / speed : KELP_NEVER;
}
// From one place to another, `way` apart.
KelpCurve kelpPiece(KelpSlicePlace from, KelpSlicePlace to, float s, float way) {
  vec3 chord = (to.q - from.q) / way;
  KelpCurve c;
  c.q0 = from.q;
  c.c1 = from.slope;
  c.c2 = (3.0 * chord - 2.0 * from.slope - to.slope) / way;
  c.c3 = (from.slope + to.slope - 2.0 * chord) / (way * way);
  c.s = vec4(s, 1.0, 0.0, 0.0);
  c.t0 = 0.0;
  c.rate = 0.0;
  c.end = way;
  return c;
}

// Where the ray is nearer to the axis than the part, so that it has no place at rest, or a wild one. x > y:
// nowhere.
vec2 kelpSliceHole(KelpSlice slice) {
  float k = slice.curvature;
  float most_u = abs(slice.bend.x) * slice.half_extent.x + abs(slice.bend.y) * slice.half_extent.z;
  float least = 0.75 * max(1.0 - k * most_u, 0.01);
  vec2 from_axis = vec2(1.0 - k * slice.at.x, -k * slice.at.y);
  float a = k * k * slice.speed * slice.speed;
  float b = -k * dot(slice.way.xy, from_axis);
  float d = b * b - a * (dot(from_axis, from_axis) - least * least);
  if (!(d > 0.0 && a > 1e-20)) return vec2(1.0, 0.0);
  return vec2(-b - sqrt(d), -b + sqrt(d)) / a;
}

// Where o + s r is in slice i. Without the overlap at joints, in which fog would count twice.
vec2 kelpFogRange(KelpArc g, int i, vec3 o, vec3 r, vec2 range) {
  vec4 apart = vec4(0.0, 0.0, 0.0, KELP_JOINT_OVERLAP);
  return kelpArcRange(g, KELP_JOINT_PLANE(i) - apart, KELP_JOINT_PLANE(i + 1) + apart, 0.5 * kelp_size, o, r,
                      range);
}

#ifdef KELP_FOG_SHADOW
float kelpFogSun(vec3 o, vec3 r, inout int steps) {
  int level = kelp_level;
  kelpLoadLevel(min(level + 2, level + kelp_coarser));
  float depth = 0.0;
  for (int i = 0; i < kelp_arc_count && depth < KELP_FOG_DEEP; ++i) {
    if (!kelpMeetsBall(KELP_ARC_BALL(i), o, r, vec2(0.0, KELP_NEVER))) continue;
    KelpArc g = KELP_ARC(i);
    vec2 range = kelpFogRange(g, i, o, r, vec2(0.0, KELP_NEVER));
    if (!(range.x < range.y)) continue;
    KelpSlice slice = kelpSlice(g, o, r, range.x, KELP_FOG_SHADE_OFF);
    vec2 hole = kelpSliceHole(slice);
    float end = range.y - range.x;
    float s = 0.0;
    KelpSlicePlace from = kelpSlicePlace(slice, s);
    while (s < end && depth < KELP_FOG_DEEP && steps < KELP_FOG_STEPS) {
      ++steps;
      if (s >= hole.x && s < hole.y) {
        s = kelpAdvance(hole.y, 0.0);
        from = kelpSlicePlace(slice, s);
        continue;
      }
      float way = min(kelpPieceLength(slice, from), (s < hole.x ? min(end, hole.x) : end) - s);
      KelpSlicePlace to = kelpSlicePlace(slice, s + way);
      depth = kelpFogShade(kelpPiece(from, to, range.x + s, way), KELP_NEVER, depth, steps);
      s = kelpAdvance(s, way);
      from = to;
    }
  }
  kelpLoadLevel(level);
  return exp(-depth);
}
#endif

// Through one slice, which the ray enters at s0.
KelpFog kelpFogSlice(int i, vec3 o, vec3 r, vec2 within, vec3 sun, vec3 sun_at, KelpFog before) {
  KelpFog fog = before;
  KelpArc g = KELP_ARC(i);
  vec2 range = kelpFogRange(g, i, o, r, within);
  KelpSlice slice = kelpSlice(g, o, r, range.x, KELP_FOG_OFF);
  vec2 hole = kelpSliceHole(slice);
  float end = range.y - range.x;
  float s = 0.0;
  fog.s = KELP_NEVER;
  KelpSlicePlace from = kelpSlicePlace(slice, s);
  while (s < end && fog.depth < KELP_FOG_DEEP && fog.steps < KELP_FOG_STEPS) {
    ++fog.steps;
    if (s >= hole.x && s < hole.y) {
      s = kelpAdvance(hole.y, 0.0);
      from = kelpSlicePlace(slice, s);
      continue;
    }
    float way = min(kelpPieceLength(slice, from), (s < hole.x ? min(end, hole.x) : end) - s);
    KelpSlicePlace to = kelpSlicePlace(slice, s + way);
    KelpCurve c = kelpPiece(from, to, range.x + s, way);
    fog = kelpFogAlong(c, o, r, KELP_NEVER, sun, sun_at, fog);
    s = kelpAdvance(s, way);
    from = to;
  }
  fog.s = min(fog.s, before.s);
  return fog;
}

KelpFog kelpFogThrough(vec3 o, vec3 r, float s_min, float s_max, vec3 sun, vec3 sun_at, KelpFog before) {
  KelpFog fog = before;
  vec2 range = kelpBoundsRange(o, r, vec2(s_min, s_max));
  KelpNext next = kelpNoSlices();
  bool more = range.x <= range.y;
  while (more) {
    next = kelpNextSlices(next, o, r, range);
    for (int n = 0; n < 4 && next.s0 < KELP_NEVER && fog.depth < KELP_FOG_DEEP; ++n) {
      fog = kelpFogSlice(next.arc0, o, r, range, sun, sun_at, fog);
      next = kelpBehindFirst(next);
    }
    more = next.more && fog.depth < KELP_FOG_DEEP;
  }
  return fog;
}
