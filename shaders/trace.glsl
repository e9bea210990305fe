// SPDX-License-Identifier: MIT
// The tracing core: where does a straight ray through the deformed world first meet a solid voxel of the undeformed volume?
//
// One text for GLSL 3.30, GLSL ES 3.00 and C++20 with GLM; the GPU, the CPU queries and the tests run it. Hence the subset: `f` and `u` on
// every literal, no mixing of int, uint and float, no swizzles, fields assigned one by one. The text before it defines the macros below.
// Method: Groen et al., "Spline Based Shell Mapping for Smooth Voxel Deformation". Deviations (shaders/README.md says why):
//   - the paper marches in world space and solves a cubic per sample; here the ray is mapped once per spline segment and becomes a cubic
//     curve q(b) in the volume, so that a sample costs three multiply-adds;
//   - the paper's distance heuristic may skip voxels; here every step is bounded by a proof (kelpStep), and skips none.
//
// Spaces and units. Part space: level-0 voxels, +y along the spline, deformed: what the ray lives in. Level space: voxels of the level
// that is traced, undeformed: what q lives in. The ray's direction is a unit vector, so its parameter s is in level-0 voxels.
//
// The text before defines:
//   KELP_FN                function qualifiers (empty in GLSL)
//   KELP_CONTEXT_          first parameter of functions that read the part ("const Context& kelp_context," in C++, empty in GLSL)
//   KELP_CONTEXT           the same as an argument
//   KELP_SEGMENTS          int: number of spline segments
//   KELP_SEGMENT(i)        KelpSegment: segment i
//   KELP_BOUNDS_MIN, _MAX  vec3: a box around the deformed volume, part space
//   KELP_SIZE              vec3: size of the volume, level-0 voxels
//   KELP_LEVEL_SIZE        ivec3: size of the level, in its voxels
//   KELP_LEVEL_SCALE       float: 2^-level
//   KELP_COMPLETE          bool: every brick of the level is resident
//   KELP_COARSER           int: how many coarser levels lie over it
//   KELP_CELL(v)           uint: grid cell of brick v: empty as in formats/SPEC.md, "Voxels", or 0x80000000 and where the brick is
//   KELP_BRICK(k, cell)    uint: the brick that a stored cell of the level k levels above names; 0: not resident
//   KELP_BRICK_ABOVE(k, v) uint: brick v of the level k levels above the traced one; 0: not resident or empty
//   KELP_CODE(k, brick, v) uint: code of voxel v (modulo 8 on each axis) in that brick, which belongs to the level k levels above
//
// Bricks that are not resident are drawn as the finest coarser level that is: what is drawn at a point is what the finest resident brick
// there says, whichever way a ray comes. Coarse voxels are solid where any fine one is, so a coarse empty box is empty at all finer levels, but
// not the other way round: while the level is not complete, a step does not leave the brick that allowed it.

// A cubic from p0 to p1 for t in [0, 1], with the slopes dS/dt = m0 and m1 there (Hermite); S.y does not decrease.
struct KelpSegment {
  vec3 p0;
  vec3 m0;
  vec3 p1;
  vec3 m1;
};

// The image of the ray in level space while it is inside one half of a segment (t below or above 1/2), where its terms are small enough for
// float32 at 4096 voxels: q(b) = q0 + b (c1 + b (c2 + b c3)), b in [0, end].
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

struct KelpHit {
  bool found;
  float s;        // along the ray
  float t;        // spline parameter within the segment
  int segment;
  int coarser;    // levels between the traced one and the voxel's
  ivec3 voxel;    // of the level that many above
  uint brick;     // that holds the voxel
  uint code;      // of the voxel
  vec3 rest;      // where the hit is in the undeformed volume, level-0 voxels
  int steps;      // fetching steps taken
  int outside;    // steps taken beside the volume, without a fetch
  int fetches;
};

// A solid voxel is found even if it is shrunk by this much on every side, and nothing smaller is promised. It also keeps float32 honest: a
// curve that runs along a voxel's face, or whose parameter can no longer change, still gets on.
#define KELP_ERODE 0.00390625f
#define KELP_NEVER 1e18f
#define KELP_MAX_STEPS 16384  // far more than any ray was seen to take (1500 at 4096 voxels); a guard against the unforeseen

