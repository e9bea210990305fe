// SPDX-License-Identifier: MIT
// Fog: how much of the light behind a ray comes through a posed part, and what the part adds to it.
//
// The ray is the same cubic curve q(b) in the volume as in trace.glsl. Clear bricks are left behind in one step, by the box or the ball that their
// cell promises. Where it is not clear the way is taken cube by cube, from face to face: within a cube the field is trilinear, so along a straight line
// it is a cubic polynomial, and Simpson's rule integrates it exactly; a curve is bent too little within a cube for the eye to see. What is left to
// choose is nothing: a denser fog needs no smaller steps. Transmittance is exp(-optical depth), so a cube's share of the light is exact too.
//
// Positions in level space count from the volume's corner; samples are at voxels' centres, so cube (i, j, k) begins at (i, j, k) + 1/2. Between the outermost
// samples and the volume's faces is a rim half a voxel wide, in which the field is as at the nearest point between samples.

#define KELP_FOG_CHANNEL 576u     // words of a brick's channel: kelp/runtime/page.h
#define KELP_FOG_ENOUGH 0.0009765625  // less than this of what is behind is none

// As in surface.glsl, from kelp::gl::View.
uniform vec3 kelp_sun_direction;
uniform vec3 kelp_sun_color;
uniform vec3 kelp_sky_color;
uniform vec3 kelp_ground_color;
uniform bool kelp_self_shadow;
uniform int kelp_fog_pieces;   // how many pieces the way through a cube is cut into

// What the part's samples mean; kelpLoadFog fills these.
vec3 kelp_fog_color;
float kelp_fog_anisotropy;
float kelp_fog_glow;
uint kelp_fog_stride;       // words of a brick
uint kelp_fog_extinctions;  // where they are, one a level
uint kelp_fog_ramp;
int kelp_fog_ramp_colors;

float kelpFloat(uint at) { return uintBitsToFloat(kelpWord(at)); }

// After kelpLoadLevel. The block of seven words comes after the tables of the part's levels.
void kelpLoadFog() {
  uint levels = (kelpRecordBits(kelp_record + 11).w >> 16u) & 255u;
  uint at = kelp_levels_at + 3u * levels;
  kelp_fog_color = vec3(kelpFloat(at), kelpFloat(at + 1u), kelpFloat(at + 2u));
  kelp_fog_anisotropy = kelpFloat(at + 3u);
  kelp_fog_glow = kelpFloat(at + 4u);
  kelp_fog_ramp_colors = int(kelpWord(at + 5u));
  kelp_fog_stride = kelp_fog_ramp_colors > 0 ? 2u * KELP_FOG_CHANNEL : KELP_FOG_CHANNEL;
  kelp_fog_extinctions = at + 6u;
  kelp_fog_ramp = kelp_fog_extinctions + levels;
}

vec3 kelpRamp(float heat) {
  float at = clamp(heat, 0.0, 1.0) * float(kelp_fog_ramp_colors - 1);
  int below = min(int(at), kelp_fog_ramp_colors - 2);
  uint first = kelp_fog_ramp + 3u * uint(below);
  return mix(vec3(kelpFloat(first), kelpFloat(first + 1u), kelpFloat(first + 2u)), vec3(kelpFloat(first + 3u), kelpFloat(first + 4u), kelpFloat(first + 5u)), at - float(below));
}

// The samples at the corners of a cube: at its low z and at its high z, each (x, y) = (0, 0), (1, 0), (0, 1), (1, 1).
struct KelpCorners {
  vec4 low;
  vec4 high;
};
vec4 kelpBytes(uint word) { return vec4(float(word & 255u), float((word >> 8u) & 255u), float((word >> 16u) & 255u), float(word >> 24u)); }
KelpCorners kelpCorners(uint brick, ivec3 cube) {
  uint at = brick + uint((cube.x & 7) | ((cube.y & 7) << 3) | ((cube.z & 7) << 6));
  return KelpCorners(kelpBytes(kelpWord(at)), kelpBytes(kelpWord(at + 64u)));
}
// Codes are roots of densities.
KelpCorners kelpSquared(KelpCorners c) { return KelpCorners(c.low * c.low, c.high * c.high); }
float kelpBetween(KelpCorners c, vec3 f) {
  vec4 m = mix(c.low, c.high, f.z);
  vec2 n = mix(m.xy, m.zw, f.y);
  return mix(n.x, n.y, f.x);
}

