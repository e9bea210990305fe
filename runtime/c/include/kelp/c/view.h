// SPDX-License-Identifier: MIT
// Pictures that a host asks for, whatever draws them: kelp_renderer or, with a graphics API of the host's,
// kelp_planner. Any thread may call the functions here. Include kelp/kelp.h.
#ifndef KELP_C_VIEW_H
#define KELP_C_VIEW_H

#include "kelp/c/instance.h"

// Abilities beyond drawing; a set of bits. Each costs something even where no view uses it.
typedef uint32_t kelp_features;
enum {
  KELP_FEATURE_SECONDARY_RAYS = 1,  // rays from what is seen: kelp_view.self_shadow, .occlusion_rays
  KELP_FEATURE_DISTANCES = 2,       // distances on the GPU: kelp_view.soft_shadows, .occlusion
  KELP_FEATURE_GRADIENT_ONLY = 4    // no other shading: the program compiles sooner
};

typedef int32_t kelp_clip_range;  // of z / w
enum { KELP_CLIP_RANGE_MINUS_ONE_TO_ONE = 0, KELP_CLIP_RANGE_ZERO_TO_ONE = 1 };
typedef int32_t kelp_shading;
enum {
  KELP_SHADING_GRADIENT = 0,  // one normal for each voxel, of the surface that was baked
  KELP_SHADING_FACES = 1,     // crisp blocks
  KELP_SHADING_SMOOTH = 2     // blended from voxel to voxel; the slowest
};
typedef int32_t kelp_output;
enum {
  KELP_OUTPUT_LINEAR = 0,  // for a framebuffer that encodes, or is tone-mapped later
  KELP_OUTPUT_DISPLAY = 1  // tone-mapped and encoded as sRGB, for a window that encodes nothing
};
typedef int32_t kelp_debug_view;
enum {
  KELP_DEBUG_VIEW_NONE = 0,
  KELP_DEBUG_VIEW_PARTS = 1,    // a color for each part of each instance
  KELP_DEBUG_VIEW_STEPS = 2,    // of rays until they hit: blue 0, green 16, yellow 32, red 64 and more
  KELP_DEBUG_VIEW_LEVELS = 3,   // a color for each level, gray for 0; black stripes: a finer one is missing
  KELP_DEBUG_VIEW_BOUNDS = 4,   // the boxes that are rasterized, as lines; red: the eye is in or close to it
  KELP_DEBUG_VIEW_SPLINES = 5,  // splines and knots, as lines
  KELP_DEBUG_VIEW_CAGES = 6     // the edges of cages, as lines
};

// A picture. Start from kelp_view_defaults, then set the viewport and the two matrices.
typedef struct kelp_view {
  uint32_t struct_size;
  int32_t viewport[2];     // the current one's size in pixels; without pixels nothing is drawn
  float world_to_eye[16];  // eye space looks down -z
  float eye_to_clip[16];   // perspective or orthographic; the far plane may be at infinity
  kelp_clip_range clip_range;
  kelp_bool reversed_depth;             // the near plane is at the upper end of the range
  kelp_output output;                   // what the colors are
  const float* previous_world_to_clip;  // of the frame before, for motion vectors. Null: none
  // Light. Colors are linear.
  float sun_direction[3];  // towards the sun, world; any length above 0
  float sun_color[3];
  float sky_color[3];     // from above
  float ground_color[3];  // from below
  // Limits on the cost of the picture.
  kelp_shading shading;
  int32_t finest_level;    // no finer level is drawn
  float pixels_per_voxel;  // about how many a voxel covers; 0: always the finest level
  float smallest_pixels;   // parts that cover fewer are not drawn
  kelp_bool self_shadow;   // needs KELP_FEATURE_SECONDARY_RAYS, as do:
  int32_t occlusion_rays;  // 0 .. 16 for each pixel: how much of the sky it sees
  float occlusion_reach;   // in lengths of the part's longest side; above 0
  float soft_shadows;      // 0 .. 20 degrees across the sun; needs KELP_FEATURE_DISTANCES, as does:
  kelp_bool occlusion;     // how much of the sky a pixel sees, by distances
  int32_t depth_batches;   // 1 .. 16: draws from near to far, between which the depth is copied
  // The next three are for a kelp_renderer; a kelp_planner ignores them.
  uint32_t scene_depth;  // a GL_TEXTURE_2D with the depth so far, where rays end; 0: none
  // Called just before a draw with its program in use, to set what surface_glsl needs: uniforms, and textures
  // on units from KELP_FIRST_HOST_UNIT on. May be null.
  void (*bind)(void* user, uint32_t program);
  void* bind_user;
  kelp_debug_view debug;  // parts, steps and levels replace surface_glsl, and `bind` is not called
} kelp_view;
enum { KELP_FIRST_HOST_UNIT = 4 };
KELP_API kelp_result kelp_view_defaults(kelp_view* view);

typedef int32_t kelp_pass;
enum {
  KELP_PASS_COLOR = 0,  // color and depth of solid parts
  KELP_PASS_DEPTH = 1,  // depth only, for shadow maps and pre-passes
  KELP_PASS_FOG = 2     // fog parts, after everything opaque; blends into draw buffer 0
};

typedef struct kelp_stats {
  uint32_t struct_size;
  uint32_t instances;       // parts of instances that were drawn
  uint32_t culled;          // parts out of view, and those that are too small
  uint32_t left_out;        // instances that cannot be drawn: their pose or matrix is not sound
  uint32_t draws;           // draw calls
  uint32_t pending;         // grids and pages that are wanted and not yet on the GPU
  uint64_t bytes_uploaded;  // by this call
  uint64_t gpu_bytes;       // held now
  // Why the first instance was left out, and its index. Static storage.
  kelp_result first_left_out_result;
  uint32_t first_left_out;
  const char* first_left_out_text;
  uint32_t too_small;   // of the culled parts: they cover fewer pixels than kelp_view.smallest_pixels
  uint32_t waiting;     // parts in view of which nothing is on the GPU yet: pump and upload
  uint32_t other_kind;  // instances without a part that this pass draws
  uint32_t clamped;     // instances whose pose was clamped (kelp_instance.unsound)
} kelp_stats;

// Bytes of gpu_budget or pool_bytes that the asset takes, as far as its grids are loaded. features: those of
// the renderer or planner.
KELP_API kelp_result kelp_pool_bytes(kelp_asset asset, kelp_features features, uint64_t* bytes);
// The level of a part of an instance that a draw wants at a pixel, for a kelp_raycast that meets what is
// seen; KELP_NONE if it cannot be drawn.
KELP_API kelp_result kelp_level_at(const kelp_view* view, const kelp_instance* instance, int32_t part,
                                   int32_t x, int32_t y, int32_t* level);

#endif