// S, its slope and half its bend (S''/2), measured from the nearer end: both ends and their slopes come out exactly, however steep the spline
// is beside them.
KELP_FN vec3 kelpSplineAt(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return g.p1 - u * (g.m1 + u * (3.0f * rise - 2.0f * g.m1 - g.m0 + u * a));
  return g.p0 + t * (g.m0 + t * (3.0f * rise - 2.0f * g.m0 - g.m1 + t * a));
}
KELP_FN vec3 kelpSplineSlope(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return g.m1 + u * (2.0f * (3.0f * rise - 2.0f * g.m1 - g.m0) + (3.0f * u) * a);
  return g.m0 + t * (2.0f * (3.0f * rise - 2.0f * g.m0 - g.m1) + (3.0f * t) * a);
}
KELP_FN vec3 kelpSplineBend(KelpSegment g, float t) {
  vec3 rise = g.p1 - g.p0;
  vec3 a = g.m0 + g.m1 - 2.0f * rise;
  float u = 1.0f - t;
  if (t > 0.5f) return -(3.0f * rise - 2.0f * g.m1 - g.m0 + (3.0f * u) * a);
  return 3.0f * rise - 2.0f * g.m0 - g.m1 + (3.0f * t) * a;
}

// t in [0, 1] at a height `above` p0 and `below` p1. Measured from the nearer end of the segment, where nothing cancels; a quadratic start,
// then Newton's method kept inside a shrinking bracket.
KELP_FN float kelpSplineParameter(KelpSegment g, float above, float below) {
  if (above <= 0.0f) return 0.0f;
  if (below <= 0.0f) return 1.0f;
  float rise = g.p1.y - g.p0.y;
  bool from_top = below < above;  // u = 1 - t, heights measured downwards
  float target = from_top ? below : above;
  float c = from_top ? g.m1.y : g.m0.y;
  float b = 3.0f * rise - 2.0f * c - (from_top ? g.m0.y : g.m1.y);
  float a = g.m0.y + g.m1.y - 2.0f * rise;
  float u = min(2.0f * target / max(c + sqrt(max(c * c + 4.0f * b * target, 0.0f)), 1e-20f), 1.0f);
  float low = 0.0f;
  float high = 1.0f;
  for (int i = 0; i < 16; ++i) {
    float excess = u * (c + u * (b + u * a)) - target;
    if (excess > 0.0f) { high = u; } else { low = u; }
    float next = u - excess / max(c + u * (2.0f * b + 3.0f * a * u), 1e-20f);
    next = (next >= low && next <= high) ? next : 0.5f * (low + high);
    if (next == u) break;
    u = next;
  }
  return from_top ? 1.0f - u : u;
}

