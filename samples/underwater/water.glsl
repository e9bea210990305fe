// SPDX-License-Identifier: MIT
// The water's effect on light on its way down, and on its way to the eye. The voxels' surface function and
// the triangles' programs include this one text and share its uniform block.

layout(std140) uniform Water {  // scenery.h has the same in C++
  mat4 water_world_to_clip;
  mat4 water_clip_to_world;
  mat4 water_world_to_sun;  // to the texture of the sun's shadow map, 0 .. 1
  vec4 water_eye;           // world; w: seconds
  vec4 water_sun;           // towards the sun, unit; w: height of the water's surface
};

uniform sampler2DShadow water_sun_map;

const vec3 kWaterLoss = vec3(0.120, 0.046, 0.040);   // of light, per meter: red goes first
const vec3 kWaterDeep = vec3(0.002, 0.030, 0.075);   // looking down, level, up, into the sun
const vec3 kWaterLevel = vec3(0.008, 0.125, 0.215);
const vec3 kWaterAbove = vec3(0.070, 0.430, 0.560);
const vec3 kWaterSun = vec3(0.95, 1.00, 0.88);
const vec3 kWaterSunlight = vec3(4.6, 3.6, 2.75);  // under the surface, on a white wall that faces it

// How strongly waves on the surface gather the sun's light at a point: 1 in the mean. Let the surface have
// height h. Light that fell on a small square is spread, at depth d, over det(1 + d Hess h) times its area.
// Bright lines stand where that is 0.
float waterCaustics(vec3 at) {
  vec2 p = at.xz + water_sun.xz / water_sun.y * (water_sun.w - at.y);
  float t = water_eye.w;
  p += 0.16 * vec2(sin(1.7 * p.y + 0.7 * t), cos(1.9 * p.x - 0.6 * t));
  float xx = 0.0, xy = 0.0, yy = 0.0;
  float turn = 0.4;
  float size = 4.6;  // radians a meter
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
  return 0.30 + 0.70 * min(0.36 / (area + 0.07), 4.0);
}

// Sunlight that arrives at a point, before anything shades it. Far away, where a pixel is wider than a bright
// line, this is the mean.
vec3 waterSunlight(vec3 at) {
  float depth = max(water_sun.w - at.y, 0.0);
  float clear = exp(-0.015 * dot(at - water_eye.xyz, at - water_eye.xyz));
  return kWaterSunlight * exp(-0.45 * kWaterLoss * depth / water_sun.y) * mix(1.0, waterCaustics(at), clear);
}

// The share of the sun that no plant or fish hides from a point.
float waterSunlit(vec3 at) {
  vec3 place = (water_world_to_sun * vec4(at, 1.0)).xyz;
  vec2 texel = 1.0 / vec2(textureSize(water_sun_map, 0));
  float light = 0.0;
  for (int i = 0; i < 9; ++i) {
    vec2 at_texel = place.xy + 1.2 * texel * vec2(i % 3 - 1, i / 3 - 1);
    light += texture(water_sun_map, vec3(at_texel, place.z - 0.0015));
  }
  return light / 9.0;
}

// Light that comes from all around: blue, and less of it where the plants stand close to the sand.
vec3 waterAmbient(vec3 at, vec3 normal) {
  vec3 light = mix(vec3(0.040, 0.095, 0.120), vec3(0.260, 0.460, 0.540), 0.5 + 0.5 * normal.y);
  return light * mix(0.45, 1.0, smoothstep(-0.3, 1.3, at.y));
}

// Shafts of light: bands about the sun that wander and flicker, brightest near it.
float waterShafts(vec3 direction) {
  vec3 sun = water_sun.xyz;
  vec3 side = normalize(cross(sun, vec3(0.0, 0.0, 1.0)));
  vec3 other = cross(side, sun);
  float angle = atan(dot(direction, other), dot(direction, side));
  float t = water_eye.w;
  float bands = sin(11.0 * angle + 0.21 * t) + sin(23.0 * angle - 0.34 * t + 1.0) +
                0.7 * sin(37.0 * angle + 0.5 * t + 4.0);
  float near = smoothstep(-0.35, 0.75, dot(direction, sun));
  return near * near * smoothstep(0.0, 2.6, bands);
}

// The color of open water in a direction.
vec3 waterColor(vec3 direction) {
  vec3 color = mix(kWaterDeep, kWaterLevel, smoothstep(-0.55, 0.10, direction.y));
  color = mix(color, kWaterAbove, smoothstep(0.02, 0.85, direction.y));
  float towards = max(dot(direction, water_sun.xyz), 0.0);
  color += kWaterSun * (0.05 * pow(towards, 3.0) + 0.55 * pow(towards, 24.0));
  return color + kWaterAbove * 0.30 * waterShafts(direction);
}

// Tone mapping: bright light runs into white instead of being clipped.
vec3 waterTone(vec3 color) {
  color = 1.0 - exp(-1.5 * color);
  return mix(color, color * color * (3.0 - 2.0 * color), 0.55);
}

// A color as it reaches the eye through the water.
vec3 waterSeen(vec3 color, vec3 at) {
  vec3 way = at - water_eye.xyz;
  float distance = length(way);
  vec3 left = exp(-kWaterLoss * distance);
  color = color * left + waterColor(way / max(distance, 1e-4)) * (1.0 - left);
  return waterTone(color);
}
