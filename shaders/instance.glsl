// SPDX-License-Identifier: MIT
// Where the tracing core and the proxy find a posed part on the GPU: the frame's records and the pool of
// voxels.

// The pool: all voxels of all assets as 32-bit words; in a texture, 1024 to a row, 1024 rows to a layer.
// runtime/draw/src writes it:
//   of an asset  9 words for each palette entry: base color, emissive, metallic, roughness
//                then for each part 4 words for each of its levels, finest first: where its cells are, where
//                its page table is, its grid (bricks along x - 1 | along y - 1 << 10 | complete << 31), where
//                its cage is (kelp/formats/cage.h); 0: there is none;
//                the same for each level of distances, with the squared distance where its band ends << 20
//                and for fog the meaning of its samples: fog.glsl, kelpLoadFog
//   of a level   cells and pages as in kelp/formats/page.h
//                the page table has a word for each page: where the page is, 0 if it is not resident
//
// The frame's records, texels of four words; in a texture, 1024 to a row. First a number for each part that
// is drawn, four to a texel: the texel of its record. A record:
//   0..3   rows: part space -> clip space; for a host's own shader (scene.glsl) 0..2: world -> part space
//   4..6   rows: part space -> world
//   7      the eye in part space (w = 1), or the direction of view (w = 0, orthographic)
//   8      tint
//   9      lowest corner of the deformed bounds | number of spline segments; of a swept part, of arcs, and
//          bit 31 is set; of a part with a cage, of its nodes, and bit 30 is set
//   10     highest corner of the deformed bounds | where the part's levels are in the pool
//   11     size of the undeformed volume, level-0 voxels | level (bits 0..7), 64ths of the pixels that draw
//          the next coarser level (8..14), 1 where a finer level is wanted (15), number of the part's levels
//          (16..23), of distances (24..31)
//   12     where the palette is: in the pool, or, if bit 31 is set, a word of these records
//          | index of the instance | part | outline of the bounds
//          (draw.vert): six corners of three bits, x y z, set for the high side; 0: the eye is in or close to
//          the bounds
//   13..   3 texels for each segment: p0, m0, p1, m1 in a row (spline.glsl, KelpSegment); of a swept part, 4
//          for each arc and 2 for each joint, one joint more than arcs, as in kelp/formats/sweep.h; of a part
//          with a cage: lowest corner of the box around inverted tetrahedra | leaves of the tree as a binary
//          logarithm plus 1, 0: no tree (bits 0..7), the cage's level (8..15), the coarsest that is seen
//          through it (16..23); highest corner | number of the cage's boundary faces; a texel for each node;
//          2 texels for each box of the tree, lowest and highest corner, twice as many boxes as leaves;
//          of a leaf, each with the number of a cell in w, 0xffffffff: none
//   then, with kelp_motion: 4 texels as 0..3 and the segments, of the frame before; of a swept part, a texel
//          with the number of arcs, the arcs and the joints; of a part with a cage, the nodes
//   then, where distances shade: the record of the instance's next part; all parts of an instance are a ring
//
// Either may hold anything: an upload may be late, or never come. So what bounds a loop is bounded itself, by
// what kelp/formats allows.
#define KELP_RECORD 13
#define KELP_MAX_SEGMENTS 63
#define KELP_MAX_ARCS 256
#define KELP_MAX_LEVELS 16
#define KELP_MAX_NODES 0x0fffffff
#ifdef KELP_VULKAN
layout(std430, set = KELP_SET, binding = KELP_BINDING_POOL) readonly buffer KelpPool { uint kelp_pool[]; };
layout(std430, set = KELP_SET, binding = KELP_BINDING_RECORDS) readonly buffer KelpRecords {
  uvec4 kelp_records[];
};
uint kelpWord(uint at) { return kelp_pool[at]; }
uvec4 kelpRecordBits(int texel) { return kelp_records[texel]; }
#else
uniform usampler2DArray kelp_pool;
uniform usampler2D kelp_records;
uint kelpWord(uint at) {
  return texelFetch(kelp_pool, ivec3(int(at & 1023u), int((at >> 10u) & 1023u), int(at >> 20u)), 0).r;
}
uvec4 kelpRecordBits(int texel) { return texelFetch(kelp_records, ivec2(texel & 1023, texel >> 10), 0); }
#endif
vec4 kelpRecord(int texel) { return uintBitsToFloat(kelpRecordBits(texel)); }

