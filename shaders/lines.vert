// SPDX-License-Identifier: MIT
// Lines over the picture: each record texel is a point, with clip x, y and w, and its color in z, 8 bits each
// of red, green and blue. (For z see draw.vert.)
#version 450
#extension GL_GOOGLE_include_directive : require

#include "uniforms.glsl"
#include "instance.glsl"

KELP_LOCATION(0) flat out vec3 kelp_line_color;

void main() {
  uvec4 point = kelpRecordBits(KELP_VERTEX);
  vec4 at = uintBitsToFloat(point);
  kelp_line_color = vec3((uvec3(point.z) >> uvec3(0u, 8u, 16u)) & 255u) / 255.0;
  gl_Position = vec4(at.xy, 0.5 * at.w, at.w);
}
