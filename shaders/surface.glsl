// SPDX-License-Identifier: MIT
// What a hit looks like. The host may replace kelpSurface (kelp::gl::Config::surface_glsl): its text is compiled in the place of the
// default below, with everything here and in instance.glsl and trace.glsl in scope. It may declare functions and constants of its own.

struct KelpSurface {
  vec3 position;    // world
  vec3 normal;      // world, unit, outward
  vec3 view;        // world, unit, from the surface towards the eye
  vec4 color;       // base colour, linear, times the instance's tint; a = coverage
  vec3 emissive;    // linear
  float metallic;
  float roughness;
  int material;     // palette index
  int level;        // of the voxel
  int steps;        // fetching steps that the ray took
  ivec3 voxel;      // of that level
  vec3 rest;        // the point in the undeformed part, level-0 voxels
  vec3 size;        // of the undeformed part, level-0 voxels
  int instance;     // index in the span that was drawn
  int part;
  vec4 clip;        // where the point is in clip space, and
  vec4 previous_clip;  // where it was in the frame before (the same, unless kelp::gl::View::previous_world_to_clip is given)
};

// From kelp::gl::View. Light that falls on a white, diffuse surface facing the sun leaves it as kelp_sun_color / pi.
uniform vec3 kelp_sun_direction;  // world, unit, towards the sun
uniform vec3 kelp_sun_color;
uniform vec3 kelp_sky_color;
uniform vec3 kelp_ground_color;

// Whether the voxels of the same part of the same instance stand between a point and the light: `distance` is in world units. Start a
// little off the surface, or the surface's own voxel is met.
bool kelpOccluded(vec3 world_position, vec3 world_direction, float distance) {
  mat4 to_world = kelpPartToWorld();
  mat3 to_part = inverse(mat3(to_world));
  vec3 origin = to_part * (world_position - to_world[3].xyz);
  vec3 direction = to_part * (distance * world_direction);
  float reach = length(direction);
  return reach > 0.0 && kelpTrace(origin, direction / reach, 0.0, reach).found;
}

// The sun's light that a surface sends to the eye: Lambert, softened where it would end abruptly, and a GGX highlight (Trowbridge-Reitz
// distribution; Smith visibility after Hammon's approximation; Schlick's Fresnel).
vec3 kelpSunLight(KelpSurface s, vec3 diffuse, vec3 specular) {
  const float kWrap = 0.15;
  float facing = dot(s.normal, kelp_sun_direction);
  float soft = max((facing + kWrap) / ((1.0 + kWrap) * (1.0 + kWrap)), 0.0);
  float to_light = max(facing, 0.0);
  float to_eye = max(abs(dot(s.normal, s.view)), 1e-3);
  vec3 middle = s.view + kelp_sun_direction;
  middle /= max(length(middle), 1e-4);
  float alpha = max(s.roughness * s.roughness, 0.02);
  float tilt = max(dot(s.normal, middle), 0.0);
  float spread = tilt * tilt * (alpha * alpha - 1.0) + 1.0;
  float distribution = alpha * alpha / (3.14159265 * spread * spread);
  float visibility = 0.5 / max(mix(2.0 * to_light * to_eye, to_light + to_eye, alpha), 1e-4);
  vec3 fresnel = specular + (1.0 - specular) * pow(1.0 - max(dot(s.view, middle), 0.0), 5.0);
  return kelp_sun_color * (diffuse * (soft / 3.14159265) + fresnel * (distribution * visibility * to_light));
}

// The sky above and the ground below, as a hemisphere each.
vec3 kelpSkyLight(KelpSurface s, vec3 diffuse, vec3 specular) {
  vec3 around = mix(kelp_ground_color, kelp_sky_color, 0.5 + 0.5 * s.normal.y);
  float mirror = dot(reflect(-s.view, s.normal), vec3(0.0, 1.0, 0.0));
  vec3 reflected = mix(kelp_ground_color, kelp_sky_color, smoothstep(-s.roughness - 0.1, s.roughness + 0.1, mirror));
  return diffuse * around + specular * (1.0 - 0.5 * s.roughness) * reflected;
}

#ifndef KELP_HOST_SURFACE
vec4 kelpSurface(KelpSurface s) {
  vec3 diffuse = s.color.rgb * (1.0 - s.metallic);
  vec3 specular = mix(vec3(0.04), s.color.rgb, s.metallic);
  return vec4(kelpSunLight(s, diffuse, specular) + kelpSkyLight(s, diffuse, specular) + s.emissive, 1.0);
}
#endif