// The record that this invocation works on. kelpLoadRecord sets these.
int kelp_record;
int kelp_segment_count;
int kelp_arc_count;   // of a swept part, which has no segments
int kelp_node_count;  // of a part with a cage, which has neither
int kelp_cage_shape;  // as in the record
uint kelp_cage_at;    // where the cage is in the pool; 0: it is not there
vec3 kelp_bounds_min;
vec3 kelp_bounds_max;

#if defined(KELP_CAGED_ONLY)
#define KELP_CAGED true
#elif defined(KELP_SWEPT_ONLY) || defined(KELP_SHEARED_ONLY)
#define KELP_CAGED false
#else
#define KELP_CAGED (kelp_node_count > 0)
#endif
#if defined(KELP_SWEPT_ONLY)
#define KELP_SWEPT true
#elif defined(KELP_SHEARED_ONLY) || defined(KELP_CAGED_ONLY)
#define KELP_SWEPT false
#else
#define KELP_SWEPT (kelp_arc_count > 0)
#endif
// The coarsest level that is seen through the record's cage.
int kelpCageLast() { return min((kelp_cage_shape >> 16) & 255, KELP_MAX_LEVELS - 1); }

// The texel of the record of the i-th part of this draw.
int kelpRecordOf(int i) {
  int n = kelp_first_instance + i;
  return int(kelpRecordBits(n >> 2)[n & 3]);
}

void kelpLoadRecord(int texel) {
  kelp_record = texel;
  uvec4 low = kelpRecordBits(texel + 9);
  kelp_bounds_min = uintBitsToFloat(low.xyz);
  uvec4 high = kelpRecordBits(texel + 10);
  kelp_bounds_max = uintBitsToFloat(high.xyz);
  uint kind = low.w >> 30u;
  int count = int(low.w & 0x3fffffffu);
  kelp_segment_count = kind == 0u ? min(count, KELP_MAX_SEGMENTS) : 0;
  kelp_arc_count = kind > 1u ? min(count, KELP_MAX_ARCS) : 0;
  kelp_node_count = kind == 1u ? min(count, KELP_MAX_NODES) : 0;
  kelp_cage_shape = 0;
  kelp_cage_at = 0u;
  if (KELP_CAGED) {
    kelp_cage_shape = int(kelpRecordBits(texel + KELP_RECORD).w);
    kelp_cage_at = kelpWord(high.w + 4u * uint((kelp_cage_shape >> 8) & 15) + 3u);
  }
}

// The nodes of the record's cage, and its tree.
int kelpNodesAt() { return kelp_record + KELP_RECORD + 2; }
int kelpTreeAt() { return kelpNodesAt() + kelp_node_count; }
int kelpCageLeaves() { return (1 << min(kelp_cage_shape & 255, 28)) >> 1; }

mat4 kelpRows(int texel, vec4 last) {
  return transpose(mat4(kelpRecord(texel), kelpRecord(texel + 1), kelpRecord(texel + 2), last));
}

mat4 kelpPartToClip() { return kelpRows(kelp_record, kelpRecord(kelp_record + 3)); }
mat4 kelpPartToWorld() { return kelpRows(kelp_record + 4, vec4(0.0, 0.0, 0.0, 1.0)); }
// Up to length. The cofactors are the inverse transpose times the determinant, which is negative for mirrored
// parts.
vec3 kelpNormalToWorld(vec3 n) {
  mat3 m = mat3(kelpPartToWorld());
  vec3 a = cross(m[1], m[2]);
  vec3 turned = a * n.x + cross(m[2], m[0]) * n.y + cross(m[0], m[1]) * n.z;
  return dot(m[0], a) < 0.0 ? -turned : turned;
}

// The ray through a point of part space, away from the eye. Not normalized; zero at the eye itself.
vec3 kelpViewRay(vec3 p) {
  vec4 eye = kelpRecord(kelp_record + 7);
  return eye.w > 0.0 ? p - eye.xyz : eye.xyz;
}

