// SPDX-License-Identifier: MIT
// The proxy of a posed part: what its deformed bounds cover in the picture, as at most four triangles
// between the corners of their outline. One fragment for every ray that meets the box in front of the eye.
// Drawn as a strip of six vertices.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "uniforms.glsl"
#include "instance.glsl"

KELP_LOCATION(0) out vec3 kelp_near;       // a point of the pixel's ray near the voxels, part space
KELP_LOCATION(1) flat out int kelp_texel;  // of the record

void main() {
  kelpLoadRecord(kelpRecordOf(KELP_INSTANCE));
  kelp_texel = kelp_record;
  vec4 x = kelpRecord(kelp_record);
  vec4 y = kelpRecord(kelp_record + 1);
  vec4 w = kelpRecord(kelp_record + 3);
  uint outline = kelpRecordBits(kelp_record + 12).w;
  vec3 clip;
  if (outline == 0u) {
    // The eye is in the box, or close to it: the whole picture. kelp_near at its corners is as far away as
    // the farthest corner of the box.
    float reach = 0.5 * (dot(w.xyz, kelp_bounds_min + kelp_bounds_max) +
                         dot(abs(w.xyz), kelp_bounds_max - kelp_bounds_min)) +
                  w.w;
    clip = vec3(KELP_VERTEX % 2 == 0 ? -reach : reach, KELP_VERTEX % 4 < 2 ? -reach : reach, reach);
    if (KELP_VERTEX > 3) clip.xy = vec2(reach);
    vec3 along = reach * cross(x.xyz, y.xyz) + clip.x * cross(y.xyz, w.xyz) + clip.y * cross(w.xyz, x.xyz);
    kelp_near = kelpRecord(kelp_record + 7).xyz + along / dot(w.xyz, cross(x.xyz, y.xyz));
  } else {
    uvec3 corner = (uvec3(outline) >> (uvec3(0u, 1u, 2u) + uint(3 * KELP_VERTEX))) & 1u;
    kelp_near = mix(kelp_bounds_min, kelp_bounds_max, vec3(corner));
    vec4 at = vec4(kelp_near, 1.0);
    clip = vec3(dot(x, at), dot(y, at), dot(w, at));
  }

  // Each fragment writes its depth. Here z = w / 2, which is between the planes with either clip control: a
  // box that reaches beyond the near or far plane must not be clipped, because the part between them is still
  // traced.
  gl_Position = vec4(clip.xy, 0.5 * clip.z, clip.z);
}
