// SPDX-License-Identifier: MIT
// The tracing core: where does a straight ray through the deformed world first meet a solid voxel of the
// undeformed volume? Comes after spline.glsl and curve.glsl.
//
// The three texts compile as GLSL 3.30, GLSL ES 3.00 and C++20 with GLM. The GPU, the CPU queries and the
// tests run them. So they are written in a subset: every literal has its `f` or `u`; int, uint and float are
// not mixed; there are no swizzles; fields are assigned one by one.
//
// Method: Groen et al., "Spline Based Shell Mapping for Smooth Voxel Deformation". Two things differ; the
// reasons are in shaders/METHOD.md:
//   - The paper marches in world space and solves a cubic for each sample. Here the ray is mapped once for
//     each half of a spline segment. It becomes a cubic curve q(b) in the volume; a sample costs three
//     multiply-adds.
//   - The paper's distance heuristic may skip voxels. Here a proof bounds every step (kelpStep): none is
//     skipped.
//
// Spaces and units
//   Part space   level-0 voxels, deformed, +y along the spline. The ray lives here. Its direction is a unit
//                vector, so its parameter s is in level-0 voxels.
//   Level space  voxels of the level that is traced, not deformed. q lives here.
//
// The text before defines:
//   KELP_FN                function qualifiers (empty in GLSL)
//   KELP_CONTEXT_          first parameter of functions that read the part: empty in GLSL, in C++
//                          "const Context& kelp_context,"
//   KELP_CONTEXT           the same as an argument
//   KELP_SEGMENTS          int: number of spline segments
//   KELP_SEGMENT(i)        KelpSegment: segment i
//   KELP_BOUNDS_MIN, _MAX  vec3: a box around the deformed volume, part space
//   KELP_SIZE              vec3: size of the volume, level-0 voxels
//   KELP_LEVEL_SIZE        ivec3: size of the level, in its voxels
//   KELP_LEVEL_SCALE       float: 2^-level
//   KELP_COMPLETE          bool: every brick of the level is resident
//   KELP_COARSER           int: number of coarser levels
//   KELP_CELL(v)           uint: grid cell of brick v: empty as in formats/SPEC.md, "Voxels";
//                          stored: 0x80000000 and where the brick is
//   KELP_BRICK(k, cell)    uint: the brick of a stored cell, of the level k levels above; 0: not resident
//   KELP_BRICK_ABOVE(k, v) uint: brick v of the level k levels above; 0: not resident or empty
//   KELP_CODE(k, brick, v) uint: code of voxel v (modulo 8 on each axis) in that brick, k levels above
//
// Bricks that are not resident: the finest coarser level that is resident is drawn in their place. The finest
// resident brick at a point decides what is drawn there, from whichever side the ray comes. A coarse voxel is
// solid if any of its fine voxels is, so a coarse empty box is empty at all finer levels. The reverse does
// not hold: while the level is not complete, a step never leaves the brick that allowed it.

#define KELP_MAX_STEPS 16384  // a guard; the longest ray seen took 1500 steps, at 4096 voxels

struct KelpHit {
  bool found;
  float s;      // along the ray
  float t;      // spline parameter within the segment
  int segment;  // its number; of a swept part, that of the arc
  int coarser;  // levels between the traced one and the voxel's
  ivec3 voxel;  // of the level that many above
  uint brick;   // that holds the voxel
  uint code;    // of the voxel
  vec3 rest;    // where the hit is in the undeformed volume, level-0 voxels
  int steps;    // fetching steps taken
  int outside;  // steps taken beside the volume, without a fetch
  int fetches;
  int clips;  // slices of a swept part that were clipped
#ifdef KELP_DISTANCES
  float room;  // the least that was empty to each side of the ray, less kelp_cone, voxels of the level
#endif
};
#ifdef KELP_DISTANCES
float kelp_cone = 0.0;  // how fast a cone around the ray widens
#endif

// Nothing found, up to s_max.
KELP_FN KelpHit kelpNoHit(float s_max) {
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
  hit.clips = 0;
#ifdef KELP_DISTANCES
  hit.room = KELP_NEVER;
#endif
  return hit;
}

