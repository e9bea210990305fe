// SPDX-License-Identifier: MIT
// The proxy of a posed part: the far side of its deformed bounds. One fragment for every ray that leaves the box in front of the eye, also
// when the eye is inside.

out vec3 kelp_exit;          // where the pixel's ray leaves the bounds, part space
flat out int kelp_texel;     // of the record

void main() {
  kelpLoadRecord(kelpRecordOf(gl_InstanceID));
  kelp_texel = kelp_record;
  // Six faces of two triangles each; a corner is one of four, (across, up).
  const bool kAcross[6] = bool[6](false, true, true, false, true, false);
  const bool kUp[6] = bool[6](false, false, true, false, true, true);
  int axis = gl_VertexID / 12;
  bool upper = gl_VertexID % 12 >= 6;
  bool across = kAcross[gl_VertexID % 6];
  bool up = kUp[gl_VertexID % 6];
  bvec3 high = axis == 0 ? bvec3(upper, across, up) : (axis == 1 ? bvec3(up, upper, across) : bvec3(across, up, upper));
  kelp_exit = mix(kelp_bounds_min, kelp_bounds_max, vec3(high));

  // The rays leave through this face if they point the way it does. Decided here, not by the rasteriser's winding: mirrored instances,
  // flipped projections and the host's front face then make no difference.
  vec4 eye = kelpRecord(kelp_record + 7);
  float along = eye.w > 0.0 ? kelp_exit[axis] - eye[axis] : eye[axis];
  bool leaves = upper ? along > 0.0 : along < 0.0;

  // Depth is written per fragment. Here z = w / 2, between the planes in either of the clip controls, keeps what lies before the near or
  // beyond the far plane from being clipped away: the volume between them still has to be traced.
  vec4 clip = kelpPartToClip() * vec4(kelp_exit, 1.0);
  gl_Position = leaves ? vec4(clip.xy, 0.5 * clip.w, clip.w) : vec4(2.0, 2.0, 2.0, 1.0);
}
