// SPDX-License-Identifier: MIT
// The look of a hit. A host may replace kelpSurface (kelp::gl::RendererOptions::surface_glsl): its text is
// compiled in place of the default below, and may use everything here, in instance.glsl and in the tracing
// core. It may declare functions and constants of its own.
//
// A G-buffer: the text declares outputs of its own, at locations from 1 on (0 is what kelpSurface returns),
// and writes them:
//
//     layout(location = 1) out vec4 gbuffer_normal;
//     layout(location = 2) out vec4 gbuffer_motion;
//     layout(location = 3) out uvec2 gbuffer_tags;
//     vec4 kelpSurface(KelpSurface s) {
//       gbuffer_normal = vec4(0.5 + 0.5 * s.normal, s.roughness);
//       vec2 moved = s.clip.xy / s.clip.w - s.previous_clip.xy / s.previous_clip.w;
//       gbuffer_motion = vec4(moved, 0.0, s.metallic);
//       gbuffer_tags = uvec2(s.instance, s.material);
//       return s.color;
//     }
//
// Its own uniforms and textures are set in kelp::gl::View::bind.

struct KelpSurface {
  vec3 position;  // world
  vec3 normal;    // world, unit, outward
  vec3 view;      // world, unit, from the surface towards the eye
  vec4 color;     // base color, linear, times the instance's tint; a = coverage
  vec3 emissive;  // linear
  float metallic;
  float roughness;
  int material;  // palette index
  int level;     // of the voxel
  int steps;     // fetching steps that the ray took
  ivec3 voxel;   // of that level
  vec3 rest;     // the point in the undeformed part, level-0 voxels
  vec3 size;     // of the undeformed part, level-0 voxels
  int instance;  // index in the span that was drawn
  int part;
  vec4 clip;           // where the point is in clip space, and
  vec4 previous_clip;  // where it was in the frame before: the same without Camera::previous_world_to_clip.
                       // Both are 0 in what a host's own shader traces (scene.glsl).
};

#ifdef KELP_GRADIENT_ONLY
#define KELP_SHADING 0
#else
#define KELP_SHADING kelp_shading
#endif
#define KELP_SHADING_FACES 1
#define KELP_SHADING_SMOOTH 2

// Two numbers in [0, 1) that rotate a pixel's occlusion rays. They differ between neighbors, and stay the
// same from frame to frame.
vec2 kelp_jitter = vec2(0.5);
// Interleaved gradient noise (J. Jimenez, "Next Generation Post Processing in Call of Duty:
// Advanced Warfare").
vec2 kelpJitter(vec2 place) {
  vec4 both = vec4(place, place + vec2(95.00005, 53.0));
  float first = dot(both.xy, vec2(0.06711056, 0.00583715));
  float second = dot(both.zw, vec2(0.00583715, 0.06711056));
  return fract(52.9829189 * fract(vec2(first, second)));
}

#define KELP_WRAP 0.15  // how far beyond the terminator the sun still lights a surface

// True if voxels of the same part of the same instance are between a point and the light. `distance` in world
// units. Start a little off the surface, or the ray meets the surface's own voxel.
bool kelpOccluded(vec3 world_position, vec3 world_direction, float distance) {
  mat4 to_world = kelpPartToWorld();
  mat3 to_part = inverse(mat3(to_world));
  vec3 origin = to_part * (world_position - to_world[3].xyz);
  vec3 direction = to_part * (distance * world_direction);
  float reach = length(direction);
  return reach > 0.0 && kelpTrace(origin, direction / reach, 0.0, reach).found;
}

