// SPDX-License-Identifier: MIT
// boundSoundKnots for as many rigs as `Floats` has lanes. bound_knots.cpp includes it once for each kind of lanes; kelp/formats/lanes8.h.

// What the rigs have in one of their knots each. Position and tangent.
struct KnotLanes {
  Floats at, px, py, pz, tx, ty, tz;
  explicit KnotLanes(const float* const* knots) {
    Floats z;
    loadFours(knots, 0, at, px, py, pz);
    loadFours(knots, 3, z, tx, ty, tz);
  }
  void operator=(const KnotLanes& k) { at = k.at, px = k.px, py = k.py, pz = k.pz, tx = k.tx, ty = k.ty, tz = k.tz; }
};

// One coordinate of a segment each: S(t) = p0 + t (c + t (b + t a)).
struct CubicLanes {
  Floats p0, a, b, c;
  Floats p1, m1, rise, room;
};
inline CubicLanes cubicOf(Floats share, Floats p0, Floats m0, Floats p1, Floats m1) {
  CubicLanes s;
  s.p0 = p0, s.p1 = p1;
  s.rise = p1 - p0;
  s.c = share * m0, s.m1 = share * m1;
  const Floats both = s.c + s.m1;
  s.room = 3.0f * s.rise - both;
  s.a = both - (s.rise + s.rise);
  s.b = s.room - s.c;
  return s;
}
inline Floats sizeOf(const CubicLanes& s) { return (abs(s.a) + abs(s.b)) + (abs(s.c) + abs(s.p0)); }

struct RangeLanes {
  Floats low, high;
};
// Coordinates turn where the derivative 3a t^2 + 2b t + c vanishes. A place that is no turn, or lies outside and is moved to an end, is on the curve
// too, so none makes the box too large.
inline void addTurns(const CubicLanes& s, RangeLanes& range) {
  // The form that does not cancel. A division by zero ends at an end of the segment.
  const Floats qa = 3.0f * s.a, q = 0.0f - (s.b + copysign(sqrt(max(s.b * s.b - qa * s.c, 0.0f)), s.b));
  const Floats u = min(max(q / qa, 0.0f), 1.0f), v = min(max(s.c / q, 0.0f), 1.0f);
  const Floats at_u = s.p0 + u * (s.c + u * (s.b + u * s.a)), at_v = s.p0 + v * (s.c + v * (s.b + v * s.a));
  range.low = min(min(min(at_u, at_v), s.p1), range.low);
  range.high = max(max(max(at_u, at_v), s.p1), range.high);
}

// The roots are those of a quadratic whose coefficients differ by at most 8 roundings from the derivative's; the cubic that belongs to it
// is at most 2^-21 (3|a| + 2|b| + |c|) away from the given one, which counts twice. Evaluation here costs 8 roundings of the largest partial
// sum, and whoever evaluates the segment in float may be off by another 8. All of it is below 2^-18 (|a| + |b| + |c| + |d|).
inline void storeRange(const RangeLanes& range, Floats size, float margin, float* min, float* max) {
  // The constants: 2^-18 of the margin for its own rounding, and room for squares too small for float.
  const Floats slack = 0x1p-18f * size + ((1.0f + 0x1p-18f) * margin + 1e-15f);
  (range.low - slack).store(min);
  (range.high + slack).store(max);
}

// Of the rigs from `first` on.
unsigned boundSoundKnots(const std::span<const Knot> (&rigs)[8], int first, float margin, BoxLanes& boxes) {
  constexpr int kCount = Floats::kCount;
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
  const Floats end = Floats::load(ends);
  KnotLanes k0(knots);
  RangeLanes x{k0.px, k0.px}, y{k0.py, k0.py}, z{k0.pz, k0.pz};
  Floats size_x = 0.0f, size_y = 0.0f, size_z = 0.0f;
  Floats sum = 0.0f, least_rise = kBeyondAnyRise, least_room = kBeyondAnyRise;
  for (std::size_t i = 0; i < most; ++i) {
    for (int rig = 0; rig < kCount; ++rig) knots[rig] += knots[rig] < last[rig] ? kKnotFloats : 0;  // a rig that has no more stays at its last one
    const KnotLanes k1(knots);
    const Floats here(static_cast<float>(static_cast<int>(i)));  // < end: the rig has this segment
    const Floats share = k1.at - k0.at;
    const CubicLanes along_x = cubicOf(share, k0.px, k0.tx, k1.px, k1.tx);
    addTurns(along_x, x);
    const Floats at_x = selectLess(here, end, sizeOf(along_x), 0.0f);
    size_x = max(at_x, size_x);
    const CubicLanes along_z = cubicOf(share, k0.pz, k0.tz, k1.pz, k1.tz);
    addTurns(along_z, z);
    const Floats at_z = selectLess(here, end, sizeOf(along_z), 0.0f);
    size_z = max(at_z, size_z);
    // y does not turn, if slopes are not negative and add up to at most 3 times the rise (Fritsch and Carlson 1980).
    const CubicLanes along_y = cubicOf(share, k0.py, k0.ty, k1.py, k1.ty);
    y.high = max(k1.py, y.high);
    const Floats at_y = selectLess(here, end, sizeOf(along_y), 0.0f);
    size_y = max(at_y, size_y);
    least_rise = min(selectLess(here, end, min(share, along_y.rise), kBeyondAnyRise), least_rise);
    least_room = min(selectLess(here, end, min(min(along_y.c, along_y.m1), along_y.room), kBeyondAnyRise), least_room);
    sum = sum + (at_x + at_y + at_z);
    k0 = k1;
  }
  // Minima and maxima pass over what is not a number; sums do not.
  sound &= lessBits(sum, kMostSquared) & lessBits(0.0f, least_rise) & ~lessBits(least_room, 0.0f);
  storeRange(x, size_x, margin, boxes.min[0].of + first, boxes.max[0].of + first);
  storeRange(y, size_y, margin, boxes.min[1].of + first, boxes.max[1].of + first);
  storeRange(z, size_z, margin, boxes.min[2].of + first, boxes.max[2].of + first);
  return sound;
}