// What is at a place in level space: a box in which it is clear, or the part of a cube that is drawn there.
struct KelpFogPlace {
  bool clear;
  KelpBox box;      // in voxels of the level that is traced
  float clearance;  // of what is clear: kelpStep's
  int coarser;      // levels between the traced one and the cube's
  uint brick;
  ivec3 cube;
  vec3 rim_low;     // where in the cube a point of the rim counts as: kelpInCube
  vec3 rim_high;
};

ivec3 kelpSamples(int level) { return (ivec3(kelp_size) + ((1 << level) - 1)) >> level; }
ivec3 kelpCubes(ivec3 samples) { return max(samples - 1, ivec3(1)); }
// The box of a run of cubes; what touches the rim has it too.
KelpBox kelpCubesBox(ivec3 first, ivec3 end, ivec3 cubes, float side) {
  vec3 low = (vec3(first) + 0.5 - vec3(lessThanEqual(first, ivec3(0)))) * side;
  vec3 high = (vec3(end) + 0.5 + vec3(greaterThanEqual(end, cubes))) * side;
  return KelpBox(0.5 * (low + high), 0.5 * (high - low));
}
KelpBox kelpOverlap(KelpBox a, KelpBox b) {
  vec3 low = max(a.centre - a.half_size, b.centre - b.half_size);
  vec3 high = min(a.centre + a.half_size, b.centre + b.half_size);
  return KelpBox(0.5 * (low + high), 0.5 * (high - low));
}

// The cube that q is in, or, in the rim, that it is beside; its box has the width of a cube there too.
KelpFogPlace kelpCubeAt(KelpFogPlace before, vec3 q, ivec3 samples, float side) {
  KelpFogPlace place = before;
  ivec3 at = clamp(ivec3(floor(q / side - 0.5)), ivec3(-1), samples - 1);
  place.cube = clamp(at, ivec3(0), kelpCubes(samples) - 1);
  bvec3 below = lessThan(at, ivec3(0));
  bvec3 above = greaterThanEqual(at, samples - 1);
  vec3 last = vec3(samples - 1 - place.cube);
  place.rim_low = mix(mix(vec3(-1.0), vec3(0.0), below), last, above);
  place.rim_high = mix(mix(vec3(2.0), vec3(0.0), below), last, above);
  place.box.centre = (vec3(at) + 1.0) * side;
  place.box.half_size = vec3(0.5 * side);
  return place;
}
// Where in its cube a point is, 0 to 1 on each axis, or a little more: a step ends a little beyond the cube's face.
vec3 kelpInCube(KelpFogPlace place, vec3 q) { return clamp(q / float(1 << place.coarser) - (vec3(place.cube) + 0.5), place.rim_low, place.rim_high); }

KelpFogPlace kelpFogAt(vec3 q) {
  KelpFogPlace place;
  place.clear = false;
  place.clearance = 0.0;
  place.coarser = 0;
  place = kelpCubeAt(place, q, kelp_level_size, 1.0);
  ivec3 cubes = kelpCubes(kelp_level_size);
  ivec3 at = place.cube >> 3;
  uint cell = kelpCell(at);
  if (cell < 0x80000000u) {
    place.clear = true;
    KelpBox box = kelpCellBox(cell, at);
    place.box = kelpCubesBox(ivec3(box.centre - box.half_size), ivec3(box.centre + box.half_size), cubes, 1.0);
    place.clearance = kelp_complete ? float(cell >> 24u) : 0.0;
    return place;
  }
  place.brick = kelpBrickOf(kelp_pages_at, cell, kelp_fog_stride);
  if (place.brick != 0u) return place;
  // Not resident: what the finest coarser level says, as far as this brick reaches.
  KelpBox missing = kelpCubesBox(8 * at, min(8 * at + 8, cubes), cubes, 1.0);
  place.clear = true;
  float side = 1.0;
  while (place.coarser < kelp_coarser) {
    ++place.coarser;
    side *= 2.0;
    ivec3 samples = kelpSamples(kelp_level + place.coarser);
    cubes = kelpCubes(samples);
    place = kelpCubeAt(place, q, samples, side);
    at = place.cube >> 3;
    uint table = kelp_levels_at + 3u * uint(kelp_level + place.coarser);
    uint grid = kelpWord(table + 2u);
    ivec2 bricks = ivec2(int(grid & 1023u), int((grid >> 10u) & 1023u)) + 1;
    cell = kelpWord(kelpWord(table) + uint(at.x + bricks.x * (at.y + bricks.y * at.z)));
    if (cell < 0x80000000u) {
      place.box = kelpOverlap(missing, kelpCubesBox(8 * at, min(8 * at + 8, cubes), cubes, side));
      return place;
    }
    place.brick = kelpBrickOf(kelpWord(table + 1u), cell, kelp_fog_stride);
    if (place.brick == 0u) continue;
    place.clear = false;
    place.box = kelpOverlap(missing, place.box);
    return place;
  }
  place.box = missing;  // in a pack whose levels contradict each other
  return place;
}

