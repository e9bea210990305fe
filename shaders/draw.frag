// SPDX-License-Identifier: MIT
// Traces the pixel's ray through a posed part, gives the hit to kelpSurface, writes real depth.

in vec3 kelp_near;
flat in int kelp_texel;
layout(location = 0) out vec4 kelp_color;

uniform bool kelp_depth_only;  // one program for both passes: the depths are the same to the bit
uniform float kelp_clip_low;   // z / w of the lower clip plane: -1, or 0 with clip control GL_ZERO_TO_ONE
uniform int kelp_scene;        // what kelp_scene_depth is: 0 nothing, 1 depth, 2 reversed depth
uniform highp sampler2D kelp_scene_depth;  // a texel a pixel: nothing beyond it need be drawn

// Depth buffers round, those of 16 bits by 1/131070: what lies this little beyond theirs is left to the depth test. Of the buffer's own 0..1.
#define KELP_SCENE_MARGIN 1.5e-5

// Narrows s so that value + s * slope >= 0: a clip plane, exact because clip coordinates are linear along the ray.
vec2 kelpClip(vec2 s, float value, float slope) {
  if (slope > 0.0) return vec2(max(s.x, -value / slope), s.y);
  if (slope < 0.0) return vec2(s.x, min(s.y, -value / slope));
  return value < 0.0 ? vec2(1.0, 0.0) : s;
}

// Where a point of the undeformed part was in clip space in the frame before.
vec4 kelpPreviousClip(vec3 rest) {
  int rows = kelp_record + KELP_RECORD + 3 * kelp_segment_count;
  int spline = rows + 4;
  float low = kelpStart(spline, 0).y;
  float y = low + rest.y / kelp_size.y * (kelpEnd(spline, kelp_segment_count - 1).y - low);
  int i = 0;
  while (i + 1 < kelp_segment_count && y > kelpEnd(spline, i).y) ++i;
  KelpSegment g = KELP_SEGMENT_AT(spline, i);
  vec3 shift = kelpSplineAt(g, kelpSplineParameter(g, y - g.p0.y, g.p1.y - y));
  return kelpRows(rows, kelpRecord(rows + 3)) * vec4(rest.x + shift.x, y, rest.z + shift.z, 1.0);
}

// The colour of a hit; clip: where it is in clip space.
vec4 kelpShade(KelpHit hit, vec3 position, vec3 ray, vec4 clip) {
  kelpLoadLevel(kelp_level + hit.coarser);
  KelpSurface s = kelpSurfaceAt(hit, position, ray);
  s.clip = clip;
  s.previous_clip = kelp_motion ? kelpPreviousClip(hit.rest) : clip;
  return kelpSurface(s);
}

void main() {
  kelpLoadRecord(kelp_texel);
  vec3 ray = kelpViewRay(kelp_near);
  float reach = dot(ray, ray);
  if (!(reach > 0.0)) discard;
  ray *= inversesqrt(reach);
  ivec2 pixel = ivec2(gl_FragCoord.xy);

  // s = 0 beside the voxels, so that numbers are small there, however far the eye is.
  mat4 to_clip = kelpPartToClip();
  vec4 clip_at = to_clip * vec4(kelp_near, 1.0);
  vec4 clip_slope = to_clip * vec4(ray, 0.0);
  vec3 extent = kelp_bounds_max - kelp_bounds_min;
  float most = length(extent) + length(kelp_near - kelp_bounds_min - 0.5 * extent);
  vec2 range = vec2(-most, most);
  range = kelpClip(range, clip_at.z - kelp_clip_low * clip_at.w, clip_slope.z - kelp_clip_low * clip_slope.w);
  range = kelpClip(range, clip_at.w - clip_at.z, clip_slope.w - clip_slope.z);
  if (kelp_scene != 0) {
    // The scene's depth is one more plane across this ray.
    float side = kelp_scene == 1 ? 1.0 : -1.0;
    float depth = (texelFetch(kelp_scene_depth, pixel, 0).r - gl_DepthRange.near) / gl_DepthRange.diff;
    float plane = mix(kelp_clip_low, 1.0, depth + side * KELP_SCENE_MARGIN / abs(gl_DepthRange.diff));
    range = kelpClip(range, side * (plane * clip_at.w - clip_at.z), side * (plane * clip_slope.w - clip_slope.z));
  }
  if (!(range.x <= range.y)) discard;

  kelp_jitter = kelpJitter(vec2(pixel));
  kelpLoadLevel(kelpPixelLevel(pixel));
  KelpHit hit = kelpTrace(kelp_near, ray, range.x, range.y);
  if (!hit.found) discard;

  vec4 clip = clip_at + hit.s * clip_slope;
  gl_FragDepth = gl_DepthRange.near + gl_DepthRange.diff * ((clip.z / clip.w - kelp_clip_low) / (1.0 - kelp_clip_low));
  kelp_color = kelp_depth_only ? vec4(0.0) : kelpShade(hit, kelp_near + hit.s * ray, ray, clip);
}
