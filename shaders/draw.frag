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

uint kelpAttribute(uint slot, int slice, uint code) {
  ivec3 brick = kelpBrick(slot);
  uint first = texelFetch(kelp_slice_base, ivec3(brick.x, brick.y, 8 * brick.z + slice), 0).r;
  int index = int(first + (code - 64u));
  return texelFetch(kelp_attributes, ivec2(index & ((1 << KELP_ATTRIBUTE_BITS) - 1), index >> KELP_ATTRIBUTE_BITS), 0).r;
}

// An inner voxel, seen where the near plane or the eye cuts into a solid, has no attribute: the material of the nearest surface voxel among
// its 26 neighbours, or the palette's first.
uint kelpInnerMaterial(ivec3 voxel) {
  uint material = 0u;
  int nearest = 4;
  for (int i = 0; i < 27; ++i) {
    ivec3 offset = ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
    ivec3 v = voxel + offset;
    int distance = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
    if (distance >= nearest || any(lessThan(v, ivec3(0))) || any(greaterThanEqual(v, kelp_level_size))) continue;
    uint cell = KELP_FETCH_CELL(v >> 3);
    if (cell < 0x80000000u) continue;
    uint slot = cell & 0x00ffffffu;
    uint code = KELP_FETCH_CODE(slot, v);
    if (code >= 64u && code < 128u) {
      nearest = distance;
      material = kelpAttribute(slot, v.z & 7, code) & 255u;
    }
  }
  return material;
}

vec4 kelpShade(KelpHit hit, vec3 position, vec3 ray) {
  uint material;
  vec3 normal = -ray;
  if (hit.code < 128u) {
    uint bits = kelpAttribute(hit.slot, hit.voxel.z & 7, hit.code);
    material = bits & 255u;
    KelpSegment top = KELP_SEGMENT(KELP_SEGMENTS - 1);
    KelpSegment bottom = KELP_SEGMENT(0);
    float stretch = kelp_size.y / (kelpSplineAt(top, 1.0).y - bottom.d.y);
    vec3 bent = kelpDeformNormal(KELP_SEGMENT(hit.segment), hit.t, stretch, kelpDecodeNormal(bits >> 8u));
    normal = dot(bent, bent) > 0.0 ? bent : normal;
  } else {
    material = kelpInnerMaterial(hit.voxel);
  }

  KelpSurface s;
  mat4 to_world = kelpPartToWorld();
  int entry = int(material);
  vec4 glow = texelFetch(kelp_palette, ivec2(entry, 1), 0);
  s.position = (to_world * vec4(position, 1.0)).xyz;
  s.normal = normalize(kelpNormalToWorld(normal));
  s.view = normalize(mat3(to_world) * -ray);
  s.color = texelFetch(kelp_palette, ivec2(entry, 0), 0) * kelpRecord(kelp_record + 11);
  s.emissive = glow.rgb;
  s.metallic = glow.a;
  s.roughness = texelFetch(kelp_palette, ivec2(entry, 2), 0).r;
  s.material = entry;
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
