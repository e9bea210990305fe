// SPDX-License-Identifier: MIT
// The colors of kelp::gl::View::debug, linear light. Stands where a host's surface would, or before fog.frag.
// The text before declares `int kelp_debug`, a uniform or a constant.

#define KELP_DEBUG_PARTS 1
#define KELP_DEBUG_STEPS 2

vec3 kelpHue(float turn, float gray) {
  vec3 color = mix(0.55 + 0.4 * cos(6.2831853 * (turn + vec3(0.0, 0.33, 0.67))), vec3(0.6), gray);
  return color * color;
}
float kelpTurn(uint n) { return float(n >> 8u) / 16777216.0; }

// True where the view wants a finer level than is drawn.
bool kelpMissing(int level) {
#ifdef KELP_RECORD
  return level > kelpPixelLevel(ivec2(gl_FragCoord.xy)) ||
         (kelpRecordBits(kelp_record + 11).w & 0x8000u) != 0u;
#else
  return false;
#endif
}

vec3 kelpDebugColor(int instance, int part, int steps, int level) {
  if (kelp_debug == KELP_DEBUG_PARTS) {
    // Fractions of multiples of irrational numbers: neighbors get colors far from each other.
    uint i = uint(instance);
    return kelpHue(kelpTurn(2654435769u * uint(part) + 3242174889u * i), 0.5 * kelpTurn(2447445414u * i));
  }
  if (kelp_debug == KELP_DEBUG_STEPS) {
    // Blue 0, green 16, yellow 32, red 64 and more.
    float x = clamp(float(steps) / 64.0, 0.0, 1.0);
    vec3 low = mix(vec3(0.1, 0.2, 0.7), vec3(0.1, 0.75, 0.3), clamp(4.0 * x, 0.0, 1.0));
    vec3 middle = mix(low, vec3(0.95, 0.85, 0.2), clamp(4.0 * x - 1.0, 0.0, 1.0));
    vec3 color = mix(middle, vec3(0.85, 0.1, 0.1), clamp(2.0 * x - 1.0, 0.0, 1.0));
    return color * color;
  }
  // Level 0 is gray; black stripes: a finer level is missing.
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (((pixel.x + pixel.y) & 7) < 2 && kelpMissing(level)) return vec3(0.0);
  return level == 0 ? vec3(0.64) : kelpHue(0.618034 * float(level), 0.0);
}

#ifdef KELP_SHADING_FACES  // after surface.glsl
// Lit from the eye, so that the shape is seen; steps are plain.
vec4 kelpSurface(KelpSurface s) {
  float light = kelp_debug == KELP_DEBUG_STEPS ? 1.0 : 0.45 + 0.55 * max(dot(s.normal, s.view), 0.0);
  return vec4(light * kelpDebugColor(s.instance, s.part, s.steps, s.level), 1.0);
}
#endif