// The curve from the point with spline parameter t0 and ray parameter s0 on. `y` is that point's height in part space, `base` the spline's
// lowest height, `stretch` the volume's height over the spline's: the paper divides by the distance between the base planes.
// Along the ray s = (S.y(t) - o.y) / r.y, so every coordinate is a cubic in t; b = (t - t0) / r.y divides by nothing that may vanish.
KELP_FN KelpCurve kelpMakeCurve(KelpSegment g, vec3 o, vec3 r, float s0, float t0, float y, float base, float stretch, float scale) {
  float ry = r.y;
  vec3 slope = kelpSplineSlope(g, t0);
  if (abs(ry) < 1e-12f) {  // horizontal: a straight line, however the spline runs at that height; let b be the distance along it
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

// A lower bound of the first x in (0, range] with w1 x + w2 x^2 + w3 x^3 = gap, gap > 0; KELP_NEVER if there is none.
KELP_FN float kelpFirstReach(float gap, float w1, float w2, float w3, float range) {
  float w = w2 + max(w3, 0.0f) * range;
  float k = w1 * w1 + 4.0f * w * gap;
  float root = sqrt(max(k, 0.0f));
  float x = w1 > 0.0f ? 2.0f * gap / (w1 + root) : (root - w1) / (2.0f * max(w, 1e-30f));
  return (k < 0.0f || (w1 <= 0.0f && w <= 0.0f)) ? KELP_NEVER : x;
}

// How far beside the box [0, extent] in x and z the point q is; at most 0 inside.
KELP_FN vec3 kelpBeside(vec3 q, vec3 extent) { return max(-q, q - extent) - vec3(KELP_ERODE); }

// Beside the volume: the distance in b to where the curve can first reach the slabs in x and z that it is outside of.
KELP_FN float kelpOutsideStep(KelpCurve c, float b, vec3 q, vec3 gap) {
  vec3 half_bend = c.c2 + (3.0f * b) * c.c3;
  vec3 slope = c.c1 + b * (c.c2 + half_bend);
  float range = c.end - b;
  float x = 0.0f;
  float towards_x = q.x > 0.0f ? -1.0f : 1.0f;
  float towards_z = q.z > 0.0f ? -1.0f : 1.0f;
  if (gap.x > 0.0f) x = kelpFirstReach(gap.x + 0.5f * KELP_ERODE, towards_x * slope.x, towards_x * half_bend.x, towards_x * c.c3.x, range);
  if (gap.z > 0.0f) x = max(x, kelpFirstReach(gap.z + 0.5f * KELP_ERODE, towards_z * slope.z, towards_z * half_bend.z, towards_z * c.c3.z, range));
  return x;
}

// In an empty box, which is around q but for rounding, with nothing solid nearer to q's brick than `clearance`: the distance in b that is
// safe to go. Either to where the curve can first leave the box (enlarged by KELP_ERODE), or over an arc as long as the clearance.
KELP_FN float kelpStep(KelpCurve c, float b, vec3 q, vec3 centre, vec3 half_size, float clearance) {
  vec3 half_bend = c.c2 + (3.0f * b) * c.c3;
  vec3 slope = c.c1 + b * (c.c2 + half_bend);
  float speed2 = max(dot(slope, slope), 1e-30f);
  float per_speed = inversesqrt(speed2);
  vec3 twists = abs(c.c3);
  float range = c.end - b;

  // Exit from the box, per axis: through the face ahead, or, where the curve may turn around, through the one behind. Over [0, limit] the
  // cubic term is bounded by its value at `limit`, which leaves quadratics.
  float limit = min(2.08f * length(half_size) * per_speed, range);
  vec3 ahead_sign = vec3(slope.x < 0.0f ? -1.0f : 1.0f, slope.y < 0.0f ? -1.0f : 1.0f, slope.z < 0.0f ? -1.0f : 1.0f);
  vec3 from_centre = ahead_sign * (q - centre);
  vec3 along = abs(slope);
  vec3 bends = ahead_sign * half_bend;
  vec3 room = half_size + vec3(KELP_ERODE);
  vec3 ahead = max(room - from_centre, vec3(0.25f * KELP_ERODE));
  vec3 behind = max(room + from_centre, vec3(0.25f * KELP_ERODE));
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

// The empty box that a code promises around its voxel, in voxels. `within_brick`: cut off at the brick's faces.
struct KelpBox {
  vec3 centre;
  vec3 half_size;
};
KELP_FN KelpBox kelpCodeBox(uint code, ivec3 voxel, bool within_brick) {
  KelpBox box;
  box.centre = vec3(float(voxel.x) + 0.5f, float(voxel.y) + 0.5f, float(voxel.z) + 0.5f);
  box.half_size = vec3(float(1u << (code & 3u)) - 0.5f, float(1u << ((code >> 2u) & 3u)) - 0.5f, float(1u << (code >> 4u)) - 0.5f);
  if (within_brick) {
    vec3 corner = vec3(float(voxel.x - (voxel.x & 7)), float(voxel.y - (voxel.y & 7)), float(voxel.z - (voxel.z & 7)));
    vec3 low = max(box.centre - box.half_size, corner);
    vec3 high = min(box.centre + box.half_size, corner + vec3(8.0f));
    box.centre = 0.5f * (low + high);
    box.half_size = 0.5f * (high - low);
  }
  return box;
}

// The box of empty bricks that the cell of an empty brick promises, in voxels.
KELP_FN KelpBox kelpCellBox(uint cell, ivec3 brick) {
  vec3 down = vec3(float(cell & 15u), float((cell >> 8u) & 15u), float((cell >> 16u) & 15u));
  vec3 up = vec3(float((cell >> 4u) & 15u), float((cell >> 12u) & 15u), float((cell >> 20u) & 15u));
  KelpBox box;
  box.centre = vec3(8.0f * float(brick.x) + 4.0f, 8.0f * float(brick.y) + 4.0f, 8.0f * float(brick.z) + 4.0f) + 4.0f * (up - down);
  box.half_size = vec3(4.0f) + 4.0f * (up + down);
  return box;
}

// `hit`, found at q = q(b) in a voxel of the level `coarser` levels above the traced one.
KELP_FN KelpHit kelpFound(KelpHit before, KelpCurve c, float b, int coarser, ivec3 voxel, uint brick, uint code) {
  KelpHit hit = before;
  hit.found = true;
  hit.s = kelpCurveRay(c, b);
  hit.t = clamp(c.t0 + b * c.rate, 0.0f, 1.0f);
  hit.coarser = coarser;
  hit.voxel = voxel;
  hit.brick = brick;
  hit.code = code;
  return hit;
}

// Follows one curve to its first solid voxel or its end. Fields of `hit` that count go on from their values.
// Loops that take turns, because SIMD runs the branches of one loop one after the other: beside the volume, in it, and where bricks are not
// resident. The volume is left a little further out than it is entered, so that rounding can not pass the turn to and fro.
KELP_FN KelpHit kelpMarch(KELP_CONTEXT_ KelpCurve c, float s_max, KelpHit before) {
  KelpHit hit = before;
  vec3 extent = KELP_LEVEL_SCALE * KELP_SIZE;
  ivec3 size = KELP_LEVEL_SIZE;
  vec3 last = vec3(float(size.x - 1), float(size.y - 1), float(size.z - 1));
  bool complete = KELP_COMPLETE;
  float b = 0.0f;
  bool going = b < c.end;
  while (going) {
    bool beside = true;
    while (beside) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (max(gap.x, gap.z) <= 0.5f * KELP_ERODE) break;
      ++hit.outside;
      b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
      // A number that is none, or is lost in the distance, ends the march too.
      going = b < c.end && kelpCurveRay(c, b) <= s_max && dot(gap, gap) < KELP_NEVER && hit.outside < KELP_MAX_STEPS;
      beside = going;
    }
    bool inside = going;
    bool missing = false;
    while (inside) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (!(max(gap.x, gap.z) <= 0.75f * KELP_ERODE)) break;
      ivec3 voxel = ivec3(min(max(vec3(0.0f), floor(q)), last));  // in this order: 0 where q is no number
      ivec3 at = ivec3(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3);
      uint cell = KELP_CELL(at);
      ++hit.steps;
      ++hit.fetches;
      KelpBox box;
      float clearance = 0.0f;
      if (cell >= 0x80000000u) {
        uint brick = KELP_BRICK(0, cell);
        missing = brick == 0u;
        if (missing) break;
        uint code = KELP_CODE(0, brick, voxel);
        hit.fetches += 2;
        if (code >= 64u) {
          hit = kelpFound(hit, c, b, 0, voxel, brick, code);
          going = false;
          break;
        }
        box = kelpCodeBox(code, voxel, !complete);
      } else {
        box = kelpCellBox(cell, at);
        clearance = complete ? float(cell >> 24u) : 0.0f;
      }
      b = kelpAdvance(b, kelpStep(c, b, q, box.centre, box.half_size, clearance));
      going = b < c.end && kelpCurveRay(c, b) <= s_max && hit.steps < KELP_MAX_STEPS;
      inside = going;
    }
    while (missing) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (!(max(gap.x, gap.z) <= 0.75f * KELP_ERODE)) break;
      ivec3 voxel = ivec3(min(max(vec3(0.0f), floor(q)), last));
      uint cell = KELP_CELL(ivec3(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3));
      if (cell < 0x80000000u || KELP_BRICK(0, cell) != 0u) break;
      uint brick = 0u;
      int coarser = 0;
      float side = 1.0f;  // of a coarse voxel
      while (brick == 0u && coarser < KELP_COARSER) {
        ++coarser;
        side = side + side;
        voxel = ivec3(voxel.x >> 1, voxel.y >> 1, voxel.z >> 1);
        brick = KELP_BRICK_ABOVE(coarser, ivec3(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3));
      }
      uint code = 0u;
      if (brick != 0u) code = KELP_CODE(coarser, brick, voxel);  // in a pack whose levels contradict each other there may be none
      ++hit.steps;
      hit.fetches += 2 + 2 * coarser;
      if (code >= 64u) {
        hit = kelpFound(hit, c, b, coarser, voxel, brick, code);
        going = false;
        break;
      }
      KelpBox box = kelpCodeBox(code, voxel, true);
      b = kelpAdvance(b, kelpStep(c, b, q, side * box.centre, side * box.half_size, 0.0f));
      going = b < c.end && kelpCurveRay(c, b) <= s_max && hit.steps < KELP_MAX_STEPS;
      missing = going;
    }
  }
  if (hit.found) hit.rest = kelpCurveAt(c, b) / KELP_LEVEL_SCALE;
  return hit;
}

