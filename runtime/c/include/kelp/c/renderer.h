// SPDX-License-Identifier: MIT
// Draws instances with OpenGL 3.3 core or OpenGL ES 3.0, into the framebuffer that the host has bound. Call
// these functions on the thread that made the renderer, with its context current. On another thread they are
// KELP_ERROR_WRONG_THREAD, with another context or none KELP_ERROR_MISUSE, and do nothing. (abandon, remove
// and get_trace_glsl need no context.)
// runtime/HOST_GUIDE.md says what state changes. Include kelp/kelp.h.
#ifndef KELP_C_RENDERER_H
#define KELP_C_RENDERER_H

#include "kelp/c/instance.h"

typedef struct kelp_renderer {
  uint64_t id;
} kelp_renderer;

typedef int32_t kelp_state;
enum {
  KELP_STATE_RESTORE = 0,  // every call leaves the state of OpenGL as it found it
  KELP_STATE_LEAVE = 1
};

// Abilities of a renderer beyond drawing; a set of bits. Each costs something even where no view uses it.
typedef uint32_t kelp_features;
enum {
  KELP_FEATURE_SECONDARY_RAYS = 1,  // rays from what is seen: kelp_view.self_shadow, .occlusion_rays
  KELP_FEATURE_DISTANCES = 2,       // distances on the GPU: kelp_view.soft_shadows, .occlusion
  KELP_FEATURE_GRADIENT_ONLY = 4    // no other shading: the program compiles sooner
};

typedef struct kelp_renderer_options {
  uint32_t struct_size;
  kelp_state state;
  // Returns the address of a GL function, as SDL_GL_GetProcAddress does. Called in kelp_renderer_create only.
  void* (*get_proc_address)(void* user, const char* name);
  // Gets the messages of the GLSL compiler when it refuses a program, and once for each asset why an instance
  // was left out, or that kelp_asset_pump or kelp_renderer_upload was never called. Called in functions of
  // the renderer. May be null.
  void (*log)(void* user, const char* text);
  void* user;  // of both
  // Bytes of GPU memory for voxels, at least 256 KiB, allocated at once.
  uint64_t gpu_budget;
  // GLSL that defines `vec4 kelpSurface(KelpSurface s)` (shaders/surface.glsl). Null: sun and sky.
  const char* surface_glsl;
  const kelp_allocator* allocator;  // copied. Null: malloc and free
  kelp_features features;
} kelp_renderer_options;
KELP_API kelp_result kelp_renderer_options_defaults(kelp_renderer_options* options);

// KELP_ERROR_GRAPHICS: no context is current, its version is too low, a function is missing, or a shader does
// not compile.
KELP_API kelp_result kelp_renderer_create(const kelp_renderer_options* options, kelp_renderer* renderer);
// KELP_ERROR_MISUSE, and nothing is destroyed: another context is current, or none. Make the renderer's own
// current, or call kelp_renderer_abandon() before.
KELP_API kelp_result kelp_renderer_destroy(kelp_renderer renderer);
// Makes the calling thread the one that the renderer belongs to. Call it when you have made its context
// current on that thread. The one function of a renderer that any thread may call.
KELP_API kelp_result kelp_renderer_use_here(kelp_renderer renderer);
// Forgets all GL objects without touching them: call it after the context was lost. From then on only
// kelp_renderer_destroy succeeds.
KELP_API kelp_result kelp_renderer_abandon(kelp_renderer renderer);

// Registers an asset; remove it before you destroy it. KELP_ERROR_MISUSE: it was added before.
// KELP_ERROR_LIMIT: no room in gpu_budget.
KELP_API kelp_result kelp_renderer_add(kelp_renderer renderer, kelp_asset asset);
KELP_API kelp_result kelp_renderer_remove(kelp_renderer renderer, kelp_asset asset);

typedef struct kelp_stats {
  uint32_t struct_size;
  uint32_t instances;       // parts of instances that were drawn
  uint32_t culled;          // parts out of view, and those that are too small
  uint32_t left_out;        // instances that cannot be drawn: their pose or matrix is not sound
  uint32_t draws;           // calls of OpenGL
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

// Call it once a frame. Uploads at most max_bytes (0, or 4096 and more) of what the draws since the last call
// lacked. Requests from the assets what is not in memory, so that kelp_asset_pump reads it. stats: may be
// null; stats->pending is 0 when all is there. KELP_ERROR_LIMIT: the coarsest levels do not fit; those that
// do are drawn.
KELP_API kelp_result kelp_renderer_upload(kelp_renderer renderer, uint64_t max_bytes, kelp_stats* stats);

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
  uint32_t scene_depth;    // a GL_TEXTURE_2D with the depth so far, where rays end; 0: none
  // Called just before a draw with its program in use, to set what surface_glsl needs: uniforms, and textures
  // on units from KELP_FIRST_HOST_UNIT on. May be null.
  void (*bind)(void* user, uint32_t program);
  void* bind_user;
} kelp_view;
enum { KELP_FIRST_HOST_UNIT = 4 };
KELP_API kelp_result kelp_view_defaults(kelp_view* view);

typedef int32_t kelp_pass;
enum {
  KELP_PASS_COLOR = 0,  // color and depth of solid parts
  KELP_PASS_DEPTH = 1,  // depth only, for shadow maps and pre-passes
  KELP_PASS_FOG = 2     // fog parts, after everything opaque; blends into draw buffer 0
};
// Draws into the current framebuffer and viewport. stats: may be null. Instances that cannot be drawn are
// left out (stats->left_out). KELP_ERROR_MISUSE, and nothing is drawn: an asset that was not added, a pose or
// a palette of another asset (the error's offset is the index of the instance), a view that is not sound,
// a framebuffer that is not complete.
KELP_API kelp_result kelp_renderer_draw(kelp_renderer renderer, const kelp_view* view,
                                        const kelp_instance* instances, uint32_t count, kelp_pass pass,
                                        kelp_stats* stats);

// GLSL for a shader of the host's own: rays through posed instances (shaders/scene.glsl). *strings: *count
// texts for glShaderSource, after the #version line; valid while the renderer lives.
KELP_API kelp_result kelp_renderer_get_trace_glsl(kelp_renderer renderer, const char* const** strings,
                                                  uint32_t* count);
// Binds what that needs to a linked program: uniforms, texture units first_unit and the next. Valid until the
// next upload, the next bind_trace, or the end of the frame.
KELP_API kelp_result kelp_renderer_bind_trace(kelp_renderer renderer, uint32_t program, const kelp_view* view,
                                              const kelp_instance* instances, uint32_t count,
                                              int32_t first_unit, kelp_stats* stats);

// Bytes of gpu_budget that the asset takes, as far as its grids are loaded. features: those of the
// renderer. Any thread.
KELP_API kelp_result kelp_pool_bytes(kelp_asset asset, kelp_features features, uint64_t* bytes);
// The level of a part of an instance that a draw wants at a pixel, for a kelp_raycast that meets what is
// seen; KELP_NONE if it cannot be drawn. Any thread.
KELP_API kelp_result kelp_level_at(const kelp_view* view, const kelp_instance* instance, int32_t part,
                                   int32_t x, int32_t y, int32_t* level);

#endif
