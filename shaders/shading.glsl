// SPDX-License-Identifier: MIT
// The material and the normal of a hit, in one of the three ways of kelp::gl::Shading. Runs only for rays
// that hit; only kSmooth reads more than a few texels.

// Palette entries as numbers, so that they can be averaged.
struct KelpMaterial {
  vec4 color;
  vec4 glow;  // emissive, metallic
  float roughness;
};

// Codes of voxels (formats/SPEC.md): solid with an attribute, and solid.
bool kelpIsSurface(uint code) { return code >= 64u && code <= 127u; }
bool kelpIsSolid(uint code) { return code >= 64u && code <= 128u; }

// The code of any voxel of the level, and its brick. 0, as of an empty voxel: outside the level, in an empty
// brick, and in a brick that is not resident.
uint kelpCodeAt(ivec3 voxel, out uint brick) {
  brick = 0u;
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, kelp_level_size))) return 0u;
  uint cell = kelpCell(voxel >> 3);
  if (cell < 0x80000000u) return 0u;
  brick = kelpBrickIn(kelp_pages_at, cell);
  return brick == 0u ? 0u : kelpCode(brick, voxel);
}

// The attribute of a surface voxel: palette entry and normal.
uint kelpAttribute(uint brick, int slice, uint code) {
  uint first = (kelpWord(brick + uint(slice >> 1)) >> uint(16 * (slice & 1))) & 0xffffu;
  return kelpWord(brick + first + (code - 64u));
}

// The palette of the pack lies in the pool, that of an instance behind the frame's records.
float kelpPaletteFloat(uint at) {
  uint own = at & 0x7fffffffu;
  return uintBitsToFloat(at < 0x80000000u ? kelpWord(at) : kelpRecordBits(int(own >> 2u))[int(own & 3u)]);
}
KelpMaterial kelpMaterial(int entry) {
  uint at = kelpRecordBits(kelp_record + 12).x + 9u * uint(entry);
  KelpMaterial m;
  m.color = vec4(kelpPaletteFloat(at), kelpPaletteFloat(at + 1u), kelpPaletteFloat(at + 2u),
                 kelpPaletteFloat(at + 3u));
  m.glow = vec4(kelpPaletteFloat(at + 4u), kelpPaletteFloat(at + 5u), kelpPaletteFloat(at + 6u),
                kelpPaletteFloat(at + 7u));
  m.roughness = kelpPaletteFloat(at + 8u);
  return m;
}

// The material of an inner voxel, which has no attribute and is seen where the near plane or the eye cuts
// into a solid, or where pieces of a cage part: that of the first surface voxel in the directions of its 26
// neighbors, up to 8 steps away, or the palette's first.
uint kelpInnerMaterial(ivec3 voxel) {
  uint material = 0u;
  int nearest = 4;
  for (int away = 1; away <= 8 && nearest == 4; ++away) {
    for (int i = 0; i < 27; ++i) {
      ivec3 towards = ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
      int distance = towards.x * towards.x + towards.y * towards.y + towards.z * towards.z;
      if (distance >= nearest) continue;
      ivec3 beside = voxel + away * towards;
      uint brick;
      uint code = kelpCodeAt(beside, brick);
      if (kelpIsSurface(code)) {
        nearest = distance;
        material = kelpAttribute(brick, beside.z & 7, code) & 255u;
      }
    }
  }
  return material;
}

// Height of the sheared part over that of its spline.
float kelpStretch() { return kelp_size.y / (KELP_SEGMENT(KELP_SEGMENTS - 1).p1.y - KELP_SEGMENT(0).p0.y); }

// The direction of the ray's image in the undeformed volume at the hit, up to length: the inverse of the
// map's derivative; of a shear times S.y' >= 0.
vec3 kelpRestDirection(KelpHit hit, vec3 ray) {
  if (KELP_CAGED) return normalize(kelpCageRestDirection(hit, ray));
  vec3 middle = 0.5 * kelp_size;
  if (KELP_SWEPT)
    return normalize(kelpSweepRestDirection(KELP_ARC(hit.segment), hit.rest.x - middle.x, hit.rest.y,
                                            hit.rest.z - middle.z, ray));
  vec3 slope = kelpSplineSlope(KELP_SEGMENT(hit.segment), clamp(hit.t, 1e-4, 1.0 - 1e-4));
  return normalize(vec3(ray.x * slope.y - ray.y * slope.x, kelpStretch() * ray.y * slope.y,
                        ray.z * slope.y - ray.y * slope.z));
}
// The normal in part space, up to length, of a surface at the hit whose normal is n at rest.
vec3 kelpBentNormal(KelpHit hit, vec3 n) {
  if (KELP_CAGED) return kelpCageNormal(hit, n);
  vec3 middle = 0.5 * kelp_size;
  if (KELP_SWEPT)
    return kelpSweepNormal(KELP_ARC(hit.segment), KELP_JOINT(hit.segment), KELP_JOINT(hit.segment + 1),
                           hit.rest.x - middle.x, hit.rest.y, hit.rest.z - middle.z, n);
  return kelpDeformNormal(KELP_SEGMENT(hit.segment), hit.t, kelpStretch(), n);
}