// How much light reaches a surface past the voxels of the same part of the same instance. x: the sun's, 0 or
// 1 (1 without `sun`). y: the sky's, the mean over `rays` cosine-weighted rays (1 without any). A ray that
// hits at distance d counts as stopped by 1 - (d / reach)^2; `reach` is a fraction of the longest side of the
// undeformed part. Rays start 1.75 voxels off the surface, because a surface of cubes has steps that its
// normal does not show. If faces are shown, 1/16 of a voxel. Where that is inside a solid, as in a narrow
// gap, half as much, up to three times. Rays meet a part with a cage only where the view asks for them
// (Quality::self_shadow, occlusion_rays) or a host casts them: other records have no tree.
vec2 kelpVisible(KelpSurface s, bool sun, int rays, float reach) {
  const float kTurn = 2.39996323;  // the golden angle
  vec2 visible = vec2(1.0);
  float facing = dot(s.normal, kelp_sun_direction);
  int first = sun && facing > -KELP_WRAP ? -1 : 0;
  if (first == rays) return visible;
  mat4 to_world = kelpPartToWorld();
  mat3 to_part = inverse(mat3(to_world));
  float voxel = length(to_world[0]) * float(1 << s.level);
  float lift = KELP_SHADING == KELP_SHADING_FACES ? 0.0625 : 1.75;
  vec3 foot = to_part * (s.position - to_world[3].xyz);
  vec3 off = to_part * (voxel * s.normal);
  float far = reach * max(max(s.size.x, s.size.y), s.size.z);
  vec3 across = normalize(abs(s.normal.y) < 0.9 ? vec3(s.normal.z, 0.0, -s.normal.x)
                                                : vec3(0.0, -s.normal.z, s.normal.y));
  vec3 beside = cross(s.normal, across);
  float stopped = 0.0;
  int halvings = 0;
  for (int i = first; i < rays; ++i) {
    // Just beyond the terminator, where kelpSunLight is not 0 yet, the sun's ray runs along the surface.
    vec3 towards = kelp_sun_direction + max(-facing, 0.0) * s.normal;
    if (i >= 0) {
      float inner = (float(i) + kelp_jitter.y) / float(rays);
      float angle = kTurn * float(i) + 6.28318531 * kelp_jitter.x;
      towards = sqrt(inner) * (cos(angle) * across + sin(angle) * beside) + sqrt(1.0 - inner) * s.normal;
    }
    float limit = i < 0 ? length(kelp_bounds_max - kelp_bounds_min) + 4.0 : far;
    KelpHit hit = kelpTrace(foot + lift * off, normalize(to_part * towards), 0.0, limit);
    if (!hit.found) continue;
    if (hit.s <= 0.0 && halvings < 3) {
      ++halvings;
      lift *= 0.5;
      --i;  // once more
      continue;
    }
    if (i < 0)
      visible.x = 0.0;
    else
      stopped += 1.0 - hit.s * hit.s / (limit * limit);
  }
  if (rays > 0) visible.y -= stopped / float(rays);
  return visible;
}

#ifdef KELP_DISTANCES
// Loads the record of the next part of the same instance. False: that was `own`, with which the ring began.
// Records ascend in a ring, but for one step; so whatever they hold, it ends, and `own` is loaded. There is
// no ring where the view asks for neither of these.
bool kelpNextPart(int own, inout bool went_back) {
  if (!kelp_occlusion && kelp_sun_radius == 0.0) return false;
  int before = kelp_record;
  kelpLoadRecord(int(kelpRecordBits(kelpRecordEnd()).x));
  bool back = kelp_record <= before;
  bool more = kelp_record != own && !(back && went_back);
  if (kelp_record != own && !more) kelpLoadRecord(own);
  went_back = went_back || back;
  return more;
}

// World -> the space of the part of this record.
struct KelpToPart {
  mat3 turn;
  vec3 origin;  // of part space, in the world
  float voxel;  // world
};
KelpToPart kelpToPart() {
  mat4 to_world = kelpPartToWorld();
  return KelpToPart(inverse(mat3(to_world)), to_world[3].xyz, length(to_world[0]));
}

