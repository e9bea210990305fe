// SPDX-License-Identifier: MIT
// A ray in one half of a spline segment, as a curve in the undeformed volume, and how far it may go there.
//
// The second text of the tracing core, after spline.glsl. It needs KELP_FN alone. Here is why no solid voxel
// is skipped: kelpStep and kelpOutsideStep return lower bounds of where something solid can be.

// A solid voxel is found even if it is shrunk by this much on every side; nothing smaller is promised. It
// also covers the rounding of float32: a curve along a voxel's face, or one whose parameter can no longer
// change, still advances.
#define KELP_ERODE 0.00390625f
#define KELP_NEVER 1e18f

// The image of the ray in level space, inside one half of a segment (t below or above 1/2):
// q(b) = q0 + b (c1 + b (c2 + b c3)), b in [0, end]. In a half its terms are small enough for float32 at 4096
// voxels.
// The spline parameter is t = t0 + b * rate, the ray parameter s(b) = s.x + b (s.y + b (s.z + b s.w)).
struct KelpCurve {
  vec3 q0;
  vec3 c1;
  vec3 c2;
  vec3 c3;
  vec4 s;
  float t0;
  float rate;
  float end;
};

// The curve that starts at spline parameter t0 and ray parameter s0. `y`: that point's height in part space.
// `base`: the spline's lowest height. `stretch`: the volume's height over the spline's (the paper divides by
// the distance between the base planes). `scale`: voxels of the level per level-0 voxel.
// Along the ray s = (S.y(t) - o.y) / r.y, so every coordinate is a cubic in t. With b = (t - t0) / r.y
// nothing is divided that may vanish.
KELP_FN KelpCurve kelpMakeCurve(KelpSegment g, vec3 o, vec3 r, float s0, float t0, float y, float base,
                                float stretch, float scale) {
  float ry = r.y;
  vec3 slope = kelpSplineSlope(g, t0);
  if (abs(ry) < 1e-12f) {  // horizontal: a straight line at one height; b is the distance along it
    ry = 0.0f;
    slope.y = 1.0f;
  }
  vec3 bend = kelpSplineBend(g, t0);
  vec3 twist = g.m0 + g.m1 - 2.0f * (g.p1 - g.p0);
  vec3 at = kelpSplineAt(g, t0);
  vec3 p = o + s0 * r;
  vec3 unit = vec3(scale, scale * stretch, scale);
  KelpCurve c;
  c.q0 = unit * vec3(p.x - at.x, y - base, p.z - at.z);
  c.c1 = unit * (r * slope.y - ry * vec3(slope.x, 0.0f, slope.z));
  c.c2 = unit * (ry * (r * bend.y - ry * vec3(bend.x, 0.0f, bend.z)));
  c.c3 = unit * ((ry * ry) * (r * twist.y - ry * vec3(twist.x, 0.0f, twist.z)));
  c.s = vec4(s0, slope.y, ry * bend.y, ry * ry * twist.y);
  c.t0 = t0;
  c.rate = ry;
  float t_end = ry > 0.0f ? (t0 < 0.5f ? 0.5f : 1.0f) : (t0 > 0.5f ? 0.5f : 0.0f);
  c.end = ry != 0.0f ? (t_end - t0) / ry : KELP_NEVER;
  return c;
}
KELP_FN vec3 kelpCurveAt(KelpCurve c, float b) { return c.q0 + b * (c.c1 + b * (c.c2 + b * c.c3)); }
KELP_FN vec3 kelpCurveSlope(KelpCurve c, float b) { return c.c1 + b * (2.0f * c.c2 + (3.0f * b) * c.c3); }
KELP_FN float kelpCurveRay(KelpCurve c, float b) { return c.s.x + b * (c.s.y + b * (c.s.z + b * c.s.w)); }

// b + x, but always a little further: float32 must not stall.
KELP_FN float kelpAdvance(float b, float x) {
  float next = b + x;
  return next > b ? next : intBitsToFloat(floatBitsToInt(b) + 2);
}

// A lower bound of the first x in (0, range] with w1 x + w2 x^2 + w3 x^3 = gap, gap > 0. KELP_NEVER: none.
KELP_FN float kelpFirstReach(float gap, float w1, float w2, float w3, float range) {
  float w = w2 + max(w3, 0.0f) * range;
  float k = w1 * w1 + 4.0f * w * gap;
  float root = sqrt(max(k, 0.0f));
  float x = w1 > 0.0f ? 2.0f * gap / (w1 + root) : (root - w1) / (2.0f * max(w, 1e-30f));
  return (k < 0.0f || (w1 <= 0.0f && w <= 0.0f)) ? KELP_NEVER : x;
}

// How far beside the box [0, extent] in x and z the point q is; at most 0 inside.
KELP_FN vec3 kelpBeside(vec3 q, vec3 extent) { return max(-q, q - extent) - vec3(KELP_ERODE); }

// Beside the volume: how far b may go until the curve can first reach the slabs in x and z that it is outside
// of.
KELP_FN float kelpOutsideStep(KelpCurve c, float b, vec3 q, vec3 gap) {
  vec3 half_bend = c.c2 + (3.0f * b) * c.c3;
  vec3 slope = c.c1 + b * (c.c2 + half_bend);
  float range = c.end - b;
  float x = 0.0f;
  float towards_x = q.x > 0.0f ? -1.0f : 1.0f;
  float towards_z = q.z > 0.0f ? -1.0f : 1.0f;
  if (gap.x > 0.0f)
    x = kelpFirstReach(gap.x + 0.5f * KELP_ERODE, towards_x * slope.x, towards_x * half_bend.x,
                       towards_x * c.c3.x, range);
  if (gap.z > 0.0f)
    x = max(x, kelpFirstReach(gap.z + 0.5f * KELP_ERODE, towards_z * slope.z, towards_z * half_bend.z,
                              towards_z * c.c3.z, range));
  return x;
}

