// SPDX-License-Identifier: MIT
// Linear light -> what the framebuffer gets: kelp::gl::View::output.

// Light up to 0.8 stays as it is. Brighter light is compressed so that it never reaches 1, and fades to white
// the brighter it is: the highlights of Khronos' PBR Neutral tone mapper, without its correction for Fresnel
// reflection.
vec3 kelpToneMap(vec3 light) {
  const float kStart = 0.8, kRoom = 1.0 - kStart, kFade = 0.15;
  float peak = max(max(light.r, light.g), light.b);
  if (peak < kStart) return max(light, 0.0);
  float mapped = 1.0 - kRoom * kRoom / (peak - kStart + kRoom);
  float white = 1.0 - 1.0 / (kFade * (peak - mapped) + 1.0);
  return mix(max(light, 0.0) * (mapped / peak), vec3(mapped), white);
}

// The transfer function of sRGB (IEC 61966-2-1).
vec3 kelpEncode(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, 1e-6), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

vec4 kelpOutput(vec4 light) {
  return kelp_display ? vec4(kelpEncode(kelpToneMap(light.rgb)), light.a) : light;
}
