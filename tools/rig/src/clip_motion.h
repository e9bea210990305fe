// SPDX-License-Identifier: MIT
// Numbers that a clip moves, as sums of sinusoids and piecewise cubics in time, with bounds over spans of
// time.
//
// A clip may hold motions whose periods have no useful common multiple. They are put on separate clocks. What
// is true for every combination of the clocks' readings is true at every time. For periods in no rational
// ratio the converse holds too (Kronecker).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "kelp/formats/raw_pack.h"
#include "kelp/rig/rig.h"

namespace kelp::rig {

struct Range {
  double low = 0;
  double high = 0;
};

// One of the six numbers that a clip can change in a knot, with the weight it has in a sum.
struct Term {
  std::uint32_t knot = 0;
  Target target = Target::kKnotOffset;
  int axis = 1;
  double weight = 1;
};

// c[0] + c[1] u + c[2] u^2 + c[3] u^3
using Cubic = std::array<double, 4>;
// Bounds over [u0, u1] by the Bezier hull: exact for constants and lines, tighter for shorter spans.
Range rangeOf(const Cubic& cubic, double u0, double u1);

// a sin(2 pi t / period) + b cos(2 pi t / period)
struct Harmonic {
  double period = 1;
  double a = 0;
  double b = 0;
};

// Between two neighboring key times (of any track in the sum): a cubic in seconds since `start`.
struct Piece {
  double start = 0;
  double end = 0;
  Cubic cubic{};
};

// A weighted sum of what a clip adds to knots of one part, at any time.
struct Motion {
  std::vector<Harmonic> harmonics;  // one for each period
  std::vector<Piece> pieces;        // cover [0, duration] without gaps; empty if no track moves it
  double duration = 0;              // after which the pieces repeat

  bool still() const { return harmonics.empty() && pieces.empty(); }
  double at(double time) const;
  // Bounds over all time. Ignores the correlation between terms of different periods.
  Range range() const;
};
// More than these are a RigError. Tracks: of the same knot and target.
inline constexpr std::size_t kMostPeriods = 1024;
inline constexpr std::size_t kMostTracks = 64;

// The waves and tracks of a clip that move the knots of a part, by knot. The clip must outlive it.
class PartMotions {
 public:
  PartMotions(const RawClip& clip, std::uint32_t part, const RawRig& rest);
  // The terms may name tangents that follow automatically.
  Motion sum(std::span<const Term> terms) const;

 private:
  struct OfKnot {
    std::vector<const Wave*> waves;
    std::array<std::vector<const RawTrack*>, 2> tracks;  // offsets, tangents
  };
  const OfKnot* find(std::uint32_t knot) const;
  std::vector<Term> followed(std::span<const Term> terms) const;

  const RawClip& clip_;
  std::uint32_t part_;
  const RawRig& rest_;
  std::uint64_t following_ = 0;  // bit i: the tangent of knot i follows
  std::unordered_map<std::uint32_t, OfKnot> knots_;
};

// All knots of a part while a clip moves them.
class MovedKnots {
 public:
  // The offsets that the clip adds to a knot: x, y, z of its position, then of its tangent.
  using OfKnot = std::array<Motion, 6>;

  MovedKnots(const RawClip& clip, std::uint32_t part, const RawRig& rest);
  std::vector<Knot> at(double time) const;
  std::span<const OfKnot> motions() const { return motions_; }

 private:
  const RawRig& rest_;
  std::vector<OfKnot> motions_;
};

// Periods with a common multiple, and that multiple.
struct Clock {
  double period = 1;
  std::vector<double> members;
  bool holds(double member) const;
};
// Puts each period on a clock. A ratio that equals one of small integers up to the rounding of floats is
// taken as exactly that. Stops at the first clock beyond kMostClocks.
inline constexpr std::size_t kMostClocks = 64;
std::vector<Clock> makeClocks(std::span<const Motion* const> motions);
// Splits a motion into the shares of each clock.
class ClockedMotion;
std::vector<ClockedMotion> shareOut(const Motion& motion, std::span<const Clock> clocks);

class ClockedMotion {
 public:
  double at(double time) const;
  // Bounds over [t0, t1], which must not have a cut inside.
  Range range(double t0, double t1) const;
  // Times within the clock's period where pieces meet, with 0 and the period.
  const std::vector<double>& cuts() const { return cuts_; }
  // The time that at() and range() take, in waves.
  std::size_t cost() const { return waves_.size() + (pieces_.empty() ? 0 : 1); }

 private:
  friend std::vector<ClockedMotion> shareOut(const Motion& motion, std::span<const Clock> clocks);
  const Piece* pieceAt(double time, double& local) const;

  struct Wave {
    double omega, amplitude, phase;  // amplitude sin(omega t + phase)
  };
  std::vector<Wave> waves_;
  std::vector<Piece> pieces_;
  double duration_ = 0;
  std::vector<double> cuts_;
};

// proveClip() of a swept part.
ClipReport sampleClip(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size);

}  // namespace kelp::rig