// The level that is traced. kelpLoadLevel sets these.
int kelp_level;
int kelp_coarser;  // number of coarser levels
bool kelp_complete;
vec3 kelp_size;  // of the part, level-0 voxels
ivec3 kelp_level_size;
float kelp_level_scale;
uint kelp_levels_at;
uint kelp_cells_at;
uint kelp_pages_at;
ivec2 kelp_grid;  // bricks along x and y

// Loads the level, or the next coarser one whose table is in the pool and that is seen through the cage.
// False: there is none.
bool kelpLoadLevel(int level) {
  uvec4 volume = kelpRecordBits(kelp_record + 11);
  int levels = min(int((volume.w >> 16u) & 255u), KELP_MAX_LEVELS);
  if (KELP_CAGED) levels = min(levels, kelpCageLast() + 1);
  kelp_levels_at = kelpRecordBits(kelp_record + 10).w;
  kelp_level = min(level, KELP_MAX_LEVELS - 1);
  uint at = kelp_levels_at + 4u * uint(kelp_level);
  kelp_cells_at = kelpWord(at);
  while (kelp_cells_at == 0u && kelp_level + 1 < levels) {
    ++kelp_level;
    at += 4u;
    kelp_cells_at = kelpWord(at);
  }
  kelp_coarser = levels - 1 - kelp_level;
  kelp_size = uintBitsToFloat(volume.xyz);
  kelp_level_size = (ivec3(kelp_size) + ((1 << kelp_level) - 1)) >> kelp_level;
  kelp_level_scale = 1.0 / float(1 << kelp_level);
  uint grid = kelpWord(at + 2u);
  kelp_pages_at = kelpWord(at + 1u);
  kelp_grid = ivec2(int(grid & 1023u), int((grid >> 10u) & 1023u)) + 1;
  kelp_complete = grid >= 0x80000000u;
  return kelp_cells_at != 0u && (!KELP_CAGED || kelp_cage_at != 0u);
}

// The level that a pixel draws. An ordered 8 x 8 pattern of pixels mixes two levels, so that a part that
// comes nearer changes gradually from one to the other. runtime/draw/src/detail.cpp has the same pattern.
int kelpPixelLevel(ivec2 pixel) {
  uint bits = kelpRecordBits(kelp_record + 11).w;
  int x = pixel.x ^ pixel.y;
  int order = ((x & 1) << 5) | ((pixel.y & 1) << 4) | ((x & 2) << 2) | ((pixel.y & 2) << 1) | ((x & 4) >> 1) |
              ((pixel.y & 4) >> 2);
  return int(bits & 255u) + (order < int((bits >> 8u) & 127u) ? 1 : 0);
}

uint kelpCell(ivec3 brick) {
  return kelpWord(kelp_cells_at + uint(brick.x + kelp_grid.x * (brick.y + kelp_grid.y * brick.z)));
}
// A brick is named by the place of its first word; `words`: how many a brick has.
uint kelpBrickOf(uint pages_at, uint cell, uint words) {
  uint page = kelpWord(pages_at + ((cell >> 7u) & 0x1ffffu));
  return page == 0u ? 0u : page + words * (cell & 127u);
}
uint kelpBrickIn(uint pages_at, uint cell) { return kelpBrickOf(pages_at, cell, 132u); }
uint kelpBrickAbove(int above, ivec3 brick) {
  uint at = kelp_levels_at + 4u * uint(kelp_level + above);
  uint grid = kelpWord(at + 2u);
  ivec2 bricks = ivec2(int(grid & 1023u), int((grid >> 10u) & 1023u)) + 1;
  uint cells = kelpWord(at);
  if (cells == 0u) return 0u;
  uint cell = kelpWord(cells + uint(brick.x + bricks.x * (brick.y + bricks.y * brick.z)));
  return cell < 0x80000000u ? 0u : kelpBrickIn(kelpWord(at + 1u), cell);
}
uint kelpCode(uint brick, ivec3 voxel) {
  int i = (voxel.x & 7) | ((voxel.y & 7) << 3) | ((voxel.z & 7) << 6);
  return (kelpWord(brick + 4u + uint(i >> 2)) >> uint(8 * (i & 3))) & 255u;
}