// How far b may go from q, which lies in an empty box (except for rounding), when nothing solid is nearer to
// q's brick than `clearance`: to where the curve can first leave the box (enlarged by KELP_ERODE), or along
// an arc as long as the clearance, whichever is farther.
KELP_FN float kelpStep(KelpCurve c, float b, vec3 q, vec3 center, vec3 half_size, float clearance) {
  vec3 half_bend = c.c2 + (3.0f * b) * c.c3;
  vec3 slope = c.c1 + b * (c.c2 + half_bend);
  float speed2 = max(dot(slope, slope), 1e-30f);
  float per_speed = inversesqrt(speed2);
  vec3 twists = abs(c.c3);
  float range = c.end - b;

  // Exit from the box, per axis: through the face ahead, or, where the curve may turn around, through the one
  // behind. Over [0, limit] the cubic term is bounded by its value at `limit`, which leaves quadratics.
  float limit = min(2.08f * length(half_size) * per_speed, range);
  vec3 ahead_sign =
      vec3(slope.x < 0.0f ? -1.0f : 1.0f, slope.y < 0.0f ? -1.0f : 1.0f, slope.z < 0.0f ? -1.0f : 1.0f);
  vec3 from_center = ahead_sign * (q - center);
  vec3 along = abs(slope);
  vec3 bends = ahead_sign * half_bend;
  vec3 room = half_size + vec3(KELP_ERODE);
  vec3 ahead = max(room - from_center, vec3(0.25f * KELP_ERODE));
  vec3 behind = max(room + from_center, vec3(0.25f * KELP_ERODE));
  vec3 high = bends + limit * twists;
  vec3 low = bends - limit * twists;
  vec3 k = along * along + 4.0f * high * ahead;
  vec3 root_ahead = sqrt(max(k, vec3(0.0f)));
  vec3 root_behind = sqrt(along * along - 4.0f * min(low, vec3(0.0f)) * behind);
  vec3 x_ahead = 2.0f * ahead / max(along + root_ahead, vec3(1e-30f));
  vec3 x_behind = (along + root_behind) / max(-2.0f * low, vec3(1e-30f));
  float leave = limit;
  leave = min(leave, k.x >= 0.0f ? x_ahead.x : KELP_NEVER);
  leave = min(leave, k.y >= 0.0f ? x_ahead.y : KELP_NEVER);
  leave = min(leave, k.z >= 0.0f ? x_ahead.z : KELP_NEVER);
  leave = min(leave, low.x < -1e-20f ? x_behind.x : KELP_NEVER);
  leave = min(leave, low.y < -1e-20f ? x_behind.y : KELP_NEVER);
  leave = min(leave, low.z < -1e-20f ? x_behind.z : KELP_NEVER);

  // The arc over x is no longer than |q'| x + |q''|/2 x^2 + |c3| x^3.
  float speed = speed2 * per_speed;
  float curvature = length(half_bend) + length(c.c3) * min(clearance * per_speed, range);
  return max(leave, 2.0f * clearance / (speed + sqrt(speed2 + 4.0f * curvature * clearance)));
}

// The empty box that a code promises around its voxel, in voxels. `within_brick`: cut at the brick's faces.
struct KelpBox {
  vec3 center;
  vec3 half_size;
};
KELP_FN KelpBox kelpCodeBox(uint code, ivec3 voxel, bool within_brick) {
  KelpBox box;
  box.center = vec3(float(voxel.x) + 0.5f, float(voxel.y) + 0.5f, float(voxel.z) + 0.5f);
  box.half_size = vec3(float(1u << (code & 3u)) - 0.5f, float(1u << ((code >> 2u) & 3u)) - 0.5f,
                       float(1u << (code >> 4u)) - 0.5f);
  if (within_brick) {
    vec3 corner =
        vec3(float(voxel.x - (voxel.x & 7)), float(voxel.y - (voxel.y & 7)), float(voxel.z - (voxel.z & 7)));
    vec3 low = max(box.center - box.half_size, corner);
    vec3 high = min(box.center + box.half_size, corner + vec3(8.0f));
    box.center = 0.5f * (low + high);
    box.half_size = 0.5f * (high - low);
  }
  return box;
}

// The box of empty bricks that the cell of an empty brick promises, in voxels.
KELP_FN KelpBox kelpCellBox(uint cell, ivec3 brick) {
  vec3 down = vec3(float(cell & 15u), float((cell >> 8u) & 15u), float((cell >> 16u) & 15u));
  vec3 up = vec3(float((cell >> 4u) & 15u), float((cell >> 12u) & 15u), float((cell >> 20u) & 15u));
  KelpBox box;
  box.center =
      vec3(8.0f * float(brick.x) + 4.0f, 8.0f * float(brick.y) + 4.0f, 8.0f * float(brick.z) + 4.0f) +
      4.0f * (up - down);
  box.half_size = vec3(4.0f) + 4.0f * (up + down);
  return box;
}