// A ray on its way through the segments that it meets, half by half: at o + s r, r a unit vector.
struct KelpWalk {
  bool going;
  KelpSegment g;  // the one it is in
  int segment;    // its number
  float t0;       // spline parameter there
  float y;        // height there
  float s;
  float end;      // of s
  float base;     // height of the spline's low end
  float stretch;  // as in kelpMakeCurve
  float scale;
};

// Where o + s r, s in [s_min, s_max], enters the bounds. r is a unit vector, o should be near the volume (the nearer, the more exact).
KELP_FN KelpWalk kelpEnter(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpWalk walk;
  int count = KELP_SEGMENTS;
  KelpSegment top = KELP_SEGMENT(count - 1);
  KelpSegment g = KELP_SEGMENT(0);
  float y_low = g.p0.y;
  float y_high = top.p1.y;
  walk.going = false;
  walk.g = g;
  walk.segment = 0;
  walk.t0 = 0.0f;
  walk.y = 0.0f;
  walk.s = s_min;
  walk.end = s_max;
  walk.base = y_low;
  walk.stretch = KELP_SIZE.y / (y_high - y_low);
  walk.scale = KELP_LEVEL_SCALE;

  // The part of the ray inside the bounds, x and z first: the planes of y are exact, and a ray that enters through one starts at t = 0 or 1.
  float s0 = s_min;
  float s1 = s_max;
  vec3 low = KELP_BOUNDS_MIN;
  vec3 high = KELP_BOUNDS_MAX;
  if (r.x != 0.0f) {
    float sa = (low.x - o.x) / r.x;
    float sb = (high.x - o.x) / r.x;
    s0 = max(s0, min(sa, sb));
    s1 = min(s1, max(sa, sb));
  } else if (o.x < low.x || o.x > high.x) {
    return walk;
  }
  if (r.z != 0.0f) {
    float sa = (low.z - o.z) / r.z;
    float sb = (high.z - o.z) / r.z;
    s0 = max(s0, min(sa, sb));
    s1 = min(s1, max(sa, sb));
  } else if (o.z < low.z || o.z > high.z) {
    return walk;
  }
  float climb = s0 * r.y;  // beside the ends of a segment heights are differences of their own: o.y + climb would round them away
  float y = o.y + climb;
  bool through_plane = false;
  if (abs(r.y) >= 1e-12f) {
    float entry_plane = r.y > 0.0f ? y_low : y_high;
    float exit_plane = r.y > 0.0f ? y_high : y_low;
    float entry = (entry_plane - o.y) / r.y;
    if (entry >= s0) {
      s0 = entry;
      y = entry_plane;
      through_plane = true;
    }
    s1 = min(s1, (exit_plane - o.y) / r.y);
  } else if (y < y_low || y > y_high) {
    return walk;
  }
  if (!(s0 <= s1)) return walk;

  // The segment that holds that height; one root solve; then from half to half and knot to knot without another.
  int i = 0;
  float below = through_plane ? g.p1.y - y : (g.p1.y - o.y) - climb;
  while (i + 1 < count && (below < 0.0f || (below == 0.0f && r.y > 0.0f))) {
    ++i;
    g = KELP_SEGMENT(i);
    below = through_plane ? g.p1.y - y : (g.p1.y - o.y) - climb;
  }
  float above = through_plane ? y - g.p0.y : (o.y - g.p0.y) + climb;
  walk.going = true;
  walk.g = g;
  walk.segment = i;
  walk.t0 = kelpSplineParameter(g, above, below);
  walk.y = y;
  walk.s = s0;
  walk.end = s1;
  return walk;
}