// Segment i of the spline whose first texel is `at`, as in KelpSegment.
vec3 kelpP0(int at, int i) { return kelpRecord(at + 3 * i).xyz; }
vec3 kelpM0(int at, int i) { return vec3(kelpRecord(at + 3 * i).w, kelpRecord(at + 3 * i + 1).xy); }
vec3 kelpP1(int at, int i) { return vec3(kelpRecord(at + 3 * i + 1).zw, kelpRecord(at + 3 * i + 2).x); }
vec3 kelpM1(int at, int i) { return kelpRecord(at + 3 * i + 2).yzw; }
#define KELP_SEGMENT_AT(at, i) KelpSegment(kelpP0(at, i), kelpM0(at, i), kelpP1(at, i), kelpM1(at, i))

// Where the record's arcs and its joints are.
int kelpArcsAt() { return kelp_record + KELP_RECORD; }
int kelpJointsAt() { return kelp_record + KELP_RECORD + 4 * kelp_arc_count; }
// Texels of so many arcs and their joints.
int kelpArcTexels(int arcs) { return 6 * arcs + 2; }
// The first texel behind the spline, and with kelp_motion behind that of the frame before.
int kelpRecordEnd() {
  int texels = kelp_arc_count > 0 ? kelpArcTexels(kelp_arc_count) : 3 * kelp_segment_count;
  int end = kelp_record + KELP_RECORD + texels;
  if (KELP_CAGED) {
    texels = kelp_node_count;
    end = kelpTreeAt() + 4 * kelpCageLeaves();
  }
  if (!kelp_motion) return end;
  if (kelp_arc_count == 0) return end + 4 + texels;
  return end + 5 + kelpArcTexels(int(kelpRecordBits(end + 4).x));
}

#define KELP_FN
#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENTS kelp_segment_count
#define KELP_SEGMENT(i) KELP_SEGMENT_AT(kelp_record + KELP_RECORD, i)
#define KELP_ARCS kelp_arc_count
#define KELP_ARC_BALL(i) kelpRecord(kelpArcsAt() + 4 * (i))
#define KELP_ARC(i) kelpArcOf(kelpArcsAt(), i)
#define KELP_JOINT_PLANE(i) kelpRecord(kelpJointsAt() + 2 * (i))
#define KELP_JOINT(i) kelpJointOf(kelpJointsAt(), i)
#define KELP_CAGE_WORD(i) kelpWord(kelp_cage_at + (i))
#define KELP_NODE(i) kelpRecord(kelpNodesAt() + int(i)).xyz
#define KELP_CAGE_LOW(i) kelpRecord(kelpTreeAt() + 2 * (i)).xyz
#define KELP_CAGE_HIGH(i) kelpRecord(kelpTreeAt() + 2 * (i) + 1).xyz
#define KELP_CAGE_LEAVES kelpCageLeaves()
#define KELP_LEAF_CELL(i) kelpRecordBits(kelpTreeAt() + 2 * kelpCageLeaves() + (i)).w
#define KELP_CAGE_FOLD_LOW kelpRecord(kelp_record + KELP_RECORD).xyz
#define KELP_CAGE_FOLD_HIGH kelpRecord(kelp_record + KELP_RECORD + 1).xyz
#define KELP_LEAF_CELLS 2
#define KELP_BOUNDS_MIN kelp_bounds_min
#define KELP_BOUNDS_MAX kelp_bounds_max
#define KELP_SIZE kelp_size
#define KELP_LEVEL_SIZE kelp_level_size
#define KELP_LEVEL_SCALE kelp_level_scale
#define KELP_COMPLETE kelp_complete
#define KELP_COARSER kelp_coarser
#define KELP_CELL(v) kelpCell(v)
#define KELP_BRICK(k, cell) kelpBrickIn(kelp_pages_at, cell)
#define KELP_BRICK_ABOVE(k, v) kelpBrickAbove(k, v)
#define KELP_CODE(k, brick, v) kelpCode(brick, v)
