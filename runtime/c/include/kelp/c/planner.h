// SPDX-License-Identifier: MIT
// Drawing data for a graphics API of the host's own: bytes to copy, records, uniforms, draw calls.
// For hosts that draw with Vulkan, Direct3D, Metal or WebGPU. runtime/DRAW_DATA.md has the frame in ten steps
// and the state of each pass. Include kelp/kelp.h.
//
// A planner makes no call of any graphics API, and belongs to no thread: use it on one at a time. While a
// thread, or a caller of this callback, is in one of its functions, the others are KELP_ERROR_BUSY. What its
// functions point to is the planner's; their comments say how long it is valid.
#ifndef KELP_C_PLANNER_H
#define KELP_C_PLANNER_H

#include "kelp/c/view.h"

typedef struct kelp_planner {
  uint64_t id;
} kelp_planner;

typedef struct kelp_planner_options {
  uint32_t struct_size;
  kelp_features features;  // of the programs that the host has made
  // Size of the pool, a buffer of the host's that holds all voxels. Whole blocks of 4 KiB; at least 256 KiB,
  // less than 16 GiB, and no more than a storage buffer of your API may have (of Vulkan and WebGPU 128 MiB is
  // sure; HLSL by spirv-cross counts bytes in 32 bits). If the scene needs more, what covers the fewest
  // pixels is drawn coarser.
  uint64_t pool_bytes;
  // Told once for each asset why an instance was left out, or that kelp_asset_pump or kelp_planner_upload was
  // never called. Called in functions of the planner. May be null.
  void (*log)(void* user, const char* text);
  void* user;
  const kelp_allocator* allocator;  // copied. Null: malloc and free
} kelp_planner_options;
KELP_API kelp_result kelp_planner_options_defaults(kelp_planner_options* options);

// The pool must then hold what kelp_planner_get_copies says. KELP_ERROR_MISUSE: pool_bytes is out of range.
KELP_API kelp_result kelp_planner_create(const kelp_planner_options* options, kelp_planner* planner);
KELP_API kelp_result kelp_planner_destroy(kelp_planner planner);
// The pool_bytes that it was made with.
KELP_API kelp_result kelp_planner_get_pool_bytes(kelp_planner planner, uint64_t* bytes);

// Registers an asset, and wants its tables copied; remove it before you destroy it. KELP_ERROR_MISUSE: it was
// added before, or copies of the call before were not made. KELP_ERROR_LIMIT: no room in the pool. Make the
// copies that it wants even if it fails.
KELP_API kelp_result kelp_planner_add(kelp_planner planner, kelp_asset asset);
KELP_API kelp_result kelp_planner_remove(kelp_planner planner, kelp_asset asset);

// A program of the shaders: a set of bits, one for each #define. KELP_PROGRAM_SHEARED alone is 0.
typedef uint32_t kelp_program;
enum {
  KELP_PROGRAM_SHEARED = 0,      // draws solid parts that are sheared
  KELP_PROGRAM_SWEPT = 1,        // parts that are swept
  KELP_PROGRAM_CAGED = 2,        // solid parts with cages, by the faces of these: a list of triangles
  KELP_PROGRAM_ANY_BEND = 3,     // solid parts of all kinds, by their bounds: with KELP_FEATURE_DISTANCES in
                                 // place of the others; without, parts with cages that not all rays enter by
                                 // a face
  KELP_PROGRAM_FOG = 4,          // fog
  KELP_PROGRAM_FOG_HEAT = 8,     // fog that glows by its heat
  KELP_PROGRAM_FOG_SHADOW = 16,  // fog that shades itself (kelp_view.self_shadow)
  KELP_PROGRAM_DEBUG = 32,       // parts, in the colors of kelp_view.debug
  KELP_PROGRAM_LINES = 64        // the lines of kelp_view.debug: no parts
};
enum { KELP_PROGRAMS = 65 };  // every kelp_program is below
// The programs that parts of the asset may need, but for kelp_view.debug: bit i of *programs for the
// kelp_program i. The asset need not be added.
KELP_API kelp_result kelp_planner_get_programs(kelp_planner planner, kelp_asset asset, uint32_t* programs);

typedef int32_t kelp_dialect;
enum { KELP_DIALECT_GL_330 = 0, KELP_DIALECT_ES_300 = 1, KELP_DIALECT_VULKAN = 2 };
typedef int32_t kelp_stage;
enum { KELP_STAGE_VERTEX = 0, KELP_STAGE_FRAGMENT = 1 };
// The GLSL of a program, #version and all. Writes at most `capacity` bytes of it to `text` (may be null if
// that is 0), the last one 0. *size: the bytes that the whole takes, with the 0. features: for solid parts.
// surface_glsl: as in kelp_renderer_options; may be null. Any thread.
KELP_API kelp_result kelp_get_program_text(kelp_program program, kelp_dialect dialect, kelp_stage stage,
                                           kelp_features features, const char* surface_glsl, char* text,
                                           uint64_t capacity, uint64_t* size);

