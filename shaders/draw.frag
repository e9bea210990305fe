// SPDX-License-Identifier: MIT
// Traces the pixel's ray through a posed part, gives the hit to kelpSurface, writes real depth.

in vec3 kelp_exit;
flat in int kelp_texel;
layout(location = 0) out vec4 kelp_color;

uniform bool kelp_depth_only;  // one program for both passes: the depths are the same to the bit

// Narrows s so that value + s * slope >= 0: a clip plane, exact because clip coordinates are linear along the ray.
vec2 kelpClip(vec2 s, float value, float slope) {
  if (slope > 0.0) return vec2(max(s.x, -value / slope), s.y);
  if (slope < 0.0) return vec2(s.x, min(s.y, -value / slope));
  return value < 0.0 ? vec2(1.0, 0.0) : s;
}

vec4 kelpShade(KelpHit hit, vec3 position, vec3 ray) {
  uint entry;
  KelpMaterial material;
  vec3 normal = -ray;
  if (kelpIsSurface(hit.code)) {
    uint bits = kelpAttribute(hit.slot, hit.voxel.z & 7, hit.code);
    entry = bits & 255u;
    KelpSegment top = KELP_SEGMENT(KELP_SEGMENTS - 1);
    KelpSegment bottom = KELP_SEGMENT(0);
    KelpSegment g = KELP_SEGMENT(hit.segment);
    float stretch = kelp_size.y / (top.p1.y - bottom.p0.y);
    vec3 rest_normal;
    if (kelp_shading == KELP_SHADING_SMOOTH) {
      rest_normal = kelpSmoothNormal(hit, kelpRestDirection(g, hit.t, stretch, ray), material);
    } else {
      rest_normal = kelp_shading == KELP_SHADING_FACES ? kelpEntryFace(hit, kelpRestDirection(g, hit.t, stretch, ray))
                                                       : kelpDecodeNormal(bits >> 8u);
      material = kelpMaterial(int(entry));
    }
    vec3 bent = kelpDeformNormal(g, hit.t, stretch, rest_normal);
    normal = dot(bent, bent) > 0.0 ? bent : normal;
  } else {
    entry = kelpInnerMaterial(hit.voxel);
    material = kelpMaterial(int(entry));
  }

  KelpSurface s;
  mat4 to_world = kelpPartToWorld();
  s.position = (to_world * vec4(position, 1.0)).xyz;
  s.normal = normalize(kelpNormalToWorld(normal));
  s.view = normalize(mat3(to_world) * -ray);
  s.color = material.color * kelpRecord(kelp_record + 11);
  s.emissive = material.glow.rgb;
  s.metallic = material.glow.a;
  s.roughness = material.roughness;
  s.material = int(entry);
  s.level = kelp_level;
  s.steps = hit.steps;
  s.voxel = hit.voxel;
  s.rest = hit.rest;
  s.size = kelp_size;
  return kelpSurface(s);
}

void main() {
  kelpLoadRecord(kelp_texel);
  vec3 ray = kelpViewRay(kelp_exit);
  float reach = dot(ray, ray);
  if (!(reach > 0.0)) discard;
  ray *= inversesqrt(reach);

  // s = 0 at the exit, so that numbers are small where the voxels are, however far the eye is.
  mat4 to_clip = kelpPartToClip();
  vec4 clip_at = to_clip * vec4(kelp_exit, 1.0);
  vec4 clip_slope = to_clip * vec4(ray, 0.0);
  vec2 range = vec2(-length(kelp_bounds_max - kelp_bounds_min), 0.0);
  range = kelpClip(range, clip_at.z + clip_at.w, clip_slope.z + clip_slope.w);
  range = kelpClip(range, clip_at.w - clip_at.z, clip_slope.w - clip_slope.z);
  if (!(range.x <= range.y)) discard;

  KelpHit hit = kelpTrace(kelp_exit, ray, range.x, range.y);
  if (!hit.found) discard;

  vec4 clip = clip_at + hit.s * clip_slope;
  gl_FragDepth = 0.5 * (gl_DepthRange.diff * (clip.z / clip.w) + gl_DepthRange.near + gl_DepthRange.far);
  kelp_color = kelp_depth_only ? vec4(0.0) : kelpShade(hit, kelp_exit + hit.s * ray, ray);
}
