// SPDX-License-Identifier: MIT
// Where the tracing core and the proxy find a posed part on the GPU: the frame's data texture and the textures of one level.
// The renderer puts the version, the precisions and KELP_ATTRIBUTE_BITS (log2 of the width of the attributes' texture) before this text.

// One record per drawn part, KELP_RECORD texels and 4 more per spline segment, written by runtime/gl/src/draw_list.cpp:
//   0..3   rows: part space -> clip space
//   4..6   rows: part space -> world
//   7..9   rows: normal in part space -> normal in the world, up to length (3 x 3; w = 0)
//   10     the eye in part space (w = 1), or the direction of view (w = 0, orthographic)
//   11     tint
//   12     lowest corner of the deformed bounds, w = number of segments
//   13     highest corner of the deformed bounds
//   14     size of the undeformed volume, level-0 voxels
//   15..   per segment p0, m0, p1, m1 (trace.glsl, KelpSegment)
#define KELP_RECORD 15
uniform sampler2D kelp_records;
uniform int kelp_first_texel;   // of this draw's first record
uniform int kelp_record_texels;  // from record to record

uniform usampler3D kelp_cells;       // one texel a brick: formats/SPEC.md's cells, slots replaced by the brick's place in kelp_codes (8 bits an axis)
uniform usampler3D kelp_codes;       // bricks of 8 x 8 x 8 codes
uniform usampler3D kelp_slice_base;  // a brick at (x, y, z) has its eight at (x, y, 8 z + slice)
uniform usampler2D kelp_attributes;
uniform sampler2D kelp_palette;      // per entry: base colour | emissive, metallic | roughness
uniform int kelp_level;
uniform ivec3 kelp_level_size;

vec4 kelpRecord(int texel) { return texelFetch(kelp_records, ivec2(texel & 1023, texel >> 10), 0); }

// The record this invocation works on; kelpLoadRecord fills these.
int kelp_record;
int kelp_segment_count;
vec3 kelp_bounds_min;
vec3 kelp_bounds_max;
vec3 kelp_size;
float kelp_level_scale;

void kelpLoadRecord(int texel) {
  kelp_record = texel;
  vec4 low = kelpRecord(texel + 12);
  kelp_bounds_min = low.xyz;
  kelp_segment_count = int(low.w + 0.5);
  kelp_bounds_max = kelpRecord(texel + 13).xyz;
  kelp_size = kelpRecord(texel + 14).xyz;
  kelp_level_scale = 1.0 / float(1 << kelp_level);
}

mat4 kelpRows(int texel, vec4 last) {
  return transpose(mat4(kelpRecord(texel), kelpRecord(texel + 1), kelpRecord(texel + 2), last));
}

mat4 kelpPartToClip() { return kelpRows(kelp_record, kelpRecord(kelp_record + 3)); }
mat4 kelpPartToWorld() { return kelpRows(kelp_record + 4, vec4(0.0, 0.0, 0.0, 1.0)); }
vec3 kelpNormalToWorld(vec3 n) { return (kelpRows(kelp_record + 7, vec4(0.0)) * vec4(n, 0.0)).xyz; }

// The ray through a point of part space, away from the eye. Not normalised; zero at the eye itself.
vec3 kelpViewRay(vec3 p) {
  vec4 eye = kelpRecord(kelp_record + 10);
  return eye.w > 0.0 ? p - eye.xyz : eye.xyz;
}

// The place of a voxel of brick `slot` in kelp_codes.
ivec3 kelpBrick(uint slot) { return ivec3(int(slot & 255u), int((slot >> 8u) & 255u), int((slot >> 16u) & 255u)); }

// Term k of segment i: p0, m0, p1, m1.
vec3 kelpSegmentTerm(int i, int k) { return kelpRecord(kelp_record + KELP_RECORD + 4 * i + k).xyz; }

#define KELP_FN
#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENTS kelp_segment_count
#define KELP_SEGMENT(i) KelpSegment(kelpSegmentTerm(i, 0), kelpSegmentTerm(i, 1), kelpSegmentTerm(i, 2), kelpSegmentTerm(i, 3))
#define KELP_BOUNDS_MIN kelp_bounds_min
#define KELP_BOUNDS_MAX kelp_bounds_max
#define KELP_SIZE kelp_size
#define KELP_LEVEL_SIZE kelp_level_size
#define KELP_LEVEL_SCALE kelp_level_scale
#define KELP_FETCH_CELL(v) texelFetch(kelp_cells, v, 0).r
#define KELP_FETCH_CODE(slot, v) texelFetch(kelp_codes, 8 * kelpBrick(slot) + ((v) & 7), 0).r
