// SPDX-License-Identifier: MIT
// One posed part as the paper stores it, for shaders/reference/paper.glsl: level-0 voxels in dense 3D
// textures. Comes after spline.glsl and before paper.glsl, whose macros it defines.
//
// The paper has one spline segment. A part with several is drawn as a stack of the paper's volumes, one for
// each segment: each holds the slice of the voxels that the segment bends.

uniform highp sampler2D paper_segments;  // a row for each segment: p0 and foot | m0 and height | p1 | m1
uniform int paper_segment_count;
uniform ivec3 paper_size;  // voxels
uniform float paper_step;  // the constant step, voxels
#ifdef PAPER_DISTANCES
uniform highp sampler3D paper_voxels;  // distance to the nearest solid voxel's center; 0 in solid voxels
#define PAPER_FETCH(v) texelFetch(paper_voxels, v, 0).r
#else
uniform highp usampler3D paper_voxels;  // 1 empty, 0 solid
#define PAPER_FETCH(v) float(texelFetch(paper_voxels, v, 0).r)
#endif

// The segment that is marched, and its slice of the voxels.
KelpSegment paper_segment;
float paper_foot;    // where the slice begins, voxels
float paper_height;  // of the slice, voxels

void paperLoadSegment(int i) {
  vec4 start = texelFetch(paper_segments, ivec2(0, i), 0);
  vec4 start_slope = texelFetch(paper_segments, ivec2(1, i), 0);
  vec3 end = texelFetch(paper_segments, ivec2(2, i), 0).xyz;
  vec3 end_slope = texelFetch(paper_segments, ivec2(3, i), 0).xyz;
  paper_segment = KelpSegment(start.xyz, start_slope.xyz, end, end_slope);
  paper_foot = start.w;
  paper_height = start_slope.w;
}

#define KELP_CONTEXT_
#define KELP_CONTEXT
#define KELP_SEGMENT(i) paper_segment
#define KELP_SIZE vec3(float(paper_size.x), paper_height, float(paper_size.z))
#define KELP_LEVEL_SIZE paper_size
#define PAPER_FOOT paper_foot
#define PAPER_STEP paper_step
