// SPDX-License-Identifier: MIT
// Sand: ripples and grains finer than the triangles, caustics, and the shadows of plants and fish.
in vec3 at;
in vec3 upward;
out vec4 result;

float hash(vec2 cell) { return fract(sin(dot(cell, vec2(127.1, 311.7))) * 43758.5453); }

float noise(vec2 p) {
  vec2 cell = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(cell), hash(cell + vec2(1.0, 0.0)), f.x),
             mix(hash(cell + vec2(0.0, 1.0)), hash(cell + 1.0), f.x), f.y);
}

// The ripples' height in meters: crests that wander and fork.
float ripples(vec2 p) {
  float bend = 2.2 * noise(0.45 * p) + 0.9 * noise(1.3 * p + 7.0);
  float wave = sin(6.2831853 * (4.2 * p.y + 1.1 * p.x + bend));
  return 0.016 * (wave - 0.25 * wave * wave) * (0.35 + 0.9 * noise(0.6 * p + 3.0));
}

void main() {
  float distance = length(at - water_eye.xyz);
  const float kStep = 0.012;
  float h = ripples(at.xz);
  float fade = exp(-0.09 * distance);
  vec2 rise = vec2(ripples(at.xz + vec2(kStep, 0.0)) - h, ripples(at.xz + vec2(0.0, kStep)) - h);
  vec2 slope = fade * rise / kStep;
  vec3 normal = normalize(normalize(upward) - vec3(slope.x, 0.0, slope.y));

  float grain = noise(90.0 * at.xz) + noise(210.0 * at.xz + 5.0);
  float patches = noise(0.8 * at.xz + 11.0) + 0.5 * noise(2.7 * at.xz);
  vec3 sand = mix(vec3(0.46, 0.34, 0.19), vec3(0.86, 0.71, 0.46),
                  clamp(0.55 + 30.0 * h + 0.5 * (patches - 0.8), 0.0, 1.0));
  sand *= mix(1.0, 0.80 + 0.20 * grain, fade * fade);

  float facing = max(dot(normal, water_sun.xyz), 0.0);
  float light = waterSunlit(at);
  vec3 color = sand / 3.14159265 * waterSunlight(at) * facing * light;
  color += sand * waterAmbient(at, normal) * mix(0.62, 1.0, light) * 0.8;
  result = vec4(waterSeen(color, at), 1.0);
}