float kelpSpeed(KelpCurve c, float b) { return c.s.y + b * (2.0 * c.s.z + 3.0 * b * c.s.w); }

// The distance in b to the end of the place, but not beyond the ray's.
float kelpFogStep(KelpCurve c, float b, vec3 q, KelpFogPlace place, float s_max) {
  float x = min(kelpStep(c, b, q, place.box.centre, place.box.half_size, place.clearance), c.end - b);
  float s = kelpCurveRay(c, b);
  float beyond = kelpCurveRay(c, b + x);
  // Within a step s is next to linear.
  return beyond > s_max ? x * clamp((s_max - s) / (beyond - s), 0.0, 1.0) : x;
}

// What the ray has gathered.
struct KelpFog {
  vec3 light;     // that the fog sends to the eye, times its transmittance on the way
  float through;  // of what is behind
  float s;        // where the fog begins; KELP_NEVER: nowhere
  int steps;
};

// A stretch of the curve through one cube: its optical depth, and the glow that leaves it.
struct KelpFogPiece {
  float depth;
  vec3 glow;
};
// Given off at a place, on the stretch of ray that counts there.
vec3 kelpGlow(KelpCorners heat, vec3 f, float way) {
  float h = kelpBetween(heat, f);
  return h > 0.0 ? (kelp_fog_glow * way * h) * kelpRamp(h) : vec3(0.0);
}
KelpFogPiece kelpFogPiece(KelpCurve c, float b, float x, KelpFogPlace place, KelpCorners density, KelpCorners heat, float extinction) {
  vec3 f0 = kelpInCube(place, kelpCurveAt(c, b));
  vec3 f1 = kelpInCube(place, kelpCurveAt(c, b + 0.5 * x));
  vec3 f2 = kelpInCube(place, kelpCurveAt(c, b + x));
  vec3 way = x * vec3(kelpSpeed(c, b), kelpSpeed(c, b + 0.5 * x), kelpSpeed(c, b + x));
  vec3 rates = extinction * way * vec3(kelpBetween(density, f0), kelpBetween(density, f1), kelpBetween(density, f2));
  KelpFogPiece piece;
  piece.depth = dot(rates, vec3(1.0, 4.0, 1.0) / 6.0);
  piece.glow = vec3(0.0);
  if (kelp_fog_ramp_colors > 0) {
    // What is given off, dimmed by what is before it in the piece; to the middle by the integral of the parabola through the three rates.
    float half_depth = dot(rates, vec3(5.0, 8.0, -1.0) / 24.0);
    piece.glow = (kelpGlow(heat, f0, way.x) + 4.0 * exp(-half_depth) * kelpGlow(heat, f1, way.y) + exp(-piece.depth) * kelpGlow(heat, f2, way.z)) / 6.0;
  }
  return piece;
}

float kelpExtinction(int level) { return kelpFloat(kelp_fog_extinctions + uint(level)) * (1.0 / 65025.0); }

#ifdef KELP_SECONDARY_RAYS
// How much of the sun's light reaches a point of part space through the part. At a level four times coarser, by the middle of each cube.
float kelpFogSun(vec3 o, vec3 r) {
  int level = kelp_level;
  kelpLoadLevel(min(level + 2, level + kelp_coarser));
  vec3 extent = kelp_level_scale * kelp_size;
  float depth = 0.0;
  KelpWalk walk = kelpEnter(o, r, 0.0, length(kelp_bounds_max - kelp_bounds_min));
  int left = KELP_MAX_STEPS;
  while (walk.going && depth < 8.0 && left > 0) {
    KelpCurve c = kelpWalkCurve(walk, o, r);
    float b = 0.0;
    while (b < c.end && kelpCurveRay(c, b) < walk.end && depth < 8.0 && left > 0) {
      --left;
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (max(gap.x, gap.z) > 0.5 * KELP_ERODE) {
        b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
        continue;
      }
      KelpFogPlace place = kelpFogAt(q);
      float x = kelpFogStep(c, b, q, place, walk.end);
      if (!place.clear) {
        float density = kelpBetween(kelpSquared(kelpCorners(place.brick, place.cube)), kelpInCube(place, kelpCurveAt(c, b + 0.5 * x)));
        depth += kelpExtinction(kelp_level + place.coarser) * density * x * kelpSpeed(c, b + 0.5 * x);
      }
      b = kelpAdvance(b, x);
    }
    walk = kelpWalkOn(walk, r, c);
  }
  kelpLoadLevel(level);
  return exp(-depth);
}
#endif

