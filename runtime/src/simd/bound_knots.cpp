// SPDX-License-Identifier: MIT
#include "kelp/simd/bound_knots.h"

#include <cstddef>

namespace kelp::simd {
namespace {

// Above this, the square of a coefficient may overflow.
constexpr float kMostSquared = 1e15f;
// More than any rise that passes the test above.
constexpr float kBeyondAnyRise = 1e30f;

// A knot is loaded four floats at a time, from `at` and from position.z.
static_assert(sizeof(Knot) == 28 && offsetof(Knot, at) == 0 && offsetof(Knot, position) == 4 &&
              offsetof(Knot, tangent) == 16);
constexpr std::ptrdiff_t kKnotFloats = 7;

constexpr Knot kStraight[2] = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};

bool mayBeSound(std::span<const Knot> knots) {
  return knots.size() >= 2 && knots.size() <= static_cast<std::size_t>(kMaxKnots) &&
         knots.front().at == 0.0f && knots.back().at == 1.0f;
}

// One knot of each of four rigs: position and tangent.
struct KnotLanes {
  Lanes at, px, py, pz, tx, ty, tz;
  explicit KnotLanes(const float* const* knots) {
    Lanes z;
    loadFours(knots, 0, at, px, py, pz);
    loadFours(knots, 3, z, tx, ty, tz);
  }
};

// One coordinate of a segment of each rig: S(t) = p0 + t (c + t (b + t a)).
struct CubicLanes {
  Lanes p0, a, b, c;
  Lanes p1, m1, rise, room;
};
CubicLanes cubicOf(Lanes share, Lanes p0, Lanes m0, Lanes p1, Lanes m1) {
  CubicLanes s;
  s.p0 = p0, s.p1 = p1;
  s.rise = p1 - p0;
  s.c = share * m0, s.m1 = share * m1;
  const Lanes both = s.c + s.m1;
  s.room = 3.0f * s.rise - both;
  s.a = both - (s.rise + s.rise);
  s.b = s.room - s.c;
  return s;
}
Lanes sizeOf(const CubicLanes& s) { return (abs(s.a) + abs(s.b)) + (abs(s.c) + abs(s.p0)); }

struct RangeLanes {
  Lanes low, high;
};
// Extends the range by the turning points, where the derivative 3a t^2 + 2b t + c is zero. Roots outside [0,
// 1] are clamped. Every point evaluated here lies on the curve, so a wrong root never makes the box too
// large.
void addTurns(const CubicLanes& s, RangeLanes& range) {
  // The form of the quadratic formula without cancellation. A division by zero is clamped to an end.
  const Lanes qa = 3.0f * s.a, q = 0.0f - (s.b + copysign(sqrt(max(s.b * s.b - qa * s.c, 0.0f)), s.b));
  const Lanes u = min(max(q / qa, 0.0f), 1.0f), v = min(max(s.c / q, 0.0f), 1.0f);
  const Lanes at_u = s.p0 + u * (s.c + u * (s.b + u * s.a)), at_v = s.p0 + v * (s.c + v * (s.b + v * s.a));
  range.low = min(min(min(at_u, at_v), s.p1), range.low);
  range.high = max(max(max(at_u, at_v), s.p1), range.high);
}

// Widens the range by what rounding may cost. The computed roots are exact for a quadratic whose coefficients
// differ by at most 8 roundings from the derivative's. Its cubic differs from the given one by at most
// 2^-21 (3|a| + 2|b| + |c|), which counts twice. Evaluation adds 8 roundings of the largest partial sum here,
// and another 8 in code that evaluates the segment in float. The sum is below 2^-18 (|a| + |b| + |c| + |d|).
// The range is in units of `height`; what is stored is in voxels.
void storeRange(const RangeLanes& range, Lanes size, Lanes height, float margin, float* min, float* max) {
  // 2^-18 of the margin covers its own rounding; 1e-15 covers squares that underflow.
  const Lanes slack = height * (0x1p-18f * size + 1e-15f) + (1.0f + 0x1p-18f) * margin;
  (height * range.low - slack).store(min);
  (height * range.high + slack).store(max);
}

// boundKnots for the four rigs from `first` on. Bit i of the result belongs to rig first + i.
// One loop over the segments, so that a knot is loaded once: 60 lines.
unsigned boundFour(const std::span<const Knot> (&rigs)[8], const EightFloats& heights, int first,
                   float margin, EightBoxes& boxes) {
  constexpr int kCount = 4;
  unsigned sound = (1u << kCount) - 1;
  const float* knots[kCount];
  const float* last[kCount];
  float ends[kCount];
  std::size_t most = 0;  // segments
  for (int rig = 0; rig < kCount; ++rig) {
    std::span<const Knot> given = rigs[first + rig];
    if (!mayBeSound(given)) {
      sound &= ~(1u << rig);
      given = kStraight;
    }
    const std::size_t segments = given.size() - 1;
    knots[rig] = &given.data()->at;
    last[rig] = knots[rig] + kKnotFloats * static_cast<std::ptrdiff_t>(segments);
    ends[rig] = static_cast<float>(static_cast<int>(segments));
    most = segments > most ? segments : most;
  }
  const Lanes end = Lanes::load(ends);
  KnotLanes k0(knots);
  RangeLanes x{k0.px, k0.px}, y{k0.py, k0.py}, z{k0.pz, k0.pz};
  Lanes size_x = 0.0f, size_y = 0.0f, size_z = 0.0f;
  Lanes sum = 0.0f, least_rise = kBeyondAnyRise, least_room = kBeyondAnyRise;
  for (std::size_t i = 0; i < most; ++i) {
    // A rig with fewer segments stays at its last knot.
    for (int rig = 0; rig < kCount; ++rig) knots[rig] += knots[rig] < last[rig] ? kKnotFloats : 0;
    const KnotLanes k1(knots);
    const Lanes here(static_cast<float>(static_cast<int>(i)));  // < end: the rig has this segment
    const Lanes share = k1.at - k0.at;
    const CubicLanes along_x = cubicOf(share, k0.px, k0.tx, k1.px, k1.tx);
    addTurns(along_x, x);
    const Lanes at_x = selectLess(here, end, sizeOf(along_x), 0.0f);
    size_x = max(at_x, size_x);
    const CubicLanes along_z = cubicOf(share, k0.pz, k0.tz, k1.pz, k1.tz);
    addTurns(along_z, z);
    const Lanes at_z = selectLess(here, end, sizeOf(along_z), 0.0f);
    size_z = max(at_z, size_z);
    // y has no turning point if both slopes are not negative and their sum is at most 3 times the rise
    // (Fritsch and Carlson 1980).
    const CubicLanes along_y = cubicOf(share, k0.py, k0.ty, k1.py, k1.ty);
    y.high = max(k1.py, y.high);
    const Lanes at_y = selectLess(here, end, sizeOf(along_y), 0.0f);
    size_y = max(at_y, size_y);
    least_rise = min(selectLess(here, end, min(share, along_y.rise), kBeyondAnyRise), least_rise);
    least_room =
        min(selectLess(here, end, min(min(along_y.c, along_y.m1), along_y.room), kBeyondAnyRise), least_room);
    sum = sum + (at_x + at_y + at_z);
    k0 = k1;
  }
  // min() and max() ignore NaN; the sum does not.
  sound &= lessBits(sum, kMostSquared) & lessBits(0.0f, least_rise) & ~lessBits(least_room, 0.0f);
  const Lanes height = Lanes::load(heights.of + first);
  storeRange(x, size_x, height, margin, boxes.min[0].of + first, boxes.max[0].of + first);
  storeRange(y, size_y, height, margin, boxes.min[1].of + first, boxes.max[1].of + first);
  storeRange(z, size_z, height, margin, boxes.min[2].of + first, boxes.max[2].of + first);
  return sound;
}

}  // namespace

unsigned boundKnots(const std::span<const Knot> (&rigs)[8], const EightFloats& heights, float margin,
                    EightBoxes& boxes) {
  return boundFour(rigs, heights, 0, margin, boxes) | boundFour(rigs, heights, 4, margin, boxes) << 4;
}

Box boundKnots(std::span<const Knot> knots, const glm::ivec3& size) {
  const std::span<const Knot> rigs[8] = {knots, knots, knots, knots};
  const auto height = static_cast<float>(size.y);
  const EightFloats heights{{height, height, height, height}};
  EightBoxes boxes;
  if (!(boundFour(rigs, heights, 0, 0.0f, boxes) & 1)) return deformedBounds(knots, size);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = boxes.min[axis].of[0];
    box.max[axis] = boxes.max[axis].of[0];
  }
  // Every copy of the base spans [0, X] x [0, Z] from the spline.
  box.max += glm::vec3(static_cast<float>(size.x), 0.0f, static_cast<float>(size.z));
  return box;
}

}  // namespace kelp::simd