// `before` with what was found at b: a voxel of the level `coarser` levels above the traced one.
KELP_FN KelpHit kelpFound(KelpHit before, KelpCurve c, float b, int coarser, ivec3 voxel, uint brick,
                          uint code) {
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

// Follows one curve to its first solid voxel or its end. Adds to the counts of `before`.
// Three loops take turns: beside the volume, in it, and where bricks are not resident. One loop with branches
// would be slower, because SIMD runs all branches one after the other. The volume is left a little farther
// out than it is entered, so that rounding cannot switch between two loops for ever. Long: the loops share
// the curve's parameter and their flags.
KELP_FN KelpHit kelpMarch(KELP_CONTEXT_ KelpCurve c, float s_max, KelpHit before) {
  KelpHit hit = before;
  vec3 extent = KELP_LEVEL_SCALE * KELP_SIZE;
  ivec3 size = KELP_LEVEL_SIZE;
  vec3 last = vec3(float(size.x - 1), float(size.y - 1), float(size.z - 1));
  bool complete = KELP_COMPLETE;
  float b = 0.0f;
  bool going = b < c.end;
  // Each turn takes a step. n is for compilers by whom a NaN is inside at one place, and beside at another.
  for (int n = 0; going && n < KELP_MAX_STEPS; ++n) {
    bool beside = true;
    while (beside) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (max(gap.x, gap.z) <= 0.5f * KELP_ERODE) break;
      ++hit.outside;
      b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
      // NaN or overflow also ends the march.
      going = b < c.end && kelpCurveRay(c, b) <= s_max && dot(gap, gap) < KELP_NEVER &&
              hit.outside < KELP_MAX_STEPS;
      beside = going;
    }
    bool inside = going;
    bool missing = false;
    while (inside) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (!(max(gap.x, gap.z) <= 0.75f * KELP_ERODE)) break;
      ivec3 voxel = ivec3(min(max(vec3(0.0f), floor(q)), last));  // in this order: 0 where q is NaN
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
#ifdef KELP_DISTANCES
      hit.room = min(hit.room, min(min(box.half_size.x, box.half_size.y), box.half_size.z) -
                                   kelp_cone * KELP_LEVEL_SCALE * kelpCurveRay(c, b));
#endif
      b = kelpAdvance(b, kelpStep(c, b, q, box.center, box.half_size, clearance));
      going = b < c.end && kelpCurveRay(c, b) <= s_max && hit.steps < KELP_MAX_STEPS;
      inside = going;
    }
#ifdef KELP_DISTANCES
    if (missing) hit.room = 0.0;
#endif
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
      if (brick != 0u) code = KELP_CODE(coarser, brick, voxel);  // a pack's levels may contradict each other
      ++hit.steps;
      hit.fetches += 2 + 2 * coarser;
      if (code >= 64u) {
        hit = kelpFound(hit, c, b, coarser, voxel, brick, code);
        going = false;
        break;
      }
      KelpBox box = kelpCodeBox(code, voxel, true);
      b = kelpAdvance(b, kelpStep(c, b, q, side * box.center, side * box.half_size, 0.0f));
      going = b < c.end && kelpCurveRay(c, b) <= s_max && hit.steps < KELP_MAX_STEPS;
      missing = going;
    }
  }
  if (hit.found) hit.rest = kelpCurveAt(c, b) / KELP_LEVEL_SCALE;
  return hit;
}

// A ray on its way through the segments that it meets, half by half, at o + s r. r is a unit vector.
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

// Where o + s r, s in [s_min, s_max], enters the bounds. r is a unit vector. The nearer o is to the volume,
// the more exact the result.
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

  // The part of the ray inside the bounds, x and z first: the planes of y are exact, and a ray that enters
  // through one starts at t = 0 or 1.
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
  // Near the ends of a segment heights are taken as differences: o.y + climb would round them away.
  float climb = s0 * r.y;
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

  // The segment that holds that height, and one root solve. Later halves and segments need none.
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

// Goes on to the next half of a segment. `going` is false if there is none.
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

// The first solid voxel of a sheared part along o + s r, s in [s_min, s_max]; o and r as in kelpEnter.
KELP_FN KelpHit kelpTraceSheared(KELP_CONTEXT_ vec3 o, vec3 r, float s_min, float s_max) {
  KelpHit hit = kelpNoHit(s_max);
  KelpWalk walk = kelpEnter(KELP_CONTEXT o, r, s_min, s_max);
  if (!walk.going) return hit;
  // kelpWalkOn, in local variables.
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