// Along one curve. sun: what a white, even fog would send to the eye of the sun's light, unshadowed; sky: of all other light; sun_at: towards the
// sun, part space.
KelpFog kelpFogAlong(KelpCurve c, vec3 o, vec3 r, float s_max, vec3 sun, vec3 sky, vec3 sun_at, KelpFog before) {
  KelpFog fog = before;
  vec3 extent = kelp_level_scale * kelp_size;
  float b = 0.0;
  bool going = b < c.end;
  while (going) {
    ++fog.steps;
    vec3 q = kelpCurveAt(c, b);
    vec3 gap = kelpBeside(q, extent);
    if (max(gap.x, gap.z) > 0.5 * KELP_ERODE) {
      b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
    } else {
      KelpFogPlace place = kelpFogAt(q);
      float x = kelpFogStep(c, b, q, place, s_max);
      if (!place.clear) {
        KelpCorners density = kelpSquared(kelpCorners(place.brick, place.cube));
        KelpCorners heat = density;
        if (kelp_fog_ramp_colors > 0) {
          heat = kelpCorners(place.brick + KELP_FOG_CHANNEL, place.cube);
          heat = KelpCorners(heat.low * (1.0 / 255.0), heat.high * (1.0 / 255.0));
        }
        float extinction = kelpExtinction(kelp_level + place.coarser);
        float piece_x = x / float(kelp_fog_pieces);
        for (int i = 0; i < kelp_fog_pieces; ++i) {
          float from = b + float(i) * piece_x;
          KelpFogPiece piece = kelpFogPiece(c, from, piece_x, place, density, heat, extinction);
          if (fog.s == KELP_NEVER && (piece.depth > 0.0 || piece.glow != vec3(0.0))) fog.s = kelpCurveRay(c, from);
          float clear = exp(-piece.depth);
          // 1 - exp(-d), which cancels where d is small.
          float stopped = piece.depth > 1e-2 ? 1.0 - clear : piece.depth * (1.0 - 0.5 * piece.depth);
          vec3 scattered = sky;
#ifdef KELP_SECONDARY_RAYS
          if (kelp_self_shadow && piece.depth > 0.0) scattered += sun * kelpFogSun(o + kelpCurveRay(c, from + 0.5 * piece_x) * r, sun_at);
          else scattered += sun;
#else
          scattered += sun;
#endif
          fog.light += fog.through * (stopped * scattered + piece.glow);
          fog.through *= clear;
        }
      }
      b = kelpAdvance(b, x);
    }
    // A number that is none ends the march too.
    going = b < c.end && kelpCurveRay(c, b) < s_max && fog.through > KELP_FOG_ENOUGH && fog.steps < KELP_MAX_STEPS && dot(gap, gap) < KELP_NEVER;
  }
  return fog;
}

// The fog of the part that is loaded, with its level, along o + s r, s in [s_min, s_max]; o and r as in kelpEnter, in part space.
KelpFog kelpFog(vec3 o, vec3 r, float s_min, float s_max) {
  KelpFog fog;
  fog.light = vec3(0.0);
  fog.through = 1.0;
  fog.s = KELP_NEVER;
  fog.steps = 0;
  kelpLoadFog();

  // Light is even over a part. Turned into all directions, or, by Henyey's and Greenstein's law, more into some.
  mat3 to_world = mat3(kelpPartToWorld());
  float forward = dot(normalize(to_world * r), kelp_sun_direction);
  float g = kelp_fog_anisotropy;
  float base = 1.0 + g * g - 2.0 * g * forward;
  vec3 color = kelp_fog_color * kelpRecord(kelp_record + 8).rgb;
  vec3 sun = color * kelp_sun_color * ((1.0 - g * g) / (12.5663706 * base * sqrt(base)));
  vec3 sky = color * 0.5 * (kelp_sky_color + kelp_ground_color);
  vec3 sun_at = normalize(inverse(to_world) * kelp_sun_direction);

  KelpWalk walk = kelpEnter(o, r, s_min, s_max);
  int halves = 2 * kelp_segment_count;
  while (walk.going && halves > 0) {
    --halves;
    KelpCurve c = kelpWalkCurve(walk, o, r);
    fog = kelpFogAlong(c, o, r, walk.end, sun, sky, sun_at, fog);
    if (fog.through <= KELP_FOG_ENOUGH) {
      fog.through = 0.0;
      break;
    }
    walk = kelpWalkOn(walk, r, c);
  }
  return fog;
}
