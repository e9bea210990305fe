// SPDX-License-Identifier: MIT
// Fog: how much of the light behind a ray comes through a posed part, and what the part adds to it.
//
// The ray is the same cubic curve q(b) in the volume as in trace.glsl; in a swept part, several that follow
// it closely. One step leaves a clear brick, by the
// box or the ball that its cell promises. Elsewhere the ray goes cube by cube, from face to face. Within a
// cube the field is trilinear, so along a straight line it is a cubic polynomial, and Gauss's rule of two
// points integrates it exactly; within one cube a curve is nearly straight. Transmittance is exp(-optical
// depth), so a cube's share of the light is exact too. There is no step length to choose: a denser fog needs
// no smaller steps.
//
// Positions in level space count from the volume's corner. Samples are at voxels' centers, so cube (i, j, k)
// begins at (i, j, k) + 1/2. Between the outermost samples and the volume's faces is a rim half a voxel wide;
// the field there is that of the nearest point between samples.
//
// Two features are compiled in only where they are needed, because some GPUs, and CPUs in their place, also
// run the branches that they do not take: KELP_FOG_HEAT, for parts with heat, and KELP_FOG_SHADOW, for
// kelp::gl::Quality::self_shadow.

#define KELP_FOG_CHANNEL 576u       // words of a brick's channel: kelp/formats/page.h
#define KELP_GAUSS 0.2113248654     // 1/2 - 1/sqrt(12)
#define KELP_FOG_DEEP 9.0           // optical depth at which a ray ends: 1/8000 comes through
#define KELP_FOG_SEEN 0.0009765625  // share of the light that one shadow ray stands for
#define KELP_FOG_STEPS 65536        // a guard: a ray crosses 3 * 8192 cubes at most

// The meaning of the part's samples. kelpLoadFog sets these.
vec3 kelp_fog_color;
float kelp_fog_anisotropy;
float kelp_fog_glow;
uint kelp_fog_stride;       // words of a brick
uint kelp_fog_extinctions;  // where they are, one for each level
uint kelp_fog_ramp;
int kelp_fog_ramp_colors;

int kelp_fog_coarser = 0;  // levels between the traced one and the brick's where the fog begins

float kelpFloat(uint at) { return uintBitsToFloat(kelpWord(at)); }

// After kelpLoadLevel. The block of seven words comes after the tables of the part's levels.
void kelpLoadFog() {
  uint levels = (kelpRecordBits(kelp_record + 11).w >> 16u) & 255u;
  uint at = kelp_levels_at + 4u * levels;
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
  return mix(vec3(kelpFloat(first), kelpFloat(first + 1u), kelpFloat(first + 2u)),
             vec3(kelpFloat(first + 3u), kelpFloat(first + 4u), kelpFloat(first + 5u)), at - float(below));
}

// The samples at the corners of a cube: at its low z and at its high z, each (x, y) = (0, 0), (1, 0), (0, 1),
// (1, 1).
struct KelpCorners {
  vec4 low;
  vec4 high;
};
vec4 kelpBytes(uint word) {
  return vec4(float(word & 255u), float((word >> 8u) & 255u), float((word >> 16u) & 255u),
              float(word >> 24u));
}
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

// The brick that is drawn at a place in level space, or a clear place.
struct KelpFogPlace {
  bool clear;
  KelpBox box;      // where it is clear, or where the brick is drawn; voxels of the level that is traced
  float clearance;  // of a clear place, for kelpStep
  int coarser;      // levels between the traced one and the brick's
  uint brick;
  ivec3 at;       // the brick's place in its grid
  ivec3 samples;  // of its level
};

