// SPDX-License-Identifier: MIT
// The proxy of a posed part. What its deformed bounds cover in the picture, as at most four triangles between
// the corners of their outline: one fragment for every ray that meets the box in front of the eye. Drawn as a
// strip of six vertices. Or, with KELP_CAGED_ONLY, the boundary faces of its cage that the eye sees from
// outside: one fragment for each that a ray enters. Drawn as a list of triangles.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "uniforms.glsl"
#include "instance.glsl"

KELP_LOCATION(0) out vec3 kelp_near;       // a point of the pixel's ray near the voxels, part space
KELP_LOCATION(1) flat out int kelp_texel;  // of the record
#ifdef KELP_CAGED_ONLY
KELP_LOCATION(2) flat out uint kelp_face;  // as in the list of boundary faces

// A node at a corner of a cell: kelp/formats/cage.h.
vec3 kelpCorner(uint cell, uint corner) {
  uint pair = KELP_CAGE_WORD(6u + 12u * cell + (corner >> 1u));
  return KELP_NODE((pair & 0x3fffffu) + (corner & 1u) * (pair >> 22u));
}

// The vertex's place in part space. False: its face has no part in the picture.
bool kelpFaceVertex(int vertex) {
  int number = vertex / 3;
  uint faces = kelpRecordBits(kelp_record + KELP_RECORD + 1).w;
  if (uint(number) >= faces || kelp_cage_at == 0u) return false;
  kelp_face = KELP_CAGE_WORD(4u + 12u * KELP_CAGE_WORD(0u) + uint(number));
  uint cell = kelp_face >> 5u;
  uint order = (kelp_face >> 2u) & 7u;
  // The tetrahedron's corners but 0 and 7; its faces on the boundary are 0 and 3.
  uint a = 1u << (order >> 1u);
  uint b = 7u - (1u << ((294u >> (2u * order)) & 3u));  // the last axes: 2 1 2 0 1 0
  bool low = (kelp_face & 3u) != 0u;
  vec3 p0 = kelpCorner(cell, low ? 0u : a);
  vec3 p1 = kelpCorner(cell, low ? a : b);
  vec3 p2 = kelpCorner(cell, low ? b : 7u);
  vec3 outward = cross(p1 - p0, p2 - p0);
  // Tetrahedra 0, 3 and 4 turn to the right.
  if (low == (order == 0u || order == 3u || order == 4u)) outward = -outward;
  int corner = vertex % 3;
  kelp_near = corner == 0 ? p0 : (corner == 1 ? p1 : p2);
  return dot(outward, kelpViewRay(p0)) < 0.0;
}
#endif

void main() {
  kelpLoadRecord(kelpRecordOf(KELP_INSTANCE));
  kelp_texel = kelp_record;
  vec4 x = kelpRecord(kelp_record);
  vec4 y = kelpRecord(kelp_record + 1);
  vec4 w = kelpRecord(kelp_record + 3);
  vec3 clip;
#ifdef KELP_CAGED_ONLY
  kelp_near = vec3(0.0);
  kelp_face = 0u;
  bool drawn = kelpFaceVertex(KELP_VERTEX);
  vec4 at = vec4(kelp_near, 1.0);
  clip = drawn ? vec3(dot(x, at), dot(y, at), dot(w, at)) : vec3(2.0, 2.0, 1.0);
#else
  uint outline = kelpRecordBits(kelp_record + 12).w;
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
#endif

  // Each fragment writes its depth. Here z = w / 2, which is between the planes with either clip control: a
  // box that reaches beyond the near or far plane must not be clipped, because the part between them is still
  // traced.
  gl_Position = vec4(clip.xy, 0.5 * clip.z, clip.z);
}
