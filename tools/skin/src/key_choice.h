// SPDX-License-Identifier: MIT
// Which sampled times of a motion get a key.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kelp::bake {

// Keys are inserted where the error is worst until it is small everywhere, then those that are not needed are
// taken out. error(i, a, b) is that at time i between keys at a and b; if a equals b, the value is the same
// all the time.
std::vector<std::size_t> chooseKeys(
    std::size_t count, double tolerance,
    const std::function<double(std::size_t, std::size_t, std::size_t)>& error);

// The multiple of a power of two nearest to the value; the power is at most `step`. Keys have no more digits
// than they need, and so take fewer bytes in a pack.
float roundedKey(double value, double step);

// How far time i is on the way from time a to time b; 0 if these are one.
double shareOf(const std::vector<float>& times, std::size_t i, std::size_t a, std::size_t b);

// The motion of a part within its pivot at all times.
struct RigidMotion {
  std::vector<glm::dquat> turns;  // neighbors have one sign
  std::vector<double> scales;
  std::vector<glm::dvec3> shifts;
};

RigidMotion motionAbout(const std::vector<glm::dmat4x3>& local, const glm::dvec3& pivot);

// The keys of a part; `tolerance` for all tracks together, `of_turns` of it for the rotations alone.
struct KeyChoice {
  std::vector<std::size_t> turns, scales, shifts;
  std::size_t size() const { return turns.size() + scales.size() + shifts.size(); }
};

KeyChoice chooseTracks(const RigidMotion& motion, const std::vector<float>& times,
                       const std::vector<glm::dvec3>& points, double tolerance, double of_turns);

}  // namespace kelp::bake