// How much of the sky a surface sees past the solid voxels of its instance, as very many rays of kelpVisible
// would measure it, from distances at 14 points up to `reach` (world) away: three along each of four
// directions, two along the normal. A distance as large as it can be leaves the whole cone around a direction
// free. The numbers fit 256 rays at six models (shaders/METHOD.md).
float kelpOcclusion(KelpSurface s, float reach) {
  const float kHeights[5] = float[5](0.07, 0.2, 0.5, 0.1, 0.4);
  vec3 across = normalize(abs(s.normal.y) < 0.9 ? vec3(s.normal.z, 0.0, -s.normal.x)
                                                : vec3(0.0, -s.normal.z, s.normal.y));
  vec3 beside = cross(s.normal, across);
  float angle = 1.57079633 * kelp_jitter.x;
  vec3 lean = 0.717356 * (cos(angle) * across + sin(angle) * beside);
  vec3 turned = 0.717356 * (cos(angle) * beside - sin(angle) * across);
  vec3 rise = 0.696707 * s.normal;
  vec4 cones = vec4(1.0);
  vec2 ahead = vec2(1.0);
  int own = kelp_record;
  bool went_back = false;
  do {
    kelpLoadDistances();
    KelpToPart part = kelpToPart();
    vec3 foot = part.turn * (s.position - part.origin);
    vec3 gap = max(max(kelp_bounds_min - foot, foot - kelp_bounds_max), vec3(0.0));
    if (length(gap) * part.voxel < 2.0 * reach) {
      vec3 n = normalize(s.normal * mat3(kelpPartToWorld()));
      for (int i = 0; i < 5; ++i) {
        float height = kHeights[i] * reach;
        KelpDistances level;
        if (!kelpLevelOf(height / part.voxel, level)) continue;
        vec4 free = vec4(1.0);
        for (int k = 0; k < (i < 3 ? 4 : 1); ++k) {
          vec3 side = (k & 1) == 0 ? lean : turned;
          vec3 towards = i >= 3 ? s.normal : rise + (k < 2 ? side : -side);
          float d = kelpNearby(part.turn * (s.position + height * towards - part.origin), n, level);
          free[k] = d * part.voxel / height;
        }
        if (i < 3)
          cones = min(cones, free * (1.0 / 0.696707));
        else
          ahead[i - 3] = min(ahead[i - 3], free.x);
      }
    }
  } while (kelpNextPart(own, went_back));
  cones = max(cones, vec4(-0.2));
  ahead = max(ahead, vec2(-0.3));
  float open = 0.389 * ahead.x + 0.364 * ahead.y + 1.022 * 0.25 * (cones.x + cones.y + cones.z + cones.w);
  return clamp(0.245 + (1.022 - 0.336 * open) * open, 0.0, 1.0);  // 1 in the open
}

// The share of the sun's disc that a surface sees past the solid voxels of its instance. One ray goes to its
// middle. The empty boxes along it, or the depth behind what it hits, tell where all of the disc is seen or
// hidden. Elsewhere three more rays go to its rim, and where the four disagree another five.
float kelpSunVisible(KelpSurface s, float radius) {
  float facing = dot(s.normal, kelp_sun_direction);
  if (facing <= -KELP_WRAP) return 1.0;
  vec3 sun = normalize(kelp_sun_direction + max(-facing, 0.0) * s.normal);
  vec3 across = normalize(abs(sun.y) < 0.9 ? vec3(sun.z, 0.0, -sun.x) : vec3(0.0, -sun.z, sun.y));
  vec3 beside = cross(sun, across);
  float lift = KELP_SHADING == KELP_SHADING_FACES ? 0.0625 : 1.75;
  vec3 from = s.position + lift * length(kelpPartToWorld()[0]) * float(1 << s.level) * s.normal;
  float visible = 1.0;
  int own = kelp_record;
  int own_level = kelp_level;
  bool went_back = false;
  do {
    KelpToPart part = kelpToPart();
    vec3 origin = part.turn * (from - part.origin);
    float far = length(kelp_bounds_max - kelp_bounds_min) +
                length(origin - clamp(origin, kelp_bounds_min, kelp_bounds_max));
    if (!kelpLoadLevel(kelp_record == own ? own_level : int(kelpRecordBits(kelp_record + 11).w & 255u)))
      far = -1.0;  // nothing to hit
    kelpLoadDistances();
    kelp_cone = radius;
    vec3 middle = normalize(part.turn * sun);
    KelpHit hit = kelpTrace(origin, middle, 0.0, far);
    kelp_cone = 0.0;
    bool sure = hit.room >= 1.0;
    if (hit.found) {
      float reach = radius * hit.s + 0.6;  // of what must be solid
      float depth = 0.0;
      KelpDistances finest;
      if (kelpLevelOf(0.0, finest)) {
        for (int i = 0; i < 3; ++i) {
          vec3 behind = origin + (hit.s + reach * exp2(float(i))) * middle;
          depth = max(depth, -kelpNearby(behind, vec3(0.0), finest));
        }
      }
      sure = depth >= reach;
    }
    float seen = hit.found ? 0.0 : 1.0;
    if (!sure) {
      float rays = 1.0;
      for (int i = 0; i < 8; ++i) {
        if (i == 3 && (seen == 0.0 || seen == 4.0)) break;
        // Three near the rim; then five within.
        float angle = i < 3 ? 2.0943951 * (float(i) + kelp_jitter.x) : 1.2566371 * (float(i) + kelp_jitter.y);
        float out_by = radius * (i < 3 ? 0.9 : 0.62);
        vec3 towards = normalize(part.turn * (sun + out_by * (cos(angle) * across + sin(angle) * beside)));
        if (!kelpTrace(origin, towards, 0.0, far).found) seen += 1.0;
        rays += 1.0;
      }
      seen /= rays;
    }
    visible *= seen;
  } while (kelpNextPart(own, went_back));
  kelpLoadLevel(own_level);
  return visible;
}
#endif

