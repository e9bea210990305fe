// SPDX-License-Identifier: MIT
// Springs on the knots of an asset: pushed by the player, a blow or the wind, they swing back. On top of any pose.
//
//   pose.reset();  addClip(asset, clip, seconds, 1, pose);       the pose without the spring
//   spring.step(frame_seconds);
//   spring.pushAway({&asset, &pose, to_world}, player, 0.4f);    whoever walks through
//   spring.addTo(pose);                                          the pose to draw
#pragma once

#include "kelp/runtime/instance.h"

namespace kelp::runtime {

struct SpringSettings {
  float frequency = 1.0f;  // swings per second, if nothing damped them; > 0
  float damping = 0.25f;   // damping ratio: 0 swings for ever, 1 returns soonest without swinging past, more creeps back; >= 0
  float reach = 0.6f;      // how far pushes may carry a knot, and wind hold it, in heights of its part; > 0
  // A part stands on its first knot, which stays where it is, and bends like a beam: the more, the farther from there. False: nothing holds it,
  // and all its knots are pushed alike.
  bool rooted = true;
};

// What a knot does beside its pose.
struct Swing {
  glm::vec3 offset{0};    // voxels
  glm::vec3 velocity{0};  // voxels per second
};

// Each knot is a damped harmonic oscillator about its place in the pose or, in wind, about the place where the wind holds it. Only create()
// allocates. Independent of the asset once created, as a Pose. Not thread-safe; different springs may be used on different threads at the
// same time. Every function but create() answers kMisuse, with nothing changed, for a part that is not there, a pose or asset of another
// kind and numbers that are not finite; whatever the pushes and the time steps, the state stays finite.
class Spring {
 public:
  // At rest, in still air. kMisuse for settings out of their ranges, kOutOfMemory.
  static Result<Spring> create(const Asset& asset, const SpringSettings& settings = {}, const Allocator& allocator = {});
  Spring(Spring&&) noexcept = default;
  Spring& operator=(Spring&&) noexcept = default;

  int parts() const { return static_cast<int>(bodies_.size()); }
  // The state of a part's knots; empty for a part that is not there.
  std::span<const Swing> knots(int part) const;
  void reset();  // at rest, in still air

  // A blow: changes the velocity of the part's free end by `velocity` (voxels per second, part space) and that of the other knots as much less as a
  // beam under an even load bends less there. A vector v of the world is inverse(mat3(partToWorld(instance, part))) * v in part space.
  // The swing that follows carries no knot farther than `reach` from where the wind holds it: what is too much is taken off.
  Result<void> push(int part, const glm::vec3& velocity);
  // Wind, from now on: what it would accelerate the free end by if nothing held it (voxels per second squared, part space). It leans the free end by
  // acceleration / (2 pi frequency)^2, at most `reach`. Set it each frame for gusts.
  Result<void> setWind(int part, const glm::vec3& acceleration);
  // The player's body: pushes the middle line of every part out of a sphere (world space), as a beam bends under a load where they touch deepest,
  // and stops what moves towards it. instance.pose is the pose without the spring, null for rest. What is nearer to the root than a quarter of
  // the height gives way less than all, and nothing beyond `reach`. A radius of 0 or less touches nothing.
  Result<void> pushAway(const Instance& instance, const glm::vec3& center, float radius);

  // Goes on by `seconds` >= 0. The solution is exact, whatever the step: two half steps are one whole.
  Result<void> step(float seconds);

  // Adds the offsets to the knots' positions, and to their tangents the slopes of the curve through the offsets: none at the root, without
  // curvature at free ends, so that a rig of two knots bends exactly as a beam loaded at its end. Then pose.clampMonotone(), which has nothing
  // to do where a monotone pose is pushed sideways.
  Result<void> addTo(Pose& pose) const;

 private:
  struct Body {             // of a part
    std::uint32_t first = 0;  // of its knots
    std::uint32_t knots = 0;
    float height = 0;         // voxels
    glm::vec3 middle{0};      // from the spline to the volume's middle line
    glm::vec3 lean{0};        // where the wind holds the free end
  };
  Spring() = default;
  bool fits(const Pose& pose) const;
  bool fits(const Asset& asset) const;
  float share(const Body& body, std::uint32_t knot) const;
  float energyOf(const Body& body, std::uint32_t knot) const;
  void limit(const Body& body, std::uint32_t knot, float energy_before);
  void addTo(const Body& body, std::span<Knot> knots) const;
  void pushAway(const Body& body, const Part& part, std::span<const Knot> pose, const glm::mat4& to_world, const glm::vec3& center, float radius);

  SpringSettings settings_;
  float omega_ = 0;  // radians per second
  Buffer<Body> bodies_;
  Buffer<Swing> swings_;
  Buffer<float> at_;
};

}  // namespace kelp::runtime