ivec3 kelpSamples(int level) { return (ivec3(kelp_size) + ((1 << level) - 1)) >> level; }
ivec3 kelpCubes(ivec3 samples) { return max(samples - 1, ivec3(1)); }
// The cube that a place is in; for a place in the rim, the cube beside it.
ivec3 kelpCube(vec3 u, ivec3 samples) { return clamp(ivec3(floor(u)), ivec3(0), kelpCubes(samples) - 1); }
// The box of a run of cubes, with the rim where it touches it.
KelpBox kelpCubesBox(ivec3 first, ivec3 end, ivec3 cubes, float side) {
  vec3 low = (vec3(first) + 0.5 - vec3(lessThanEqual(first, ivec3(0)))) * side;
  vec3 high = (vec3(end) + 0.5 + vec3(greaterThanEqual(end, cubes))) * side;
  return KelpBox(0.5 * (low + high), 0.5 * (high - low));
}
KelpBox kelpOverlap(KelpBox a, KelpBox b) {
  vec3 low = max(a.center - a.half_size, b.center - b.half_size);
  vec3 high = min(a.center + a.half_size, b.center + b.half_size);
  return KelpBox(0.5 * (low + high), 0.5 * (high - low));
}

// Of a brick: to where the volume ends, and as far beyond as it takes to be beside it.
KelpBox kelpBrickBox(ivec3 at, ivec3 cubes, float side) {
  vec3 half_extent = 0.5 * kelp_level_scale * kelp_size;
  return kelpOverlap(kelpCubesBox(8 * at, min(8 * at + 8, cubes), cubes, side),
                     KelpBox(half_extent, half_extent + KELP_ERODE));
}

// Where a brick is not resident: what the finest coarser level says, within that brick.
KelpFogPlace kelpFogAbove(KelpFogPlace missing, vec3 q) {
  KelpFogPlace place = missing;
  place.clear = true;
  float side = 1.0;
  while (place.coarser < kelp_coarser) {
    ++place.coarser;
    side *= 2.0;
    place.samples = kelpSamples(kelp_level + place.coarser);
    place.at = kelpCube(q / side - 0.5, place.samples) >> 3;
    uint table = kelp_levels_at + 4u * uint(kelp_level + place.coarser);
    uint grid = kelpWord(table + 2u);
    ivec2 bricks = ivec2(int(grid & 1023u), int((grid >> 10u) & 1023u)) + 1;
    uint cells = kelpWord(table);
    if (cells == 0u) continue;
    uint cell = kelpWord(cells + uint(place.at.x + bricks.x * (place.at.y + bricks.y * place.at.z)));
    bool stored = cell >= 0x80000000u;
    place.brick = stored ? kelpBrickOf(kelpWord(table + 1u), cell, kelp_fog_stride) : 0u;
    if (stored && place.brick == 0u) continue;
    place.box = kelpOverlap(missing.box, kelpBrickBox(place.at, kelpCubes(place.samples), side));
    place.clear = !stored;
    break;
  }
  return place;
}

KelpFogPlace kelpFogAt(vec3 q) {
  KelpFogPlace place;
  place.clear = false;
  place.clearance = 0.0;
  place.coarser = 0;
  place.brick = 0u;
  place.samples = kelp_level_size;
  place.at = kelpCube(q - 0.5, kelp_level_size) >> 3;
  ivec3 cubes = kelpCubes(kelp_level_size);
  uint cell = kelpCell(place.at);
  if (cell < 0x80000000u) {
    place.clear = true;
    KelpBox box = kelpCellBox(cell, place.at);
    place.box =
        kelpCubesBox(ivec3(box.center - box.half_size), ivec3(box.center + box.half_size), cubes, 1.0);
    place.clearance = kelp_complete ? float(cell >> 24u) : 0.0;
    return place;
  }
  place.brick = kelpBrickOf(kelp_pages_at, cell, kelp_fog_stride);
  place.box = kelpBrickBox(place.at, cubes, 1.0);
  if (place.brick == 0u) place = kelpFogAbove(place, q);
  return place;
}