// Call it once a frame. Wants at most max_bytes (0, or 4096 and more) copied of what the draws since the last
// call lacked. Requests from the assets what is not in memory, so that kelp_asset_pump reads it. stats: may
// be null; stats->pending is 0 when all is there. KELP_ERROR_LIMIT: the coarsest levels do not fit; those
// that do are drawn, so make the copies then too. KELP_ERROR_MISUSE: those of the call before were not made.
KELP_API kelp_result kelp_planner_upload(kelp_planner planner, uint64_t max_bytes, kelp_stats* stats);

// Bytes to be copied into the pool.
typedef struct kelp_copy {
  uint64_t offset;  // bytes into the pool, a multiple of 4
  // kelp_draw_data.frame of the last draw that may read what is overwritten. 0: none. A copy that the GPU
  // makes between two frames, in a queue and behind a barrier, comes after that frame by itself. Who writes
  // into memory that the GPU reads waits until that frame is done.
  uint64_t frame;
  const uint32_t* words;
  size_t size;  // of `words`, in bytes
} kelp_copy;
// The copies that the last create, add or upload wants made before the calls of the next draw, even if it
// failed. They do not overlap. Those of an asset end with its removal. *copies: *count of them. They and
// their words are valid until the planner's next copied, add, remove or upload, or the end of the asset; the
// array also ends with the next get_copies.
KELP_API kelp_result kelp_planner_get_copies(kelp_planner planner, const kelp_copy** copies, uint32_t* count);
// The copies were made: lets go of their words. The next add and upload are KELP_ERROR_MISUSE before.
KELP_API kelp_result kelp_planner_copied(kelp_planner planner);

// A draw call: `count` instances from `first` on, of so many vertices each: strips of six; of
// KELP_PROGRAM_CAGED lists of triangles, of KELP_PROGRAM_LINES one list of lines, with kelp_draw_data.lines
// as the records. No vertex buffer.
typedef struct kelp_call {
  kelp_program program;
  uint32_t first;
  uint32_t count;
  uint32_t vertices;
  // Before this call the scene's depth must be the depth drawn so far: copy it. Only with KELP_DEPTH_COPIED.
  kelp_bool copies_depth;
} kelp_call;

// The uniform block of all programs; std140.
typedef struct kelp_uniforms {
  float sun_direction[3];  // normalized
  int32_t first_instance;
  float sun_color[3];
  uint32_t motion;
  float sky_color[3];
  uint32_t depth_only;
  float ground_color[3];
  float clip_low;
  int32_t scene;  // 0: no scene depth is bound; 1, 2: one is, of an ordinary or a reversed depth
  kelp_shading shading;
  uint32_t self_shadow;
  int32_t occlusion_rays;
  float occlusion_reach;
  float sun_radius;
  uint32_t occlusion;
  uint32_t display;
  int32_t part_count;  // of kelp_planner_trace
  kelp_debug_view debug;
  int32_t padding[2];
} kelp_uniforms;

// The depth of the scene so far, where rays end, as a texture: texel (x, y) belongs to the framebuffer's
// pixel (x, y).
typedef int32_t kelp_depth;
enum {
  KELP_DEPTH_NONE = 0,   // there is none. Fog is then hidden only where it begins behind the scene
  KELP_DEPTH_GIVEN = 1,  // the host has one
  KELP_DEPTH_COPIED = 2  // the host copies the depth buffer where kelp_call.copies_depth says so: for fog,
                         // and for kelp_view.depth_batches
};

enum { KELP_RECORD_WIDTH = 1024 };  // texels of 16 bytes in a row of records

// A picture, or a pass of it. Its pointers are valid until the planner's next draw or trace.
typedef struct kelp_draw_data {
  uint32_t struct_size;
  uint32_t call_count;
  // For a storage buffer, or an unsigned RGBA texture KELP_RECORD_WIDTH wide: whole rows.
  const uint32_t* records;
  size_t records_size;  // in bytes; 0: nothing to draw
  const kelp_uniforms* uniforms;
  const kelp_call* calls;  // call_count of them, in this order
  uint64_t frame;          // 1, 2, ...: for kelp_copy.frame. 0: the viewport has no pixels
  const uint32_t* lines;   // lines_size bytes, as records, for KELP_PROGRAM_LINES
  size_t lines_size;
} kelp_draw_data;

// Lists what to draw. Of the view, scene_depth, bind and bind_user are ignored. stats: may be null. Instances
// that cannot be drawn are left out (stats->left_out). KELP_ERROR_MISUSE: an asset that was not added, a pose
// or a palette of another asset (the error's offset is the index of the instance), a view that is not sound.
KELP_API kelp_result kelp_planner_draw(kelp_planner planner, const kelp_view* view,
                                       const kelp_instance* instances, uint32_t count, kelp_pass pass,
                                       kelp_depth depth, kelp_draw_data* data, kelp_stats* stats);
// The same for kelpTrace (shaders/scene.glsl) in a host's own shaders: all solid parts, no calls.
KELP_API kelp_result kelp_planner_trace(kelp_planner planner, const kelp_view* view,
                                        const kelp_instance* instances, uint32_t count, kelp_draw_data* data,
                                        kelp_stats* stats);

#endif
