// SPDX-License-Identifier: MIT
// A pose: where the knots of every part are now, and the nodes of parts with cages. The host moves them
// itself, or adds clips.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "kelp/runtime/asset.h"

namespace kelp::runtime {

// Rotation, translation and scale of a part, in pivot space (kelp/formats/model.h). The identity at rest.
struct Motion {
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
  float roll = 0;  // radians: the turn of a swept part about its spline at the first knot, beside Part::roll

  bool operator==(const Motion&) const = default;
};

// How a section across a part's spline differs from rest. A width of 0 draws nothing there.
struct PartSection {
  glm::vec2 width{1};     // factors along the part's x and z, before it is turned
  float twist = 0;        // radians, about the spline, by the right hand
  float keep_volume = 0;  // 0 to 1: how far both widths are changed so that the volume stays; 1: wholly
};

struct PoseCages;

// Keeps no pointer to its asset. Only create() allocates; assign() copies without allocating. Const
// functions, and functions that take a const pose or an Instance, may run on any threads at once, while
// nothing changes the pose. Different poses may be used on different threads at the same time.
class Pose {
 public:
  Pose() = default;  // of no part; fits no asset
  // A pose at rest. kOutOfMemory.
  static Result<Pose> create(const Asset& asset, const Allocator& allocator = {});
  Pose(Pose&& other) noexcept { *this = std::move(other); }
  Pose& operator=(Pose&& other) noexcept;

  int parts() const { return static_cast<int>(parts_); }
  // True if the pose has as many parts, knots and nodes as the asset. Functions that take both check this.
  bool fits(const Asset& asset) const;
  // The knots of a part. Lengths are in heights of the part, as in rig files (kelp/formats/spline.h).
  // Empty for a part that does not exist.
  std::span<const Knot> knots(int part) const { return const_cast<Pose*>(this)->writableKnots(part); }
  // Moves a knot by `offset`, as a clip with that offset would: automatic tangents follow. Moving an end knot
  // along y stretches or squashes the part's volume between the ends (section 3.1 of the paper). kMisuse,
  // with nothing changed, for a part or knot that does not exist.
  Result<void> move(int part, int knot, const glm::vec3& offset);
  // Replaces the tangent of a knot. Moving this knot or a neighbor afterwards still adds to it if it is
  // automatic. kMisuse as move().
  Result<void> setTangent(int part, int knot, const glm::vec3& tangent);
  // Replaces the positions and tangents of all knots of a part as they are given; no tangent follows.
  // kMisuse, with nothing changed, if their number or an `at` differs from the part's.
  Result<void> setKnots(int part, std::span<const Knot> knots);
  // The motion of a part, to read and to change. Null for a part that does not exist.
  Motion* motion(int part) { return part >= 0 && part < parts() ? motionData() + part : nullptr; }
  const Motion* motion(int part) const { return const_cast<Pose*>(this)->motion(part); }

  // Where the nodes of a part's finest cage are, to read and to write, in part space: level-0 voxels (Cage,
  // kelp/formats/cage.h). The first call fills in where the part's spline, or the parts that the nodes
  // follow, take them; at rest, if these may not be drawn. From then on they are where you put them, and
  // nothing else moves them, until reset(). Each call tells the pose that nodes change: call it again before
  // each round of writing. The span stays valid as long as the pose lives. The nodes of coarser cages follow.
  // Empty for a part without cages.
  std::span<glm::vec3> nodes(int part);
  // The same to read; they go on following. Call it by std::as_const(pose).nodes(part).
  std::span<const glm::vec3> nodes(int part) const;

  // Moves the joints of a skin (asset.pack().joints()) as the host's own animation says: one matrix for each,
  // object at rest -> object now. If M is where your skeleton has a joint, joint space -> object, that is M *
  // inverse_bind. It may scale, shear, mirror and flatten. The joint's parts go there, with all that follows
  // them; their own motions and their parents' no longer count, until reset(). Nodes that you or a spring
  // wrote stay where they are: reset() first, as in each frame with clips. Copies; allocates nothing.
  // kMisuse, with nothing changed: the pose does not fit the asset, the number of matrices is not that of its
  // joints, or one is not affine, or has a number that is not finite; `offset` is the index of the joint.
  Result<void> setJoints(const Asset& asset, std::span<const glm::mat4> matrices);

  // Widens and turns a part's sections: at a knot of its section part (asset.pack().parts()[part].sections),
  // linear between knots. So taper, squash, bulges and twists. These are that part's knots, which clips move,
  // too: position x and z are widths - 1, tangent x is the twist, tangent z keep_volume. kMisuse, with
  // nothing changed: the part has no sections, there is no such knot, or a number is not finite.
  Result<void> setSection(int part, int knot, const PartSection& section);
  // The section now. Empty: there is no such knot.
  std::optional<PartSection> section(int part, int knot) const;

  // Sets the weight of the morph targets of that name: 0 at rest, 1: as in the file; it may be anything. A
  // clip adds to it. Each is an empty part of that name (Cage::morphs names it), and the weight the x of its
  // motion's translation, so motion() reads and writes it, too. kMisuse, with nothing changed: there is none,
  // the pose does not fit the asset, or the weight is not finite.
  Result<void> setMorph(const Asset& asset, std::string_view name, float weight);