// The curve's speed: length of the ray per b.
float kelpSpeed(KelpCurve c, float b) { return c.s.y + b * (2.0 * c.s.z + 3.0 * b * c.s.w); }
// b at s_max, at most the curve's end. s rises with b, so Newton's method inside a bracket finds it.
float kelpCurveUntil(KelpCurve c, float s_max) {
  float end = min(c.end, 1e9);
  if (kelpCurveRay(c, end) <= s_max) return end;
  float low = 0.0;
  float high = end;
  float b = 0.0;
  for (int i = 0; i < 24; ++i) {
    float excess = kelpCurveRay(c, b) - s_max;
    if (excess > 0.0) {
      high = b;
    } else {
      low = b;
    }
    float next = b - excess / max(kelpSpeed(c, b), 1e-20);
    next = next >= low && next <= high ? next : 0.5 * (low + high);
    if (next == b) break;
    b = next;
  }
  return b;
}

// A lower bound of how far in b the curve goes until it is just beyond a face of the cube that u is in, at
// most `range`. u: a place among a level's samples, q / side - 1/2. The tangent alone does not do: at a knot
// the curve may start without any slope.
float kelpCubeStep(KelpCurve c, float b, vec3 u, float per_side, float range) {
  vec3 slope = per_side * kelpCurveSlope(c, b);
  vec3 bend = per_side * (abs(c.c2 + (3.0 * b) * c.c3) + range * abs(c.c3));
  vec3 f = u - floor(u);
  vec3 ahead = mix(f, 1.0 - f, greaterThan(slope, vec3(0.0))) + KELP_ERODE;
  vec3 x = 2.0 * ahead / max(abs(slope) + sqrt(slope * slope + 4.0 * bend * ahead), vec3(1e-20));
  return min(min(x.x, x.y), min(x.z, range));
}
// Where in a cube a point is, 0 to 1 on each axis. In the rim: the nearest point between samples.
vec3 kelpWithin(vec3 u, ivec3 cube, ivec3 samples) {
  return clamp(clamp(u, vec3(0.0), vec3(samples - 1)) - vec3(cube), 0.0, 1.0);
}

float kelpExtinction(int level) { return kelpFloat(kelp_fog_extinctions + uint(level)) * (1.0 / 65025.0); }

// Light and optical depth that the ray has collected.
struct KelpFog {
  vec3 light;   // that reaches the eye from the fog
  float depth;  // optical
  float s;      // where the fog begins; KELP_NEVER: nowhere
  float unlit;  // share of the sun's light for which no shadow ray was cast yet
  float lit;    // the sun's light that the last shadow ray left
  int steps;
};

// How much of what is behind it the fog hides: all of it where the ray ended.
float kelpHidden(KelpFog fog) { return min((1.0 - exp(-fog.depth)) / (1.0 - exp(-KELP_FOG_DEEP)), 1.0); }

// Light given off at a place, over a length `way` of the ray.
vec3 kelpGlow(KelpCorners heat, vec3 f, float way) {
  float h = kelpBetween(heat, f);
  return h > 0.0 ? (kelp_fog_glow * way * h) * kelpRamp(h) : vec3(0.0);
}

#ifdef KELP_FOG_SHADOW
// How much of the sun's light reaches a point of part space through the part, towards r. Integrated at a
// level four times coarser. Adds its steps to `steps`. Comes after this text: fog_sheared.glsl,
// fog_swept.glsl.
float kelpFogSun(vec3 o, vec3 r, inout int steps);
// The optical depth `before` and what lies along a curve, up to s_max, by the middle of each cube.
float kelpFogShade(KelpCurve c, float s_max, float before, inout int steps) {
  vec3 extent = kelp_level_scale * kelp_size;
  float depth = before;
  float end = kelpCurveUntil(c, s_max);
  float b = 0.0;
  while (b < end && depth < KELP_FOG_DEEP && steps < KELP_FOG_STEPS) {
    ++steps;
    vec3 q = kelpCurveAt(c, b);
    vec3 gap = kelpBeside(q, extent);
    if (max(gap.x, gap.z) > 0.5 * KELP_ERODE) {
      b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
      continue;
    }
    KelpFogPlace place = kelpFogAt(q);
    float leave = min(end, b + kelpStep(c, b, q, place.box.center, place.box.half_size, place.clearance));
    if (place.clear) {
      b = kelpAdvance(b, leave - b);
      continue;
    }
    float per_side = 1.0 / float(1 << place.coarser);
    float extinction = kelpExtinction(kelp_level + place.coarser);
    vec3 u = per_side * q - 0.5;
    ivec3 cube = kelpCube(u, place.samples);
    while (b < leave && cube >> 3 == place.at && depth < KELP_FOG_DEEP && steps < KELP_FOG_STEPS) {
      ++steps;
      float x = kelpCubeStep(c, b, u, per_side, leave - b);
      vec3 f = kelpWithin(per_side * kelpCurveAt(c, b + 0.5 * x) - 0.5, cube, place.samples);
      depth += extinction * kelpBetween(kelpSquared(kelpCorners(place.brick, cube)), f) * x *
               kelpSpeed(c, b + 0.5 * x);
      b = kelpAdvance(b, x);
      u = per_side * kelpCurveAt(c, b) - 0.5;
      cube = kelpCube(u, place.samples);
    }
  }
  return depth;
}
#endif

