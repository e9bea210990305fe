// SPDX-License-Identifier: MIT
// Cages in a pose: where their nodes are, and what posedCage() has made of that. Only Pose::create()
// allocates.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
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
  // Made for this value and no other.
  bool isMade(std::uint32_t value) const {
    return stamp_.load(std::memory_order_acquire) == of(State::kMade, value);
  }
  // True: it is made. make() returns that.
  template <class Make>
  bool make(std::uint32_t value, const Make& make) {
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
  static std::uint64_t of(State state, std::uint32_t value) {
    return static_cast<std::uint64_t>(state) << 32 | value;
  }
  std::atomic<std::uint64_t> stamp_{0};
};

// A cage as a pose has it.
struct CageInPose {
  Once placed;       // nodes; of the finest cage only if they follow the spline: for PoseCages::rollOf()
  Once bounded;      // all below `leaves`; this and coarser nodes: for NodesInPose::placements
  Once grown;        // the tree, also for these
  glm::vec3* nodes;  // one float more may be read after the last
  Box* tree;         // 2 * leaves
  std::uint32_t node_count, cell_count, leaves;
  std::uint32_t inverted_count;
  Box inverted, bounds;
};

// A part's cages.
struct NodesInPose {
  std::span<CageInPose> cages;  // finest first; empty: the part has none
  const std::uint32_t* places;  // a copy of the finest one's: poses may outlive their asset
  int side;                     // of its cells
  bool written;                 // by the host
  Error failure;                // of the spline, if placing failed
  std::uint32_t placements;     // how often the finest nodes were placed
};

struct PoseCages {
  std::span<NodesInPose> parts;

  // Memory and layout for the parts' cages, if there are any. kOutOfMemory.
  static Result<void> create(std::span<const Part> parts, const Allocator& allocator, Pose& pose);
  // Null: the part does not exist, or has no cages.
  static NodesInPose* of(const Pose& pose, int part);
  // Brings the nodes of the finest cage to where the spline takes them, unless the host wrote them. False:
  // it takes no point anywhere (`failure`), and they are at rest.
  static bool place(const Pose& pose, int part);
  // On what the place of the finest nodes depends that a host writes without a call: bits of Motion::roll.
  static std::uint32_t rollOf(const Pose& pose, int part);
  // True if the pose has memory for these cages.
  static bool fits(const Pose& pose, std::span<const Part> parts);
  static bool alike(const Pose& a, const Pose& b);
  static void reset(Pose& pose);
  static void assign(const Pose& from, Pose& to);
  // To be called before the knots are blended. weight: of the part.
  static void blend(const Pose& to, int part, float weight, Pose& pose);
  // An error if a node that the host wrote is no finite number, or too far away.
  static Result<void> check(const Pose& pose, int part);
  static void clamp(Pose& pose, int part);
};

}  // namespace kelp::runtime
