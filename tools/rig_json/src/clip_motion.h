// SPDX-License-Identifier: MIT
// Numbers that a clip moves, as sums of sinusoids and of piecewise cubics in time, and bounds of them over spans of time.
//
// A clip may hold motions whose periods have no common multiple worth waiting for. They are put on separate clocks, and what is true for every
// combination of the clocks' readings is true at every time; for periods in no rational ratio the converse holds as well (Kronecker).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kelp/formats/raw_pack.h"

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
// Bounds over [u0, u1], by the Bezier hull: exact for constants and lines, and ever tighter for shorter spans.
Range rangeOf(const Cubic& cubic, double u0, double u1);

// a sin(2 pi t / period) + b cos(2 pi t / period)
struct Harmonic {
  double period = 1;
  double a = 0;
  double b = 0;
};

// Between two neighbouring key times (of any track in the sum): a cubic in seconds since `start`.
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
  // Bounds over all time; does not look at the correlation between terms of different periods.
  Range range() const;
};
// RigError where it has more than kMostPeriods.
inline constexpr std::size_t kMostPeriods = 1024;
Motion makeMotion(const RawClip& clip, std::uint32_t part, std::span<const Term> terms);

// Periods that share a common multiple, and that multiple.
struct Clock {
  double period = 1;
  std::vector<double> members;
  bool holds(double member) const;
};
// Puts each period on a clock. Ratios that are one of small integers to within the rounding of floats are taken as exactly that. Ends at the first clock beyond kMostClocks.
inline constexpr std::size_t kMostClocks = 64;
std::vector<Clock> makeClocks(std::span<const Motion* const> motions);
// Index of the first clock that holds the period, or clocks.size().
std::size_t clockOf(std::span<const Clock> clocks, double period);

// The share of a motion that one of the clocks drives.
class ClockedMotion {
 public:
  ClockedMotion(const Motion& motion, std::span<const Clock> clocks, std::size_t which);
  double at(double time) const;
  // Bounds over [t0, t1], which may not hold a cut in its inside.
  Range range(double t0, double t1) const;
  // Times where pieces meet, within the clock's period, 0 and the period included.
  const std::vector<double>& cuts() const { return cuts_; }

 private:
  const Piece* pieceAt(double time, double& local) const;

  struct Wave {
    double omega, amplitude, phase;  // amplitude sin(omega t + phase)
  };
  std::vector<Wave> waves_;
  std::vector<Piece> pieces_;
  double duration_ = 0;
  std::vector<double> cuts_;
};

}  // namespace kelp::rig
