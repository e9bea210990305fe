// SPDX-License-Identifier: MIT
// The ray of a fragment: from the proxy's varyings to a range of a line in part space.

KELP_LOCATION(0) in vec3 kelp_near;
KELP_LOCATION(1) flat in int kelp_texel;
#ifdef KELP_CAGED_ONLY
KELP_LOCATION(2) flat in uint kelp_face;
#endif

// One texel for each pixel; rays end there.
#ifdef KELP_VULKAN
layout(set = KELP_SET, binding = KELP_BINDING_SCENE_DEPTH) uniform texture2D kelp_scene_depth;
#else
uniform highp sampler2D kelp_scene_depth;
#endif

// The viewport's range of depths: where it begins, and how long it is.
#ifndef KELP_DEPTH_FIRST
#ifdef KELP_VULKAN
#define KELP_DEPTH_FIRST 0.0
#define KELP_DEPTH_RANGE 1.0
#else
#define KELP_DEPTH_FIRST gl_DepthRange.near
#define KELP_DEPTH_RANGE gl_DepthRange.diff
#endif
#endif

// Depth buffers round, those of 16 bits by 1/131070. So rays end this much beyond the scene's depth, in the
// buffer's own 0..1, and the depth test decides. Fog has no margin: the depth test knows only where it
// begins.
#ifndef KELP_SCENE_MARGIN
#define KELP_SCENE_MARGIN 1.5e-5
#endif

// kelp_near + s ray, s in range: between the near and far plane, and in front of the scene.
struct KelpPixelRay {
  bool good;  // the range is not empty
  vec3 ray;   // unit
  vec2 range;
  vec4 clip_at;     // clip coordinates at s = 0
  vec4 clip_slope;  // their change per s
};

// Loads the part's record.
KelpPixelRay kelpPixelRay(ivec2 pixel) {
  KelpPixelRay p;
  kelpLoadRecord(kelp_texel);
  p.ray = kelpViewRay(kelp_near);
  float reach = dot(p.ray, p.ray);
  p.good = reach > 0.0;
  p.ray *= inversesqrt(reach);

  // s = 0 near the voxels, so that numbers are small there, however far away the eye is.
  mat4 to_clip = kelpPartToClip();
  p.clip_at = to_clip * vec4(kelp_near, 1.0);
  p.clip_slope = to_clip * vec4(p.ray, 0.0);
  vec3 extent = kelp_bounds_max - kelp_bounds_min;
  float most = length(extent) + length(kelp_near - kelp_bounds_min - 0.5 * extent);
  p.range = vec2(-most, most);
  p.range = kelpClip(p.range, p.clip_at.z - kelp_clip_low * p.clip_at.w,
                     p.clip_slope.z - kelp_clip_low * p.clip_slope.w);
  p.range = kelpClip(p.range, p.clip_at.w - p.clip_at.z, p.clip_slope.w - p.clip_slope.z);
  if (kelp_scene != 0) {
    // The scene's depth is one more plane that cuts this ray.
    float side = kelp_scene == 1 ? 1.0 : -1.0;
    float depth = (texelFetch(kelp_scene_depth, pixel, 0).r - KELP_DEPTH_FIRST) / KELP_DEPTH_RANGE;
    float plane = mix(kelp_clip_low, 1.0, depth + side * KELP_SCENE_MARGIN / abs(KELP_DEPTH_RANGE));
    p.range = kelpClip(p.range, side * (plane * p.clip_at.w - p.clip_at.z),
                       side * (plane * p.clip_slope.w - p.clip_slope.z));
  }
  if (!(p.range.x <= p.range.y)) p.good = false;
  return p;
}

// The depth buffer's value for a point in clip space.
float kelpDepthOf(vec4 clip) {
  return KELP_DEPTH_FIRST + KELP_DEPTH_RANGE * ((clip.z / clip.w - kelp_clip_low) / (1.0 - kelp_clip_low));
}
