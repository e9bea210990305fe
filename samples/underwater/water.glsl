// SPDX-License-Identifier: MIT
// The water, for everything that is drawn: what it does to light on its way down, and on its way to the eye. One text for the voxels'
// surface function and for the triangles' programs, one uniform block for all of them.

layout(std140) uniform Water {   // water.h has the same in C++
  mat4 water_world_to_clip;
  mat4 water_clip_to_world;
  mat4 water_world_to_sun;       // to the texture of the sun's shadow map, 0 .. 1
  vec4 water_eye;                // world; w: seconds
  vec4 water_sun;                // towards the sun, unit; w: height of the water's surface
};

const vec3 kWaterLoss = vec3(0.150, 0.070, 0.062);   // of light, per metre: red goes first
const vec3 kWaterDeep = vec3(0.004, 0.055, 0.115);   // looking down, level, up, into the sun
const vec3 kWaterLevel = vec3(0.022, 0.235, 0.330);
const vec3 kWaterAbove = vec3(0.140, 0.560, 0.640);
const vec3 kWaterSun = vec3(0.95, 1.00, 0.88);
const vec3 kWaterSunlight = vec3(2.30, 2.25, 1.95);  // under the surface, on a white wall that faces it

// How strongly waves on the surface gather the sun's light at a point: 1 in the mean. Where the surface's height is h, light that fell on a
// small square is spread over the determinant of 1 + d Hess h of its area some way d below, so bright lines stand where that is 0.
float waterCaustics(vec3 at) {
  vec2 p = at.xz + water_sun.xz / water_sun.y * (water_sun.w - at.y);
  float t = water_eye.w;
  p += 0.22 * vec2(sin(0.9 * p.y + 0.7 * t), cos(1.1 * p.x - 0.6 * t));
  float xx = 0.0, xy = 0.0, yy = 0.0;
  float turn = 0.4;
  float size = 2.1;  // radians a metre
  for (int i = 0; i < 6; ++i) {
    vec2 k = size * vec2(cos(turn), sin(turn));
    float bend = sin(dot(k, p) + (1.1 + 0.55 * float(i)) * t + 1.7 * float(i * i)) / float(i + 3);
    vec2 n = k / size;
    xx += bend * n.x * n.x;
    xy += bend * n.x * n.y;
    yy += bend * n.y * n.y;
    turn += 2.4;
    size *= 1.28;
  }
  const float kDepth = 1.9;
  float area = abs((1.0 + kDepth * xx) * (1.0 + kDepth * yy) - kDepth * kDepth * xy * xy);
  return 0.42 + 0.62 * min(0.30 / (area + 0.08), 3.0);
}

// Sunlight that arrives at a point, before anything shades it.
vec3 waterSunlight(vec3 at) {
  float depth = max(water_sun.w - at.y, 0.0);
  return kWaterSunlight * exp(-0.45 * kWaterLoss * depth / water_sun.y) * waterCaustics(at);
}

// Light that comes from all around: blue, and less of it where the plants stand close to the sand.
vec3 waterAmbient(vec3 at, vec3 normal) {
  vec3 light = mix(vec3(0.055, 0.130, 0.150), vec3(0.300, 0.560, 0.620), 0.5 + 0.5 * normal.y);
  return light * mix(0.45, 1.0, smoothstep(-0.3, 1.3, at.y));
}

// Shafts of light: bands about the sun that wander and flicker, brightest near it.
float waterShafts(vec3 direction) {
  vec3 sun = water_sun.xyz;
  vec3 side = normalize(cross(sun, vec3(0.0, 0.0, 1.0)));
  vec3 other = cross(side, sun);
  float angle = atan(dot(direction, other), dot(direction, side));
  float t = water_eye.w;
  float bands = sin(11.0 * angle + 0.21 * t) + sin(23.0 * angle - 0.34 * t + 1.0) + 0.7 * sin(37.0 * angle + 0.5 * t + 4.0);
  float near = smoothstep(-0.35, 0.75, dot(direction, sun));
  return near * near * smoothstep(0.0, 2.6, bands);
}

// What is seen where nothing is in the way.
vec3 waterColour(vec3 direction) {
  vec3 colour = mix(kWaterDeep, kWaterLevel, smoothstep(-0.55, 0.10, direction.y));
  colour = mix(colour, kWaterAbove, smoothstep(0.02, 0.85, direction.y));
  float towards = max(dot(direction, water_sun.xyz), 0.0);
  colour += kWaterSun * (0.10 * pow(towards, 3.0) + 0.55 * pow(towards, 24.0));
  return colour + kWaterAbove * 0.30 * waterShafts(direction);
}

// A colour as it reaches the eye through the water, made fit for the screen: bright lights run into white instead of being cut off.
vec3 waterSeen(vec3 colour, vec3 at) {
  vec3 way = at - water_eye.xyz;
  float distance = length(way);
  vec3 left = exp(-kWaterLoss * distance);
  colour = colour * left + waterColour(way / max(distance, 1e-4)) * (1.0 - left);
  return 1.0 - exp(-1.25 * colour);
}
