// SPDX-License-Identifier: MIT
// Draws fog over what is there: premultiplied color, and in alpha how much of what is behind is hidden.
// Writes the depth at which the fog begins. No depth buffer keeps it: it serves the depth test where there
// is no copy of the scene's depth.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "uniforms.glsl"
#include "instance.glsl"
#include "spline.glsl"
#include "curve.glsl"
#include "trace.glsl"
#ifdef KELP_SWEPT_ONLY
#include "arc.glsl"
#include "sweep_record.glsl"
#include "sweep.glsl"
#include "fog.glsl"
#include "fog_swept.glsl"
#else
#include "fog.glsl"
#include "fog_sheared.glsl"
#endif
#define KELP_SCENE_MARGIN 0.0
#include "pixel.glsl"
#include "output.glsl"
#ifdef KELP_DEBUG
#include "debug.glsl"
#endif

layout(location = 0) out vec4 kelp_color;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  KelpPixelRay p = kelpPixelRay(pixel);
  if (!p.good) discard;
  if (!kelpLoadLevel(kelpPixelLevel(pixel))) discard;
  KelpFog fog = kelpFog(kelp_near, p.ray, p.range.x, p.range.y);
  if (fog.s == KELP_NEVER) discard;
  gl_FragDepth = kelpDepthOf(p.clip_at + fog.s * p.clip_slope);
#ifdef KELP_DEBUG
  uvec4 tags = kelpRecordBits(kelp_record + 12);
  vec3 color = kelpDebugColor(int(tags.y), int(tags.z), fog.steps, kelp_level + kelp_fog_coarser);
  // Thin fog is seen too.
  float seen = kelp_debug == KELP_DEBUG_STEPS ? 1.0 : 0.25 + 0.75 * kelpHidden(fog);
  kelp_color = seen * kelpOutput(vec4(color, 1.0));
#else
  kelp_color = kelpOutput(vec4(min(fog.light, 1e30), kelpHidden(fog)));
#endif
}
