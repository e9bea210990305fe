// SPDX-License-Identifier: MIT
// A posed asset in the world, and queries that need no GPU: bounds, rays, points, frames. Rays run through
// shaders/trace.glsl compiled as C++, so they hit what the GPU draws. All functions may be called on any
// thread while nobody changes the pose.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "kelp/runtime/asset.h"
#include "kelp/runtime/pose.h"

namespace kelp::runtime {

// How draws treat an instance whose pose Pose::check() refuses.
enum class Unsound : std::uint8_t {
  kLeaveOut,  // it is not drawn
  kClamp,     // it is drawn as Pose::clamp() makes it; left out if its knots are no finite numbers
};

// Owns nothing. The pointers must be valid during the call that takes the instance.
struct Instance {
  const Asset* asset = nullptr;
  const Pose* pose = nullptr;  // null: at rest
  glm::mat4 to_world{1};       // object -> world; affine and invertible; may mirror
  glm::vec4 tint{1};           // multiplies the base color, linear
  // Materials in place of the pack's palette, one for each of its entries. Empty: the pack's own.
  std::span<const Material> palette = {};
  // For motion vectors: pose and matrix of the previous frame. Null: as now, and so is a part whose previous
  // pose could not be drawn.
  const Pose* previous_pose = nullptr;
  const glm::mat4* previous_to_world = nullptr;
  Unsound unsound = Unsound::kLeaveOut;  // for draws; queries leave such an instance out
};

// A list of instances, or one alone: raycast(instance, ray). Owns nothing; valid during the call.
struct Instances : std::span<const Instance> {
  using span::span;
  Instances() = default;
  Instances(std::span<const Instance> list) : span(list) {}
  Instances(const Instance& one) : span(&one, 1) {}
};

// Part space (level-0 voxels) -> world, including the motion of the part and of its ancestors. kMisuse: there
// is no such part, or the pose is of an asset with another number of parts.
Result<glm::mat4> partToWorld(const Instance& instance, int part);
// The same of the first parts, as many as there are matrices. It takes less time than a call for each where
// parts hang on swept splines. kMisuse: there are more matrices than parts, or the pose is
// of another asset.
Result<void> partsToWorld(const Instance& instance, std::span<glm::mat4> out);
// A box in the world that contains the deformed instance: of a part with cages, as its finest cage bends it;
// a coarser level may reach a little farther. Empty if `asset` is null. Swept parts and parts with cages are
// left out if they cannot be drawn.
Box bounds(const Instance& instance);

struct Ray {
  glm::vec3 origin{0};            // world
  glm::vec3 direction{0, 0, -1};  // world; any length > 0
  float t_max = 1e30f;            // in units of the length of `direction`
};

struct Hit {
  float t = 0;            // position = origin + t * direction
  glm::vec3 position{0};  // world
  glm::vec3 normal{0};    // world, unit, outward
  int instance = 0;       // index in the list that was given
  int part = 0;
  int level = 0;
  glm::ivec3 voxel{0};        // in voxels of `level`
  glm::vec3 rest{0};          // the same point of the undeformed model: object space, meters
  std::uint8_t material = 0;  // palette index
};

// The nearest hit of the ray with the solid voxels of any of the instances, at level `level`. Where bricks of
// that level are not in memory, the hit is on the finest coarser level that is, and the bricks are requested.
// Never blocks. A part with cages is traced in the cage of the level; that is used once the next coarser
// level is complete. The first call after a change of a pose makes what the cage needs. nullopt: no hit,
// nothing in memory, a zero or non-finite ray, or a pose that Pose::check() refuses.
std::optional<Hit> raycast(Instances instances, const Ray& ray, int level = 0);

// A point of the undeformed model (object space, meters) that belongs to a part -> the world, with all that
// the pose does to it. A part with cages moves it as its finest cage does:
// - as the cell that holds the point: its tetrahedron there. Of several pieces that share a cube, the one
//   whose voxel is the nearest to the point. Between cubes, as the cell of a solid voxel that the point is
//   on; voxels that are not in memory are as in toRest();
// - in the middle of the solid, where no cell is, by interpolation: a point of the lattice there lies between
//   the two nodes that are next along each axis, in proportion to its way to them; the axes count by 1 over
//   the product of these two ways. Affine motions of the nodes remain affine;
// - elsewhere as the cell that is the nearest at rest, as if that went on: without a step within what is
//   nearest to one cell, with one between two.
// If such a part cannot be drawn, as its spline moves it. kMisuse: as partToWorld(), and for a point that is
// not finite.
Result<glm::vec3> toWorld(const Instance& instance, int part, const glm::vec3& rest);
// World -> the point of the undeformed model (object space, meters). nullopt if Pose::check() refuses the
// pose, if it is of another asset, if the point is above or below the spline of a sheared part, or in no
// section of a swept one. Where coils of a swept part overlap, a point of the world has several at rest: the
// one nearest to the center line.
// Of a part with cages: by a tetrahedron of its finest cage that holds the point and is not inverted. Of
// several, by one where the point lies in a solid voxel; voxels that are not in memory are as those of the
// finest level that is, and their bricks are requested. In the middle of the solid, where no cell is, what
// toWorld() takes there. Elsewhere by the nearest tetrahedron, as if that went on. nullopt also if all are
// inverted.
std::optional<glm::vec3> toRest(const Instance& instance, int part, const glm::vec3& world);
// A frame in the world for things attached to a point of the undeformed model (object space, meters). Its
// columns are the directions x, y and z and the origin. y points along the spline. x is the part's x: of a
// sheared part made perpendicular to the spline, of a swept one turned with its section. Of a part with cages
// y points where its tetrahedron takes the part's y, and x where it takes the part's x, made perpendicular;
// the origin is as toWorld() says. Orthonormal, and right-handed for mirrored instances too. kMisuse: as
// toWorld().
Result<glm::mat4> frameAt(const Instance& instance, int part, const glm::vec3& rest);

// Index of the first part of that name. kMisuse: there is none; the text lists the names that there are, and
// is valid as long as the asset.
Result<int> findPart(const Asset& asset, std::string_view name);
// Index of the first joint of that name in asset.pack().joints(). kMisuse: as findPart().
Result<int> findJoint(const Asset& asset, std::string_view name);
// Index of the first socket of that name; of one part, if `part` is given. kMisuse: there is none; the text
// lists the names that there are, and is valid as long as the asset.
Result<int> findSocket(const Asset& asset, std::string_view name, int part = -1);
// The frame of a socket in the world, to hang things on: as frameAt(), turned as the artist says. kMisuse:
// there is no such socket, or the pose is of another asset.
Result<glm::mat4> socketToWorld(const Instance& instance, int socket);

}  // namespace kelp::runtime
