// SPDX-License-Identifier: MIT
// The words in which hits are judged, the same for every method and every program.
//   owed      the curve enters the solid (the union of its voxels) shrunk by kMargin: a hit must be reported
//   possible  it enters the solid grown by kMargin: a hit may be reported
//   missed    owed, and no hit, or one more than a voxel behind the first owed one
//   false     a hit that is not possible, or more than a voxel before the first possible one
//   grazing   possible and not owed: either answer is right
#pragma once

#include <optional>

#include "reference/ground_truth.h"

namespace kelp::reference {

inline constexpr double kMargin = 0.01;  // voxels

// Where the hits of one ray may and must be, along the ray.
struct Truth {
  std::optional<double> possible;
  std::optional<double> owed;
  bool grazing() const { return possible && !owed; }
};

Truth truthOf(const Volume& volume, std::span<const Knot> knots, const glm::dvec3& o, const glm::dvec3& r,
              double s_max);

enum class Verdict { kRight, kMissed, kFalse };

// `s` along the ray; of a hit, or empty.
Verdict judge(const Truth& truth, std::optional<double> s);

}  // namespace kelp::reference
