// SPDX-License-Identifier: MIT
// Rays through a part by the paper's method: a pixel's ray, and what shaders/surface.glsl asks for, so that
// kelp's own look, with its shadow rays, is drawn by the paper's march. Comes after paper.glsl, before
// surface.glsl.

uniform mat4 paper_clip_to_part;
uniform mat4 paper_part_to_clip;
uniform mat4 paper_part_to_world;
uniform vec2 paper_viewport;   // pixels
uniform vec3 kelp_bounds_min;  // of the deformed part, part space
uniform vec3 kelp_bounds_max;

// The first solid voxel along o + s r, s in [s_min, s_max], r a unit vector. Segments in the order in which
// the ray meets them; the last one tried stays loaded.
PaperHit paperTrace(vec3 o, vec3 r, float s_min, float s_max) {
  PaperHit all = paperNoHit();
  for (int n = 0; n < paper_segment_count; ++n) {
    paperLoadSegment(r.y < 0.0 ? paper_segment_count - 1 - n : n);
#ifdef PAPER_DISTANCES
    PaperHit hit = paperDistanceField(o, r, s_min, s_max, true);
#else
    PaperHit hit = paperStandard(o, r, s_min, s_max);
#endif
    hit.steps += all.steps;
    hit.fetches += all.fetches;
    all = hit;
    if (hit.found) break;
  }
  return all;
}

// The part of a pixel's ray in the box around the deformed part: from `from`, along r, over `reach`.
struct PaperPixelRay {
  bool meets;  // the box
  vec3 from;
  vec3 r;  // unit
  float reach;
};

PaperPixelRay paperPixelRay(vec2 pixel) {
  vec2 at = 2.0 * pixel / paper_viewport - 1.0;
  vec4 near = paper_clip_to_part * vec4(at, -1.0, 1.0);
  vec4 far = paper_clip_to_part * vec4(at, 1.0, 1.0);
  vec3 origin = near.xyz / near.w;
  vec3 along = far.xyz / far.w - origin;
  float most = length(along);
  PaperPixelRay p;
  p.r = along / most;
  vec3 slope = mix(p.r, vec3(1e-12), lessThan(abs(p.r), vec3(1e-12)));
  vec3 low = (kelp_bounds_min - origin) / slope;
  vec3 high = (kelp_bounds_max - origin) / slope;
  vec3 enter = min(low, high);
  vec3 leave = max(low, high);
  float s = max(max(max(enter.x, enter.y), enter.z), 0.0);
  float end = min(min(min(leave.x, leave.y), leave.z), most);
  p.meets = s <= end;
  p.from = origin + s * p.r;  // so that numbers are small where the voxels are
  p.reach = end - s;
  return p;
}

// For surface.glsl.
struct KelpHit {
  bool found;
  float s;
};
KelpHit kelpTrace(vec3 o, vec3 r, float s_min, float s_max) {
  PaperHit hit = paperTrace(o, r, s_min, s_max);
  return KelpHit(hit.found, hit.s);
}
mat4 kelpPartToWorld() { return paper_part_to_world; }