  void reset();  // back to rest; no node and no joint is the host's any more
  // Copies `other`. kMisuse, with nothing changed, if its parts, knots or nodes differ in number.
  Result<void> assign(const Pose& other);
  // Moves the pose towards `to`: weight 0 changes nothing, weight 1 makes it `to`. Knots, translations and
  // scales are interpolated linearly, rotations spherically by the shorter way. Between two monotone poses
  // the result is monotone; between swept ones it may fold. Nodes that the host wrote to either pose, and
  // motions of parts that its joints moved, are interpolated linearly, and are the host's in this one.
  // part_weights: one factor of the weight for each
  // part, as a mask; empty: all 1. kMisuse, with nothing changed, if the poses differ in parts, knots or
  // nodes, or a weight is not within [0, 1].
  Result<void> blend(const Pose& to, float weight, std::span<const float> part_weights = {});
  // Checks the knots of every part (checkRig). kNotMonotone if the spline of a sheared part turns back along
  // its axis; kFolds if a swept part bends too sharply for its thickness; kMisuse for other broken rules;
  // `offset` is the index of the part. Of a part whose nodes the host wrote, the nodes are checked, not the
  // knots: kMisuse if one is no finite number, or farther away than 2^20 times the part's longest side. Parts
  // without voxels are checked too. An instance with such a pose is not drawn, and no ray hits it.
  Result<void> check() const;
  // Changes knots until every part passes check(); those that do stay as they are. Of a sheared part, only
  // the y of tangents and knots. A swept part moves, with its roll, on a straight line towards its
  // pose at rest, about as far as needed: the line is halved, to 1/4096 of it. A node that check() refuses
  // goes to its place at rest.
  void clamp();

 private:
  friend struct PoseWriter;
  friend struct PoseCages;
  static Result<Pose> create(std::span<const Part> parts, bool joints, const Allocator& allocator);
  bool sameShape(const Pose& other) const;
  bool hasKnot(int part, int knot) const;
  std::span<Knot> writableKnots(int part) {
    if (part < 0 || part >= parts()) return {};
    const std::uint32_t first = firstKnots()[part];
    return {knotData() + first, firstKnots()[part + 1] - first};
  }
  // One block of memory, because each frame reads thousands of poses: the index of the first knot of each
  // part and the end of the last one's, then motions and knots now, then motions and knots at rest, then
  // 64 bits a part: which tangents are automatic; then how each part bends.
  std::size_t firstKnotBytes() const { return (parts_ + 1) * sizeof(std::uint32_t); }
  std::size_t stateBytes() const { return parts_ * sizeof(Motion) + knots_ * sizeof(Knot); }
  std::uint32_t* firstKnots() { return reinterpret_cast<std::uint32_t*>(memory_.data()); }
  const std::uint32_t* firstKnots() const { return const_cast<Pose*>(this)->firstKnots(); }
  std::byte* state() { return memory_.data() + firstKnotBytes(); }
  Motion* motionData() { return reinterpret_cast<Motion*>(state()); }
  Knot* knotData() { return knot_data_; }
  std::byte* restState() { return state() + stateBytes(); }
  Motion* restMotions() { return reinterpret_cast<Motion*>(restState()); }
  Knot* restKnots() { return reinterpret_cast<Knot*>(restMotions() + parts_); }
  struct Shape {  // of a part
    glm::ivec3 size;
    Bend bend;
    float roll;  // at rest
  };
  Shape* shapes() {
    return reinterpret_cast<Shape*>(restState() + stateBytes() + sizeof(std::uint64_t) * parts_);
  }
  // Null: no part has cages.
  PoseCages* cages() const;
  void forgetNodes(int part);      // they may have moved
  void forgetFollowing(int part);  // unless the host wrote them
  void moved(int part) {
    if (!cages_.empty()) forgetFollowing(part);
  }
  Result<void> checkPart(int part) const;
  void clampShear(int part);
  void clampSweep(int part);
  std::byte* automaticTangents(int part) {
    return restState() + stateBytes() + sizeof(std::uint64_t) * static_cast<std::size_t>(part);
  }

  Buffer<std::byte> memory_;
  Buffer<std::byte> cages_;    // PoseCages, and all that it points to; empty if no part has cages
  Knot* knot_data_ = nullptr;  // in memory_
  std::uint32_t parts_ = 0;
  std::uint32_t knots_ = 0;
};

enum class Play : std::uint8_t { kLoop, kOnce };

// Adds `weight` times the clip at `seconds` to the pose. kMisuse, with nothing changed, if the clip does not
// exist, the pose does not fit the asset, or a number is not finite.
//
// Time: tracks repeat after the clip's duration, also for negative times. Each wave repeats after its own
// period and never ends. Add an offset to `seconds` to give an instance its own phase. Phases are reduced in
// double precision: after a hundred hours they are exact to a millionth of a turn. Played once, the clip
// holds its first moment before 0 and its last moment after its duration
// (asset.pack().clips()[clip].duration).
//
// Layers: add further clips. Crossfade: add one clip with weight 1 - w and the other with w; the knots are
// then exactly between the two poses. If motions rotate far, or you want a mask, make two poses and blend()
// them.
Result<void> addClip(const Asset& asset, int clip, double seconds, float weight, Pose& pose,
                     Play play = Play::kLoop);
// Index of the first clip of that name. kMisuse: there is none; the text lists the names that there are, and
// is valid as long as the asset.
Result<int> findClip(const Asset& asset, std::string_view name);

}  // namespace kelp::runtime
