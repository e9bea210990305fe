// SPDX-License-Identifier: MIT
// Springs on the knots of an asset. Pushed by the player, a blow or the wind, they swing back. They work on
// top of any pose:
//
//   pose.reset();  addClip(asset, clip, seconds, 1, pose);       the pose without the spring
//   spring.step(frame_seconds);
//   spring.pushAway({&asset, &pose, to_world}, player, 0.4f);    a player who walks through
//   spring.addTo(pose);                                          the pose to draw
#pragma once

#include "kelp/runtime/instance.h"

namespace kelp::runtime {

struct SpringOptions {
  float frequency = 1.0f;  // of the undamped swing, in Hz; > 0
  // Damping ratio, >= 0. 0: swings for ever. 1: returns fastest without overshoot. More: returns slowly.
  float damping = 0.25f;
  // The farthest that pushes or wind move a knot, in heights of its part; > 0.
  float reach = 0.6f;
  // True: the first knot of a part is fixed, and the part bends like a beam: the farther from there, the
  // more. False: nothing is fixed, and all knots are pushed alike.
  bool rooted = true;
};

// The movement of a knot relative to its pose.
struct Swing {
  glm::vec3 offset{0};    // heights of the part
  glm::vec3 velocity{0};  // heights per second
};

// Each knot is a damped harmonic oscillator about its place in the pose or, in wind, about the place where
// the wind holds it. Keeps no pointer to its asset. Only create() allocates. Not thread-safe: use a spring on
// one thread at a time. Different springs may be used on different threads at the same time. Functions that
// return a Result return kMisuse, with nothing changed, for a part that does not exist, a pose or asset that
// does not fit, and numbers that are not finite. The state stays finite for any pushes and time steps.
class Spring {
 public:
  Spring() = default;  // of no part; fits no asset
  // A spring at rest, without wind. kMisuse for options out of range; kOutOfMemory.
  static Result<Spring> create(const Asset& asset, const SpringOptions& options = {},
                               const Allocator& allocator = {});
  Spring(Spring&&) noexcept = default;
  Spring& operator=(Spring&&) noexcept = default;

  int parts() const { return static_cast<int>(bodies_.size()); }
  // The state of the knots of a part. Empty for a part that does not exist.
  std::span<const Swing> knots(int part) const;
  void reset();  // to rest, without wind

  // A blow: adds `velocity` (heights of the part per second, in its axes) to the free end of the part, and
  // less to the other knots, in proportion to the bend of a beam under an even load. The velocity is cut so
  // that no knot swings farther than `reach` from where the wind holds it.
  Result<void> push(int part, const glm::vec3& velocity);
  // The same, with a velocity in world space (meters per second if the world is in meters). The instance says
  // how the part stands in the world.
  Result<void> pushInWorld(const Instance& instance, int part, const glm::vec3& velocity);
  // Wind from now on: the acceleration that it would give the free end if nothing held it (heights of the
  // part per second squared, in its axes). It leans the free end by acceleration / (2 pi frequency)^2, at
  // most `reach`. For gusts, set it each frame.
  Result<void> setWind(int part, const glm::vec3& acceleration);
  // The same, with an acceleration in world space.
  Result<void> setWindInWorld(const Instance& instance, int part, const glm::vec3& acceleration);
  // The player's body, a sphere in world space. Pushes the middle line of every part out of it, as a beam
  // bends under a load at the deepest contact, and stops knots that move towards it. instance.pose is the
  // pose without the spring; null means rest. The lowest quarter of a part yields only in part, and no knot
  // moves beyond `reach`. A radius of 0 or less has no effect. A part that hangs on another part's spline is
  // pushed where that spline puts it without this spring.
  Result<void> pushAway(const Instance& instance, const glm::vec3& center, float radius);

  // Advances the springs by `seconds` >= 0. The solution is exact for any step: two half steps equal one
  // whole.
  Result<void> step(float seconds);

  // Adds the offsets to the knots' positions, and the slopes of the curve through the offsets to their
  // tangents. The slope is 0 at a fixed root, and free ends have no curvature, so a rig of two knots bends
  // exactly like a beam that is loaded at its end. Then calls pose.clamp(), which changes nothing if
  // a sheared part was pushed sideways.
  Result<void> addTo(Pose& pose) const;

 private:
  struct Body {               // of a part
    std::uint32_t first = 0;  // the index of its first knot
    std::uint32_t knots = 0;
    float height = 0;     // voxels
    glm::vec3 middle{0};  // from the spline to the volume's middle line, voxels
    glm::vec3 lean{0};    // where the wind holds the free end, heights
  };
  Result<glm::vec3> fromWorld(const Instance& instance, int part, const glm::vec3& vector) const;
  bool fits(const Pose& pose) const;
  bool fits(const Asset& asset) const;
  float share(const Body& body, std::uint32_t knot) const;
  float energyOf(const Body& body, std::uint32_t knot) const;
  void limit(const Body& body, std::uint32_t knot, float energy_before);
  void addTo(const Body& body, std::span<Knot> knots) const;
  void pushAway(const Body& body, const Part& part, std::span<const Knot> pose, const glm::mat4& to_world,
                const glm::vec3& center, float radius);

  SpringOptions options_;
  float omega_ = 0;  // radians per second
  Buffer<Body> bodies_;
  Buffer<Swing> swings_;
  Buffer<float> at_;
};

}  // namespace kelp::runtime
