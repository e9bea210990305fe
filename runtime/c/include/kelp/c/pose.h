// SPDX-License-Identifier: MIT
// A pose: where the knots of every part are now, and the nodes of parts with cages. Add clips to it, move its
// knots, blend it with others. Use a pose on one thread at a time. Include kelp/kelp.h.
#ifndef KELP_C_POSE_H
#define KELP_C_POSE_H

#include "kelp/c/asset.h"

typedef struct kelp_pose {
  uint64_t id;
} kelp_pose;

// Rotation, translation and scale of a part, in pivot space.
typedef struct kelp_motion {
  float translation[3];
  float rotation[4];  // a unit quaternion; 0, 0, 0, 1 at rest
  float scale[3];     // 1 at rest
  float roll;         // radians: the turn of a swept part about its spline
} kelp_motion;

// A pose at rest. It copies what it needs of the asset. allocator: copied; null for malloc and free. Nothing
// else here allocates.
KELP_API kelp_result kelp_pose_create(kelp_asset asset, const kelp_allocator* allocator, kelp_pose* pose);
KELP_API kelp_result kelp_pose_destroy(kelp_pose pose);

KELP_API kelp_result kelp_pose_get_parts(kelp_pose pose, int32_t* parts);
// *fits: true if the pose has as many parts, knots and nodes as the asset.
KELP_API kelp_result kelp_pose_fits(kelp_pose pose, kelp_asset asset, kelp_bool* fits);

// Copies the knots of a part: at most `capacity` of them to `knots` (may be null if that is 0). *count: how
// many the part has. KELP_ERROR_MISUSE: no such part.
KELP_API kelp_result kelp_pose_get_knots(kelp_pose pose, int32_t part, kelp_knot* knots, uint32_t capacity,
                                         uint32_t* count);
// Replaces positions and tangents as they are given. KELP_ERROR_MISUSE: their number or an `at` differs.
KELP_API kelp_result kelp_pose_set_knots(kelp_pose pose, int32_t part, const kelp_knot* knots,
                                         uint32_t count);
// Moves a knot, in heights of the part; automatic tangents follow.
KELP_API kelp_result kelp_pose_move(kelp_pose pose, int32_t part, int32_t knot, const float offset[3]);
KELP_API kelp_result kelp_pose_set_tangent(kelp_pose pose, int32_t part, int32_t knot,
                                           const float tangent[3]);
KELP_API kelp_result kelp_pose_get_motion(kelp_pose pose, int32_t part, kelp_motion* motion);
KELP_API kelp_result kelp_pose_set_motion(kelp_pose pose, int32_t part, const kelp_motion* motion);

// Copies where the nodes of a part's finest cage are now: three floats each, in part space (level-0 voxels);
// at most `capacity` nodes to `nodes` (may be null if that is 0). *count: how many the part has; 0 without a
// cage. KELP_ERROR_MISUSE: no such part.
KELP_API kelp_result kelp_pose_get_nodes(kelp_pose pose, int32_t part, float* nodes, uint32_t capacity,
                                         uint32_t* count);
// *nodes: the same nodes, to write; filled with where they are now. From then on they are where you put them,
// and the knots no longer move them, until kelp_pose_reset. Call it again before each round of writing: it
// tells the pose that nodes change. The pointer stays valid as long as the pose; null without a cage.
KELP_API kelp_result kelp_pose_write_nodes(kelp_pose pose, int32_t part, float** nodes, uint32_t* count);

// Moves the joints of the asset's skin as your own animation says: `count` matrices of 16 floats, one for
// each joint of kelp_asset_get_joint, meters at rest -> meters now. If M is where your skeleton has a joint,
// joint space -> meters, that is M * inverse_bind. It may scale, shear, mirror and flatten. Until
// kelp_pose_reset clips and motions no longer move the joints' parts; nodes that were written stay.
// KELP_ERROR_MISUSE, with nothing changed: the pose does not fit, `count` is not the number of joints, or a
// matrix is not affine or has a number that is not finite; the error's offset is the joint.
KELP_API kelp_result kelp_pose_set_joints(kelp_pose pose, kelp_asset asset, const float* matrices,
                                          uint32_t count);

// Widens and turns a part's sections, at a knot of the empty part that says them; linear between knots.
// width: factors along the part's x and z (null: 1); twist: radians about the spline; keep_volume: 0 to 1,
// how far the widths are changed so that the volume stays. Clips move these knots, too. KELP_ERROR_MISUSE:
// the part has no sections, no such knot, or a number is not finite.
KELP_API kelp_result kelp_pose_set_section(kelp_pose pose, int32_t part, int32_t knot, const float width[2],
                                           float twist, float keep_volume);

// Sets the weight of the morph targets of that name: 0 at rest, 1: as in the file; it may be anything. Clips
// add to it; it is the x of the translation that kelp_pose_get_motion gives of the target's empty part.
// KELP_ERROR_MISUSE: there is none, the pose does not fit, or the weight is not finite.
KELP_API kelp_result kelp_pose_set_morph(kelp_pose pose, kelp_asset asset, const char* name, float weight);

KELP_API kelp_result kelp_pose_reset(kelp_pose pose);  // back to rest
// Copies another pose. KELP_ERROR_MISUSE: their parts, knots or nodes differ in number.
KELP_API kelp_result kelp_pose_assign(kelp_pose pose, kelp_pose other);
// Moves the pose towards `to`: weight 0 changes nothing, weight 1 makes it `to`. part_weights: a factor of
// the weight for each part, `count` of them; null and 0: all 1. KELP_ERROR_MISUSE: the poses differ in parts,
// knots or nodes, or a weight is not within 0 to 1.
KELP_API kelp_result kelp_pose_blend(kelp_pose pose, kelp_pose to, float weight, const float* part_weights,
                                     uint32_t count);
// KELP_OK if every part can be drawn. Else KELP_ERROR_NOT_MONOTONE, KELP_ERROR_FOLDS or KELP_ERROR_MISUSE,
// with the index of the part as the error's offset.
KELP_API kelp_result kelp_pose_check(kelp_pose pose);
// Changes knots until every part can be drawn.
KELP_API kelp_result kelp_pose_clamp(kelp_pose pose);

typedef int32_t kelp_play;
enum { KELP_PLAY_LOOP = 0, KELP_PLAY_ONCE = 1 };
// Adds `weight` times the clip at `seconds`. For a crossfade add one clip with weight 1 - w and the other
// with w. KELP_ERROR_MISUSE: no such clip, the pose does not fit, or a number is not finite.
KELP_API kelp_result kelp_pose_add_clip(kelp_pose pose, kelp_asset asset, int32_t clip, double seconds,
                                        float weight, kelp_play play);

#endif