KELP_FN KelpCurve kelpWalkCurve(KelpWalk walk, vec3 o, vec3 r) {
  return kelpMakeCurve(walk.g, o, r, walk.s, walk.t0, walk.y, walk.base, walk.stretch, walk.scale);
}

// On to the half of a segment that follows the curve; it no longer goes where there is none.
KELP_FN KelpWalk kelpWalkOn(KELP_CONTEXT_ KelpWalk before, vec3 r, KelpCurve c) {
  KelpWalk walk = before;
  walk.going = abs(r.y) >= 1e-12f;
  walk.s = kelpCurveRay(c, c.end);
  if (!(walk.s <= walk.end)) walk.going = false;
  if (!walk.going) return walk;
  if (r.y > 0.0f ? walk.t0 < 0.5f : walk.t0 > 0.5f) {
    walk.t0 = 0.5f;
    walk.y = kelpSplineAt(walk.g, 0.5f).y;
    return walk;
  }
  int i = walk.segment + (r.y > 0.0f ? 1 : -1);
  walk.going = i >= 0 && i < KELP_SEGMENTS;
  if (!walk.going) return walk;
  walk.segment = i;
  walk.y = r.y > 0.0f ? walk.g.p1.y : walk.g.p0.y;
  walk.t0 = r.y > 0.0f ? 0.0f : 1.0f;
  walk.g = KELP_SEGMENT(i);
  return walk;
}

