// SPDX-License-Identifier: MIT
// How far the bent solid is, what overlaps it, and what a moving sphere hits. The pack must have distances
// (kelp-bake's default), and kelp_asset_options.distance_level must ask for them. Include kelp/kelp.h.
//
// All lengths are in the unit of the world. Any thread may call these functions while nobody changes the
// poses. `boxes`: kelp_instance_get_bounds of each instance; a host that asks often makes them once a frame.
// Null: they are made here, for every call; a list of one needs none.
//
// Errors: KELP_ERROR_MISUSE for numbers that are not finite, lengths out of range, and assets opened without
// distances; KELP_ERROR_UNSUPPORTED_FEATURE if the pack has none; KELP_ERROR_NOT_YET if a solid part has none
// in memory yet; why they failed to load.
#ifndef KELP_C_DISTANCE_H
#define KELP_C_DISTANCE_H

#include "kelp/c/instance.h"

typedef struct kelp_distance_answer {
  uint32_t struct_size;
  // Never more than the distance to the solid; negative inside of it. Infinite: there is no solid.
  float bound;
  float away[3];     // unit; where the distance grows fastest
  int32_t instance;  // index in the list
  int32_t part;      // KELP_NONE: there is no solid
  int32_t level;     // of the distances that answered
} kelp_distance_answer;
KELP_API kelp_result kelp_distance(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                   const float point[3], kelp_distance_answer* answer);

typedef struct kelp_closest_point_answer {
  uint32_t struct_size;
  float distance;  // infinite: there is no solid within reach
  float point[3];  // of the solid
  int32_t instance;
  int32_t part;       // KELP_NONE: there is no solid within reach
  kelp_bool ran_out;  // the search took too long: nearer solid may exist
} kelp_closest_point_answer;
// A point of the solid that is nearest to `point`, to a voxel. reach: above 0; may be infinite.
KELP_API kelp_result kelp_closest_point(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                        const float point[3], float reach, kelp_closest_point_answer* answer);

// *instance: the index of the first instance that the shape overlaps, or KELP_NONE. An overlap is never
// missed; one may be found where the solid is only near, within a voxel.
KELP_API kelp_result kelp_overlaps_sphere(const kelp_instance* instances, uint32_t count,
                                          const kelp_box* boxes, const float center[3], float radius,
                                          int32_t* instance);
// All points within `radius` of the line from `a` to `b`, which differ.
KELP_API kelp_result kelp_overlaps_capsule(const kelp_instance* instances, uint32_t count,
                                           const kelp_box* boxes, const float a[3], const float b[3],
                                           float radius, int32_t* instance);
// rotation: a unit quaternion, of the box in the world.
KELP_API kelp_result kelp_overlaps_box(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                       const float center[3], const float half_size[3],
                                       const float rotation[4], int32_t* instance);

typedef struct kelp_sphere_cast_answer {
  uint32_t struct_size;
  kelp_bool hit;
  float t;          // of the way, 0 to 1, that is free
  float center[3];  // of the sphere there
  float away[3];    // unit; meaningless without a hit
  int32_t instance;
  int32_t part;       // KELP_NONE: the whole way is free
  kelp_bool ran_out;  // the search took too long: the way up to t is free, and no more is known
} kelp_sphere_cast_answer;
// Moves a sphere from one point to another one, and stops it before it touches the solid.
KELP_API kelp_result kelp_sphere_cast(const kelp_instance* instances, uint32_t count, const kelp_box* boxes,
                                      const float from[3], const float to[3], float radius,
                                      kelp_sphere_cast_answer* answer);

#endif