// The outward normal, undeformed, of the face through which the ray entered the voxel's cube: back along
// `ahead` to the nearest of the three faces that look against it and that no solid voxel covers. Zero where
// the near plane or the eye cuts into the voxel.
vec3 kelpEntryFace(KelpHit hit, vec3 ahead) {
  const float kDeep = 4.0 * KELP_ERODE;  // a trace ends less far below the surface
  // Of q. Decides at the spline's steep ends, where `ahead` may lie in the face that is met.
  const float kRounding = 0.25 * KELP_ERODE;
  vec3 q = kelp_level_scale * hit.rest;
  vec3 low = vec3(hit.voxel);
  vec3 high = min(low + 1.0, kelp_level_scale * kelp_size);  // a coarse voxel may reach beyond the volume
  vec3 face = vec3(0.0);
  // Solid voxels are eroded, so a ray may pass between two that share an edge only, and meet a covered face.
  vec3 seam = vec3(0.0);
  float face_back = KELP_NEVER;
  float face_depth = KELP_NEVER;
  float seam_back = KELP_NEVER;
  for (int axis = 0; axis < 3; ++axis) {
    bool rising = ahead[axis] > 0.0;
    float depth = max((rising ? q[axis] - low[axis] : high[axis] - q[axis]) - kRounding, 0.0);
    float back = depth / max(abs(ahead[axis]), 1e-20);
    vec3 outward = vec3(0.0);
    outward[axis] = rising ? -1.0 : 1.0;
    uint brick;
    bool covered = kelpIsSolid(kelpCodeAt(hit.voxel + ivec3(outward), brick));
    if (!covered && back < face_back) {
      face = outward;
      face_back = back;
      face_depth = depth;
    } else if (covered && depth < kDeep && back < seam_back) {
      seam = outward;
      seam_back = back;
    }
  }
  return face_depth < kDeep || seam_back == KELP_NEVER ? face : seam;
}

// Normal and material averaged over the surface voxels within 1.5 voxels, weighted by a quadratic B-spline
// around the hit: the weights of the 27 voxels and their slopes change without a jump from one voxel to the
// next. (A trilinear filter reads 8, but its slopes jump visibly.) Voxels that face away from the ray hardly
// count; else the far side of a leaf would turn the near side's normals around.
vec3 kelpSmoothNormal(KelpHit hit, vec3 ahead, out KelpMaterial mean) {
  vec3 f = clamp(kelp_level_scale * hit.rest - vec3(hit.voxel) - 0.5, -0.5, 0.5);
  vec3 normal = vec3(0.0);
  float total = 0.0;
  mean = KelpMaterial(vec4(0.0), vec4(0.0), 0.0);
  for (int i = 0; i < 27; ++i) {
    ivec3 offset = ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
    uint brick;
    uint code = kelpCodeAt(hit.voxel + offset, brick);
    if (!kelpIsSurface(code)) continue;
    uint bits = kelpAttribute(brick, (hit.voxel.z + offset.z) & 7, code);
    vec3 n = kelpDecodeNormal(bits >> 8u);
    vec3 side = 0.5 + vec3(offset) * f;
    vec3 w = mix(0.5 * side * side, 0.75 - f * f, equal(offset, ivec3(0)));
    float weight = w.x * w.y * w.z * mix(0.015625, 1.0, smoothstep(-0.6, -0.1, -dot(n, ahead)));
    KelpMaterial m = kelpMaterial(int(bits & 255u));
    normal += weight * n;
    mean.color += weight * m.color;
    mean.glow += weight * m.glow;
    mean.roughness += weight * m.roughness;
    total += weight;
  }
  // The voxel that was hit weighs at least 1/8 of 1/64.
  mean.color /= total;
  mean.glow /= total;
  mean.roughness /= total;
  return normal;
}

// The surface at a hit. The part and the voxel's level must be loaded. Position and ray (unit, into the
// surface) are in part space. clip and previous_clip are 0: draw.frag sets them.
KelpSurface kelpSurfaceAt(KelpHit hit, vec3 position, vec3 ray) {
  uint entry;
  KelpMaterial material;
  vec3 normal = -ray;
  if (kelpIsSurface(hit.code)) {
    uint bits = kelpAttribute(hit.brick, hit.voxel.z & 7, hit.code);
    entry = bits & 255u;
    vec3 rest_normal;
    vec3 ahead = ray;
    if (KELP_SHADING != 0) ahead = kelpRestDirection(hit, ray);
    if (KELP_SHADING == KELP_SHADING_SMOOTH) {
      rest_normal = kelpSmoothNormal(hit, ahead, material);
    } else {
      rest_normal =
          KELP_SHADING == KELP_SHADING_FACES ? kelpEntryFace(hit, ahead) : kelpDecodeNormal(bits >> 8u);
      material = kelpMaterial(int(entry));
    }
    vec3 bent = kelpBentNormal(hit, rest_normal);
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
  s.color = material.color * kelpRecord(kelp_record + 8);
  s.emissive = material.glow.rgb;
  s.metallic = material.glow.a;
  s.roughness = material.roughness;
  s.material = int(entry);
  s.level = kelp_level;
  s.steps = hit.steps;
  s.voxel = hit.voxel;
  s.rest = hit.rest;
  s.size = kelp_size;
  uvec4 tags = kelpRecordBits(kelp_record + 12);
  s.instance = int(tags.y);
  s.part = int(tags.z);
  s.clip = vec4(0.0);
  s.previous_clip = vec4(0.0);
  return s;
}
