// SPDX-License-Identifier: MIT
// A posed asset in the world, and queries that need no GPU: bounds, rays, points, frames. Include
// kelp/kelp.h.
//
// Any thread may call these functions while nobody changes the poses. KELP_ERROR_MISUSE: a part or a socket
// that does not exist. With a list of instances, an error's offset is the index of the instance. A list that
// is longer than any before takes some 200 bytes an instance from malloc. They stay with the thread, for its
// next call, until it ends.
#ifndef KELP_C_INSTANCE_H
#define KELP_C_INSTANCE_H

#include "kelp/c/pose.h"

// How draws treat an instance whose pose kelp_pose_check refuses.
typedef int32_t kelp_unsound;
enum {
  KELP_UNSOUND_LEAVE_OUT = 0,  // it is not drawn
  KELP_UNSOUND_CLAMP = 1       // it is drawn as kelp_pose_clamp makes it
};

// All elements of a list have the same struct_size, which is also their distance in memory.
typedef struct kelp_instance {
  uint32_t struct_size;
  // Materials in place of the pack's palette, one for each of its entries. 0: the pack's own.
  uint32_t palette_count;
  const kelp_material* palette;
  kelp_asset asset;
  kelp_pose pose;      // id 0: at rest
  float to_world[16];  // meters of the model -> world; affine and invertible; may mirror
  float tint[4];       // multiplies the base color, linear
  // For motion vectors: pose and matrix of the previous frame. Id 0 and null: as now.
  kelp_pose previous_pose;
  const float* previous_to_world;
  kelp_unsound unsound;  // for draws; queries leave such an instance out
} kelp_instance;

// The identity and a white tint; no asset.
KELP_API kelp_result kelp_instance_defaults(kelp_instance* instance);

// An axis-aligned box; empty if min > max on any axis.
typedef struct kelp_box {
  float min[3];
  float max[3];
} kelp_box;
// A box in the world that contains the bent instance.
KELP_API kelp_result kelp_instance_get_bounds(const kelp_instance* instance, kelp_box* bounds);

// The voxels of a part (kelp_part.size) -> world, with the motions of the part and of its ancestors, without
// the bend.
KELP_API kelp_result kelp_instance_part_to_world(const kelp_instance* instance, int32_t part,
                                                 float matrix[16]);
// The same of the first `count` parts: 16 floats each.
KELP_API kelp_result kelp_instance_parts_to_world(const kelp_instance* instance, float* matrices,
                                                  uint32_t count);
// A rest point of a part -> world, with all that the pose does to it.
KELP_API kelp_result kelp_instance_to_world(const kelp_instance* instance, int32_t part, const float rest[3],
                                            float world[3]);
// World -> rest point. *found is false, and `rest` unchanged, if the point belongs to no section of the part,
// or the pose cannot be drawn.
KELP_API kelp_result kelp_instance_to_rest(const kelp_instance* instance, int32_t part, const float world[3],
                                           float rest[3], kelp_bool* found);
// An orthonormal, right-handed frame for things attached to a rest point; y points along the spline.
KELP_API kelp_result kelp_instance_frame_at(const kelp_instance* instance, int32_t part, const float rest[3],
                                            float matrix[16]);
// The frame of a socket: as above, turned as the artist says.
KELP_API kelp_result kelp_instance_socket_to_world(const kelp_instance* instance, int32_t socket,
                                                   float matrix[16]);

typedef struct kelp_raycast_answer {
  uint32_t struct_size;
  kelp_bool found;    // everything below is 0 without a hit
  float t;            // position = origin + t * direction
  float position[3];  // world
  float normal[3];    // world, unit, outward
  float rest[3];      // the same point of the undeformed model
  int32_t instance;   // index in the list
  int32_t part;
  int32_t level;
  int32_t voxel[3];   // in voxels of `level`
  uint32_t material;  // palette index
} kelp_raycast_answer;
// The nearest hit of a ray with the solid voxels of any of the instances, at level `level`. Where those are
// not in memory, the hit is on the finest coarser level that is, and they are requested. Never blocks.
// direction: any length above 0. t_max: in lengths of the direction. No hit: for a ray that is zero or not
// finite, too, and for instances whose pose cannot be drawn.
KELP_API kelp_result kelp_raycast(const kelp_instance* instances, uint32_t count, const float origin[3],
                                  const float direction[3], float t_max, int32_t level,
                                  kelp_raycast_answer* answer);

#endif
