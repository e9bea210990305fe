// SPDX-License-Identifier: MIT
// Springs on the knots of an asset, and on the nodes of parts with cages: pushed by the player, a blow or the
// wind, they swing back. Each frame: make the pose without the spring, kelp_spring_step, push,
// kelp_spring_add_to. Use a spring on one thread at a time. Include kelp/kelp.h.
//
// KELP_ERROR_MISUSE: a part that does not exist, a pose or an asset that does not fit, numbers that are not
// finite.
#ifndef KELP_C_SPRING_H
#define KELP_C_SPRING_H

#include "kelp/c/instance.h"

typedef struct kelp_spring {
  uint64_t id;
} kelp_spring;

typedef struct kelp_spring_options {
  uint32_t struct_size;
  float frequency;   // of the undamped swing, in Hz; above 0
  float damping;     // ratio; 0 swings for ever, 1 returns fastest without overshoot
  float reach;       // the farthest that a knot or node moves, in heights of its part; above 0
  kelp_bool rooted;  // the first knot of a part and its lowest nodes are fixed; the part bends like a beam.
                     // Parts with a parent are fixed in any case, where they hang
  // The parts that give way to kelp_spring_push_away, in any order; null and 0: all. Nodes that follow listed
  // parts (joints of a skin) give way by weight. Copied. KELP_ERROR_MISUSE: no parts, or one that does not
  // exist; the error's offset is its place in the list.
  const int32_t* parts;
  uint32_t part_count;
} kelp_spring_options;
KELP_API kelp_result kelp_spring_options_defaults(kelp_spring_options* options);

// A spring at rest, without wind. options: null for the defaults. allocator: as in kelp_pose_create.
KELP_API kelp_result kelp_spring_create(kelp_asset asset, const kelp_spring_options* options,
                                        const kelp_allocator* allocator, kelp_spring* spring);
KELP_API kelp_result kelp_spring_destroy(kelp_spring spring);

KELP_API kelp_result kelp_spring_get_parts(kelp_spring spring, int32_t* parts);
// The movement of a knot or a node relative to its pose.
typedef struct kelp_swing {
  float offset[3];    // heights of the part
  float velocity[3];  // heights per second
} kelp_swing;
// Copies the state of a part's knots, as kelp_pose_get_knots does.
KELP_API kelp_result kelp_spring_get_swings(kelp_spring spring, int32_t part, kelp_swing* swings,
                                            uint32_t capacity, uint32_t* count);
// The same of the nodes of the part's finest cage; none without a cage. KELP_ERROR_MISUSE: no such part.
KELP_API kelp_result kelp_spring_get_node_swings(kelp_spring spring, int32_t part, kelp_swing* swings,
                                                 uint32_t capacity, uint32_t* count);
KELP_API kelp_result kelp_spring_reset(kelp_spring spring);  // to rest, without wind

// A blow: adds a velocity (heights of the part per second, in its axes) to the free end, less to the rest.
KELP_API kelp_result kelp_spring_push(kelp_spring spring, int32_t part, const float velocity[3]);
// The same, with a velocity in the world, as the instance stands there.
KELP_API kelp_result kelp_spring_push_in_world(kelp_spring spring, const kelp_instance* instance,
                                               int32_t part, const float velocity[3]);
// Wind from now on: the acceleration that it would give the free end if nothing held it (heights of the part
// per second squared, in its axes).
KELP_API kelp_result kelp_spring_set_wind(kelp_spring spring, int32_t part, const float acceleration[3]);
KELP_API kelp_result kelp_spring_set_wind_in_world(kelp_spring spring, const kelp_instance* instance,
                                                   int32_t part, const float acceleration[3]);
// The player's body, a sphere in the world: pushes every part with voxels, or those of the options' list, out
// of it, of parts with cages the nodes near it. instance->pose: without the spring.
KELP_API kelp_result kelp_spring_push_away(kelp_spring spring, const kelp_instance* instance,
                                           const float center[3], float radius);
// Advances by `seconds`, at least 0. Exact for any step: two half steps equal one whole.
KELP_API kelp_result kelp_spring_step(kelp_spring spring, float seconds);
// Adds the offsets to the pose, with tangents to match, then clamps it. All nodes of a part where some swing
// are yours from then on, until kelp_pose_reset. Moves parts that hang on what moved.
KELP_API kelp_result kelp_spring_add_to(kelp_spring spring, kelp_pose pose);

#endif
