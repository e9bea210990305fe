// SPDX-License-Identifier: MIT
#include "bound_knots.h"

#include <cstddef>

namespace kelp {
namespace {

// Above this, squares of coefficients near the end of float.
constexpr float kMostSquared = 1e15f;
// More than any rise that is summed up.
constexpr float kBeyondAnyRise = 1e30f;

// Two vectors behind a number: loaded four numbers at a time.
static_assert(sizeof(Knot) == 28 && offsetof(Knot, at) == 0 && offsetof(Knot, position) == 4 && offsetof(Knot, tangent) == 16);
constexpr std::ptrdiff_t kKnotFloats = 7;

constexpr Knot kStraight[2] = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};

bool mayBeSound(std::span<const Knot> knots) {
  return knots.size() >= 2 && knots.size() <= static_cast<std::size_t>(kMaxKnots) && knots.front().at == 0.0f && knots.back().at == 1.0f;
}

}  // namespace

namespace four {
using Floats = Lanes;
#include "bound_knots.inl"
}  // namespace four

#if defined(KELP_EIGHT_LANES)
KELP_EIGHT_LANES_BEGIN
namespace eight {
using Floats = Lanes8;
#include "bound_knots.inl"
}  // namespace eight
KELP_EIGHT_LANES_END
#endif

unsigned boundSoundKnots(const std::span<const Knot> (&rigs)[8], float margin, BoxLanes& boxes) {
#if defined(KELP_EIGHT_LANES)
  if (hasEightLanes()) return eight::boundSoundKnots(rigs, 0, margin, boxes);
#endif
  const unsigned low = four::boundSoundKnots(rigs, 0, margin, boxes);
  return low | four::boundSoundKnots(rigs, 4, margin, boxes) << 4;
}

}  // namespace kelp