// Along one curve. `sun`: the sun's light that the fog sends to the eye, without shadow; `sun_at`: towards
// the sun, part space. Long: its loops share the curve's parameter and the place.
KelpFog kelpFogAlong(KelpCurve c, vec3 o, vec3 r, float s_max, vec3 sun, vec3 sun_at, KelpFog before) {
  KelpFog fog = before;
  vec3 extent = kelp_level_scale * kelp_size;
  float end = kelpCurveUntil(c, s_max);
  float b = 0.0;
  bool going = b < end;
  for (int n = 0; going && n < KELP_FOG_STEPS; ++n) {  // n as in kelpMarch
    bool beside = true;
    while (beside) {
      vec3 q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (max(gap.x, gap.z) <= 0.5 * KELP_ERODE) break;
      ++fog.steps;
      b = kelpAdvance(b, kelpOutsideStep(c, b, q, gap));
      // NaN also ends the march.
      going = b < end && dot(gap, gap) < KELP_NEVER && fog.steps < KELP_FOG_STEPS;
      beside = going;
    }
    KelpFogPlace place;
    place.clear = true;
    vec3 q;
    float leave;
    bool inside = going;
    while (inside) {
      q = kelpCurveAt(c, b);
      vec3 gap = kelpBeside(q, extent);
      if (!(max(gap.x, gap.z) <= 0.75 * KELP_ERODE)) break;
      ++fog.steps;
      place = kelpFogAt(q);
      // To the end of the box. A brick also ends there; because of rounding, its cubes say where.
      leave = b + kelpStep(c, b, q, place.box.center, place.box.half_size, place.clearance);
      if (!place.clear) break;
      b = kelpAdvance(b, leave - b);
      going = b < end && fog.steps < KELP_FOG_STEPS;
      inside = going;
    }
    if (!place.clear) {
      leave = min(leave, end);
      float per_side = 1.0 / float(1 << place.coarser);
      float extinction = kelpExtinction(kelp_level + place.coarser);
      vec3 u = per_side * q - 0.5;
      ivec3 cube = kelpCube(u, place.samples);
      inside = b < leave;
      while (inside) {
        ++fog.steps;
        // From face to face, by Gauss's rule of two points: exact for cubics.
        float x = kelpCubeStep(c, b, u, per_side, leave - b);
        float next = kelpAdvance(b, x);
        float b1 = b + KELP_GAUSS * x;
        float b2 = b + (1.0 - KELP_GAUSS) * x;
        vec2 way = x * vec2(kelpSpeed(c, b1), kelpSpeed(c, b2));
        vec3 f1 = kelpWithin(per_side * kelpCurveAt(c, b1) - 0.5, cube, place.samples);
        vec3 f2 = kelpWithin(per_side * kelpCurveAt(c, b2) - 0.5, cube, place.samples);
        KelpCorners density = kelpSquared(kelpCorners(place.brick, cube));
        vec2 rates = min(extinction * way * vec2(kelpBetween(density, f1), kelpBetween(density, f2)), 1e4);
        float depth = 0.5 * (rates.x + rates.y);
        if (fog.s == KELP_NEVER && depth > 0.0) {
          fog.s = kelpCurveRay(c, b);
          kelp_fog_coarser = place.coarser;
        }
#ifdef KELP_FOG_HEAT
        if (kelp_fog_ramp_colors > 0) {
          KelpCorners heat = kelpCorners(place.brick + KELP_FOG_CHANNEL, cube);
          heat = KelpCorners(heat.low * (1.0 / 255.0), heat.high * (1.0 / 255.0));
          // Emitted light, dimmed by the fog before it: the integral of the line through both rates.
          vec2 dimmed =
              exp(-max(vec2(dot(rates, vec2(0.25, -0.0386751)), dot(rates, vec2(0.5386751, 0.25))), 0.0));
          vec3 glow = 0.5 * (dimmed.x * kelpGlow(heat, f1, way.x) + dimmed.y * kelpGlow(heat, f2, way.y));
          fog.light += exp(-fog.depth) * glow;
          if (fog.s == KELP_NEVER && glow != vec3(0.0)) fog.s = kelpCurveRay(c, b);
        }
#endif
#ifdef KELP_FOG_SHADOW
        // 1 - exp(-d) cancels where d is small.
        fog.unlit += exp(-fog.depth) * (depth > 1e-2 ? 1.0 - exp(-depth) : depth * (1.0 - 0.5 * depth));
        if (fog.unlit > KELP_FOG_SEEN) {
          fog.lit = kelpFogSun(o + kelpCurveRay(c, b + 0.5 * x) * r, sun_at, fog.steps);
          fog.light += (fog.unlit * (fog.lit - 1.0)) * sun;
          fog.unlit = 0.0;
        }
#endif
        fog.depth += depth;
        b = next;
        u = per_side * kelpCurveAt(c, b) - 0.5;
        cube = kelpCube(u, place.samples);
        inside =
            b < leave && fog.depth < KELP_FOG_DEEP && cube >> 3 == place.at && fog.steps < KELP_FOG_STEPS;
      }
    }
    going = going && b < end && fog.depth < KELP_FOG_DEEP && fog.steps < KELP_FOG_STEPS;
  }
  return fog;
}

