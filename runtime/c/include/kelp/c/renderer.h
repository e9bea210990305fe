// SPDX-License-Identifier: MIT
// Draws instances with OpenGL 3.3 core or OpenGL ES 3.0, into the framebuffer that the host has bound. Call
// these functions on the thread that made the renderer, with its context current. On another thread they are
// KELP_ERROR_WRONG_THREAD, with another context or none KELP_ERROR_MISUSE, and do nothing. (abandon, remove
// and get_trace_glsl need no context.)
// runtime/HOST_GUIDE.md says what state changes. Include kelp/kelp.h.
#ifndef KELP_C_RENDERER_H
#define KELP_C_RENDERER_H

#include "kelp/c/view.h"

typedef struct kelp_renderer {
  uint64_t id;
} kelp_renderer;

typedef int32_t kelp_state;
enum {
  KELP_STATE_RESTORE = 0,  // every call leaves the state of OpenGL as it found it
  KELP_STATE_LEAVE = 1
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

// Call it once a frame. Uploads at most max_bytes (0, or 4096 and more) of what the draws since the last call
// lacked. Requests from the assets what is not in memory, so that kelp_asset_pump reads it. stats: may be
// null; stats->pending is 0 when all is there. KELP_ERROR_LIMIT: the coarsest levels do not fit; those that
// do are drawn.
KELP_API kelp_result kelp_renderer_upload(kelp_renderer renderer, uint64_t max_bytes, kelp_stats* stats);

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

#endif