// As kelp::gl::Quality says: self_shadow and occlusion_rays, or soft_shadows and occlusion, and
// occlusion_reach.
vec2 kelpVisible(KelpSurface s) {
#ifdef KELP_DISTANCES
  vec2 visible = vec2(1.0);
  bool soft = kelp_sun_radius > 0.0;
#if defined(KELP_SECONDARY_RAYS) || defined(KELP_HOST_SURFACE)
  visible = kelpVisible(s, kelp_self_shadow && !soft, kelp_occlusion ? 0 : min(kelp_occlusion_rays, 16),
                        kelp_occlusion_reach);
#endif
  if (soft) visible.x = kelpSunVisible(s, kelp_sun_radius);
  if (kelp_occlusion)
    visible.y = kelpOcclusion(
        s, kelp_occlusion_reach * max(max(s.size.x, s.size.y), s.size.z) * length(kelpPartToWorld()[0]));
  return visible;
#else
  return kelpVisible(s, kelp_self_shadow, min(kelp_occlusion_rays, 16), kelp_occlusion_reach);
#endif
}

// The sun's light that a surface sends to the eye: Lambert, softened at the terminator, and a GGX highlight
// (Trowbridge-Reitz distribution, Smith visibility as approximated by Hammon, Schlick's Fresnel).
vec3 kelpSunLight(KelpSurface s, vec3 diffuse, vec3 specular) {
  float facing = dot(s.normal, kelp_sun_direction);
  float soft = max((facing + KELP_WRAP) / ((1.0 + KELP_WRAP) * (1.0 + KELP_WRAP)), 0.0);
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

// The light of the sky above and the ground below, a hemisphere each.
vec3 kelpSkyLight(KelpSurface s, vec3 diffuse, vec3 specular) {
  vec3 around = mix(kelp_ground_color, kelp_sky_color, 0.5 + 0.5 * s.normal.y);
  float mirror = dot(reflect(-s.view, s.normal), vec3(0.0, 1.0, 0.0));
  vec3 reflected =
      mix(kelp_ground_color, kelp_sky_color, smoothstep(-s.roughness - 0.1, s.roughness + 0.1, mirror));
  return diffuse * around + specular * (1.0 - 0.5 * s.roughness) * reflected;
}

#if !defined(KELP_HOST_SURFACE) && !defined(KELP_DEBUG)
vec4 kelpSurface(KelpSurface s) {
  vec3 diffuse = s.color.rgb * (1.0 - s.metallic);
  vec3 specular = mix(vec3(0.04), s.color.rgb, s.metallic);
#if defined(KELP_SECONDARY_RAYS) || defined(KELP_DISTANCES)
  vec2 visible = kelpVisible(s);
#else
  const vec2 visible = vec2(1.0);
#endif
  return vec4(visible.x * kelpSunLight(s, diffuse, specular) +
                  visible.y * kelpSkyLight(s, diffuse, specular) + s.emissive,
              1.0);
}
#endif