// The first solid voxel along o + s r, s in [s_min, s_max]; o and r as in kelpEnter.
KELP_FN KelpHit kelpTrace(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit;
  hit.found = false;
  hit.s = s_max;
  hit.t = 0.0f;
  hit.segment = 0;
  hit.coarser = 0;
  hit.voxel = ivec3(0);
  hit.brick = 0u;
  hit.code = 0u;
  hit.rest = vec3(0.0f);
  hit.steps = 0;
  hit.outside = 0;
  hit.fetches = 0;
  KelpWalk walk = kelpEnter(KELP_CONTEXT o, r, s_min, s_max);
  if (!walk.going) return hit;
  // As kelpWalkOn goes on, in variables of their own.
  KelpSegment g = walk.g;
  int i = walk.segment;
  float t0 = walk.t0;
  float y = walk.y;
  float s = walk.s;
  for (int n = 0; n < 2 * KELP_SEGMENTS; ++n) {
    KelpCurve c = kelpMakeCurve(g, o, r, s, t0, y, walk.base, walk.stretch, walk.scale);
    hit.segment = i;
    hit = kelpMarch(KELP_CONTEXT c, walk.end, hit);
    if (hit.found || abs(r.y) < 1e-12f) break;
    s = kelpCurveRay(c, c.end);
    if (s > walk.end) break;
    if (r.y > 0.0f ? t0 < 0.5f : t0 > 0.5f) {
      t0 = 0.5f;
      y = kelpSplineAt(g, t0).y;
      continue;
    }
    i += r.y > 0.0f ? 1 : -1;
    if (i < 0 || i >= KELP_SEGMENTS) break;
    y = r.y > 0.0f ? g.p1.y : g.p0.y;
    t0 = r.y > 0.0f ? 0.0f : 1.0f;
    g = KELP_SEGMENT(i);
  }
  return hit;
}

// The world's normal of a surface whose normal in the undeformed volume is n, up to length: the inverse transpose of the map's derivative,
// times S.y' >= 0 so that nothing is divided. `stretch` as in kelpMakeCurve. Part space. The paper's equation 5 holds for one bent axis only.
KELP_FN vec3 kelpDeformNormal(KelpSegment g, float t, float stretch, vec3 n) {
  vec3 slope = kelpSplineSlope(g, clamp(t, 1e-4f, 1.0f - 1e-4f));  // an end face with S' = 0 would give a zero vector
  return vec3(slope.y * n.x, stretch * slope.y * n.y - slope.x * n.x - slope.z * n.z, slope.y * n.z);
}

// 24 bits (12 + 12, octahedral around +y) -> a unit vector; formats/SPEC.md, "Attributes".
KELP_FN vec3 kelpDecodeNormal(uint bits) {
  float x = (min(float(bits & 4095u), 4094.0f) - 2047.0f) * (1.0f / 2047.0f);
  float z = (min(float((bits >> 12u) & 4095u), 4094.0f) - 2047.0f) * (1.0f / 2047.0f);
  float y = 1.0f - abs(x) - abs(z);
  float fold = max(-y, 0.0f);
  return normalize(vec3(x + (x >= 0.0f ? -fold : fold), y, z + (z >= 0.0f ? -fold : fold)));
}
