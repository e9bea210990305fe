// SPDX-License-Identifier: MIT
// Cages in a pose: where their nodes are, and what posedCage() has made of that. Only Pose::create()
// allocates.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <thread>

#include "kelp/formats/geometry.h"
#include "kelp/runtime/pose.h"

namespace kelp::runtime {

// Tells if something was made of the pose as it is. The first thread that needs it makes it; others
// wait. Changes of the pose forget it.
class Once {
 public:
  enum class State : std::uint32_t { kAbsent, kInHand, kMade, kFailed };

  void forget() { stamp_.store(0, std::memory_order_relaxed); }
  // Made for this value and no other. Values have 62 bits.
  bool isMade(std::uint64_t value) const {
    return stamp_.load(std::memory_order_acquire) == of(State::kMade, value);
  }
  // True: it is made. make() returns that.
  template <class Make>
  bool make(std::uint64_t value, const Make& make) {
    while (true) {
      std::uint64_t now = stamp_.load(std::memory_order_acquire);
      if (now == of(State::kMade, value)) return true;
      if (now == of(State::kFailed, value)) return false;
      if (now == of(State::kInHand, 0)) {
        std::this_thread::yield();  // std::atomic::wait has a global table
        continue;
      }
      if (!stamp_.compare_exchange_weak(now, of(State::kInHand, 0), std::memory_order_acquire)) continue;
      const bool made = make();
      stamp_.store(of(made ? State::kMade : State::kFailed, value), std::memory_order_release);
      return made;
    }
  }

 private:
  static std::uint64_t of(State state, std::uint64_t value) {
    return value << 2 | static_cast<std::uint64_t>(state);
  }
  std::atomic<std::uint64_t> stamp_{0};
};

// Of a word of Cage::places, in sides.
inline glm::ivec3 latticePoint(std::uint32_t place) {
  return {place & 1023, place >> 10 & 1023, place >> 20};
}

// A cage as a pose has it.
struct CageInPose {
  Once placed;   // nodes; of the finest cage only if the host did not write them: for PoseCages::placedFor()
  Once bounded;  // all below `leaves`; this and coarser nodes: for PoseCages::madeFor()
  Once grown;    // the tree, also for that
  glm::vec3* nodes;  // one float more may be read after the last
  Box* tree;         // 2 * leaves
  std::uint32_t node_count, cell_count, leaves;
  std::uint32_t inverted_count;
  Box inverted, bounds;
};

// Of a knot of a section part.
inline PartSection sectionOf(const Knot& knot) {
  return {{1 + knot.position.x, 1 + knot.position.z}, knot.tangent.x, knot.tangent.z};
}

// A part's cages.
struct NodesInPose {
  std::span<CageInPose> cages;  // finest first; empty: the part has none
  const std::uint32_t* places;  // a copy of the finest one's: poses may outlive their asset
  int side;                     // of its cells
  int sections;                 // as Part::sections
  bool written;                 // by the host
  Error failure;                // if placing the finest nodes failed
  std::uint32_t placements;     // how often they were placed where the spline takes them
  // If nodes follow parts, of the finest cage: a copy; for each part of the asset, the box at rest of all
  // nodes that follow it, empty if none does, and where it takes them now, both in this part's space.
  std::span<const Influences> influences;
  std::span<const std::uint16_t> followed, slots;
  std::span<const Box> boxes;
  std::span<glm::mat4> maps;
  std::span<const Morph> morphs;  // of the finest cage: a copy
  bool bent;                      // one of these parts bends
  Box around;  // all nodes of the finest cage, unless one bends; empty if that is not finite

  bool followsParts() const { return !influences.empty() && !written; }
};

struct PoseCages {
  std::span<NodesInPose> parts;
  // If nodes follow parts, or the asset has joints; else empty. Of each part a copy, which has knots but no
  // name; its motion, object at rest -> object now; and where the host's joints take it, if they do.
  std::span<Part> rest;
  std::span<glm::mat4> motions;
  Once moved;  // motions and all `maps`: for stateOf()
  std::span<glm::mat4> driven;
  std::span<bool> is_driven;
  bool any_driven;

  // Memory and layout for the parts' cages and their joints, if there are any. kOutOfMemory.
  static Result<void> create(std::span<const Part> parts, bool joints, const Allocator& allocator,
                             Pose& pose);
  // Null: the part does not exist, or has no cages.
  static NodesInPose* of(const Pose& pose, int part);
  // Brings the nodes of the finest cage to where the spline or the parts that they follow take them, unless
  // the host wrote them. False: these take no point anywhere (`failure`), and they are at rest.
  static bool place(const Pose& pose, int part);
  // On what the place of the finest nodes depends that a host writes without a call.
  static std::uint64_t placedFor(const Pose& pose, int part);
  // The same of all that is made of the nodes.
  static std::uint64_t madeFor(const Pose& pose, int part);
  // A checksum of all knots and motions; of some knots.
  static std::uint64_t stateOf(const Pose& pose);
  static std::uint64_t sumOf(std::span<const Knot> knots);

  // followed_parts.cpp: only with `rest`.
  // Where the host's joints take a part; null: they do not.
  static const glm::mat4* drivenTo(const Pose& pose, int part);
  static void drive(Pose& pose, int part, const glm::mat4& to);  // forgetMotions() ends it
  static void release(Pose& pose);                               // from the host's joints
  static void forgetMotions(Pose& pose);
  // To be called before motions are blended. weights: one a part, or none: `weight` for all.
  static void blendDriven(const Pose& to, float weight, std::span<const float> weights, Pose& pose);
  // Of all parts.
  static std::span<const glm::mat4> motionsOf(const Pose& pose);
  // Puts the nodes of a cage where the parts that they follow take them. False: no finite place, or one that
  // is too far away, and they are at rest.
  struct Following {  // as in Cage
    std::span<const Influences> influences;
    std::span<const Morph> morphs;
    const std::uint32_t* places;
    int side;
  };
  static bool follow(const Pose& pose, int part, const Following& cage, glm::vec3* nodes);
  // A box around all nodes of the finest cage. Empty if it is not finite.
  static Box followedBounds(const Pose& pose, int part);
  static Box boundsOfMaps(const Pose& pose, int part);
  // True if the pose has memory for these cages.
  static bool fits(const Pose& pose, std::span<const Part> parts);
  static bool alike(const Pose& a, const Pose& b);
  static void reset(Pose& pose);
  static void assign(const Pose& from, Pose& to);
  // To be called before the knots are blended. weight: of the part.
  static void blend(const Pose& to, int part, float weight, Pose& pose);
  // An error if a node that the host wrote is no finite number, or too far away, or if parts take nodes
  // there.
  static Result<void> check(const Pose& pose, int part);
  // An error if a section of the part has a width or a twist that is no finite number, or far too large.
  static Result<void> checkSections(const Pose& pose, int part);
  // The first node that is no finite number, or too far away.
  static std::optional<std::size_t> badNode(const Pose& pose, int part, const glm::vec3* nodes,
                                            std::size_t count);
  static void clamp(Pose& pose, int part);
};

}  // namespace kelp::runtime
