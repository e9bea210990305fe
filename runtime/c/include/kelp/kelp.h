// SPDX-License-Identifier: MIT
// kelp for C: packs in memory, poses, springs, queries and the renderer, for any language that calls C. C99,
// and clean in C++. runtime/c/README.md lists the C++ function behind each of these.
//
// A program opens an asset, makes poses and a renderer, and each frame calls kelp_asset_pump,
// kelp_pose_add_clip, kelp_renderer_upload and kelp_renderer_draw: samples/sdl_c/main.c. One that draws with
// another API than OpenGL makes a planner in place of a renderer: runtime/DRAW_DATA.md.
//
// Results. Functions return a kelp_result: KELP_OK, which is 0, or why they failed. kelp_last_error has the
// text. A function that fails changes nothing, unless its comment says otherwise, and leaves what `*out`
// parameters point to as it was.
//
// Handles. kelp_asset, kelp_pose, kelp_spring, kelp_renderer and kelp_planner name objects of the library. A
// handle whose id is 0 names none. Ids are never used again in a process. So a handle of a destroyed object
// is KELP_ERROR_HANDLE in every function, also when it is destroyed twice. An object that another thread is
// using is not destroyed: KELP_ERROR_BUSY.
//
// Structs. A struct that may grow starts with struct_size: set it to sizeof, and everything that you don't
// set to zero. In C99: `kelp_view view = {.struct_size = sizeof view};`. This holds for structs that the
// library fills, too. A struct that is smaller than in the first version is KELP_ERROR_STRUCT_SIZE. So is one
// that is larger than the library knows, unless all that it does not know is zero. Fields that an older
// struct lacks count as zero. kelp_..._defaults fills in the defaults.
//
// Numbers. Meters, +Y up, right-handed, as in glTF. Radians, seconds, linear colors. Matrices have 16
// floats, column by column, as OpenGL takes them; quaternions are x, y, z, w. Knots, and what moves them,
// count in heights of their part. Rest points are points of the undeformed model in its file's meters.
// Indices count from 0. kelp_bool: 0 is false, any other number is true; the library writes 0 and 1.
//
// Threads. The library starts none. Any thread may call any function with any asset, at the same time. Use a
// pose or a spring on one thread at a time; queries only read poses, so several threads may ask about one
// pose while nobody changes it. Functions of a renderer are KELP_ERROR_WRONG_THREAD on any thread but the one
// that made it (kelp_renderer_use_here), those of a planner KELP_ERROR_BUSY while another thread is in one. A
// callback may call any function here. It must not throw a C++ exception.
//
// Memory. What you pass is read during the call and never kept, except where a comment says so. Pointers that
// the library returns belong to it, and their comments say how long they are valid. All pointers must be
// valid or, where a comment allows it, null. Packs are not trusted: any byte may be hostile.
#ifndef KELP_KELP_H
#define KELP_KELP_H

#include "kelp/c/asset.h"
#include "kelp/c/base.h"
#include "kelp/c/distance.h"
#include "kelp/c/instance.h"
#include "kelp/c/planner.h"
#include "kelp/c/pose.h"
#include "kelp/c/renderer.h"
#include "kelp/c/spring.h"
#include "kelp/c/view.h"

#endif