// Along all curves of o + s r, s in [s_min, s_max]. Comes after this text: fog_sheared.glsl, fog_swept.glsl.
KelpFog kelpFogThrough(vec3 o, vec3 r, float s_min, float s_max, vec3 sun, vec3 sun_at, KelpFog before);

// The fog of the loaded part and level along o + s r, s in [s_min, s_max], part space; o and r as in
// kelpEnter. In the result `light` is complete.
KelpFog kelpFog(vec3 o, vec3 r, float s_min, float s_max) {
  KelpFog fog = KelpFog(vec3(0.0), 0.0, KELP_NEVER, 0.0, 1.0, 0);
  kelpLoadFog();

  // The light is the same everywhere in a part. It is scattered evenly, or by the law of Henyey and
  // Greenstein.
  mat3 to_world = mat3(kelpPartToWorld());
  float forward = dot(normalize(to_world * r), kelp_sun_direction);
  float g = kelp_fog_anisotropy;
  float base = 1.0 + g * g - 2.0 * g * forward;
  vec3 color = kelp_fog_color * kelpRecord(kelp_record + 8).rgb;
  vec3 sun = color * kelp_sun_color * ((1.0 - g * g) / (12.5663706 * base * sqrt(base)));
  vec3 sky = color * 0.5 * (kelp_sky_color + kelp_ground_color);
  vec3 sun_at = normalize(inverse(to_world) * kelp_sun_direction);

  fog = kelpFogThrough(o, r, s_min, s_max, sun, sun_at, fog);
  // Of even light, what is stopped is scattered, wherever on the ray. Shadows were subtracted above.
  fog.light += (fog.unlit * (fog.lit - 1.0)) * sun + kelpHidden(fog) * (sun + sky);
  return fog;
}
