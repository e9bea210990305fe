// SPDX-License-Identifier: MIT
// Proof that the spline of a sheared part stays monotone while a clip moves it.
//
// A segment's slope Sy'(t) is a quadratic with the Bernstein coefficients d0 = m0, d1 = 3 (p1 - p0) - m0 -
// m1, d2 = m1 (p: heights of its knots, m: their tangents' y times the segment's share of the axis). It is
// non-negative on [0, 1] exactly if d0 >= 0, d2 >= 0 and d1 + sqrt(d0 d2) >= 0. All three are sums of
// sinusoids and cubics in time (clip_motion.h), so each is bounded over a span of time, and spans that bounds
// cannot decide are halved: branch and bound.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "clip_motion.h"
#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp {
namespace {

using rig::Clock;
using rig::ClockedMotion;
using rig::Motion;
using rig::PartMotions;
using rig::printable;
using rig::Range;
using rig::Term;

// Sy' may go this far below zero, in units of the segment's rise. isMonotone of formats/spline.h allows a
// fall of 1e-5 of the rise; a quadratic of mean 1 and minimum -s falls by at most 0.385 s^1.5, here 4.4e-6:
// so the proof holds there, with room for float rounding.
constexpr double kSlopeTolerance = 5e-4;
// A segment must keep this share of its natural length.
constexpr double kLeastRise = 1e-6;
constexpr std::size_t kMostSpans = 200000;
// waves looked at for all of a part's segments: seconds
constexpr std::size_t kMostWork = std::size_t{1} << 26;
constexpr double kShortestSpan = 1e-9;  // of a clock's period

// The quantities that decide about one segment: d0, d1, d2 (each plus the tolerance) and the rise.
enum Quantity { kD0, kD1, kD2, kRise, kQuantities };
constexpr std::array<Quantity, kQuantities> kAll{kD0, kD1, kD2, kRise};
struct Values {
  std::array<double, kQuantities> q{};
};

bool holds(const Values& v, double least_rise) {
  return v.q[kD0] >= 0 && v.q[kD2] >= 0 && v.q[kRise] >= least_rise &&
         v.q[kD1] + std::sqrt(v.q[kD0] * v.q[kD2]) >= 0;
}

// The readings of all clocks; while searching, a span of time for each.
struct Spans {
  std::vector<std::pair<double, double>> times;
};

class SegmentProof {
 public:
  // `work`: the rest of kMostWork.
  SegmentProof(const RawClip& clip, std::uint32_t part, const PartMotions& moved, std::span<const Knot> knots,
               std::size_t segment, std::size_t& work)
      : clip_(clip), part_(part), knots_(knots), segment_(segment), work_(work) {
    const Knot& k0 = knots[segment];
    const Knot& k1 = knots[segment + 1];
    const double share = static_cast<double>(k1.at) - static_cast<double>(k0.at);
    least_rise_ = kLeastRise * share;
    // Weights of p0, p1 and of the tangents' y in each quantity.
    const double e = kSlopeTolerance;
    const std::array<std::array<double, 4>, kQuantities> weights{
        {{-e, e, share, 0}, {-3 - e, 3 + e, -share, -share}, {-e, e, 0, share}, {-1, 1, 0, 0}}};
    const auto index = static_cast<std::uint32_t>(segment);
    for (const Quantity q : kAll) {
      const auto& w = weights[q];
      const std::array<Term, 4> terms{{{index, Target::kKnotOffset, 1, w[0]},
                                       {index + 1, Target::kKnotOffset, 1, w[1]},
                                       {index, Target::kKnotTangent, 1, w[2]},
                                       {index + 1, Target::kKnotTangent, 1, w[3]}}};
      rest_.q[q] = w[0] * static_cast<double>(k0.position.y) + w[1] * static_cast<double>(k1.position.y) +
                   w[2] * static_cast<double>(k0.tangent.y) + w[3] * static_cast<double>(k1.tangent.y);
      motions_[q] = moved.sum(terms);
    }
  }

  void run() {
    if (std::all_of(motions_.begin(), motions_.end(), [](const Motion& m) { return m.still(); })) {
      if (!holds(rest_, least_rise_)) refuse(rest_, "at rest");
      return;
    }
    std::array<const Motion*, kQuantities> all{};
    for (const Quantity q : kAll) all[q] = &motions_[q];
    clocks_ = rig::makeClocks(all);
    if (clocks_.size() > rig::kMostClocks)
      throw RigError(place() + " is moved along the axis by waves of more than " +
                     std::to_string(rig::kMostClocks) +
                     " periods that have no common multiple; give them periods that have, such as halves and "
                     "thirds of one");
    for (const Quantity q : kAll) clocked_[q] = rig::shareOut(motions_[q], clocks_);
    search();
  }

 private:
  // Spans between key times, for every combination of the clocks.
  std::vector<Spans> firstSpans() const {
    std::vector<Spans> spans(1);
    for (std::size_t c = 0; c < clocks_.size(); ++c) {
      std::vector<double> cuts;
      for (const Quantity q : kAll)
        cuts.insert(cuts.end(), clocked_[q][c].cuts().begin(), clocked_[q][c].cuts().end());
      std::sort(cuts.begin(), cuts.end());
      // Key times of different repetitions differ by rounding. A sliver between them is not a span of its
      // own.
      const double sliver = 1e-12 * clocks_[c].period;
      cuts.erase(std::unique(cuts.begin(), cuts.end(), [&](double a, double b) { return b - a <= sliver; }),
                 cuts.end());
      std::vector<Spans> product;
      for (const Spans& so_far : spans) {
        for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
          product.push_back(so_far);
          product.back().times.emplace_back(cuts[i], cuts[i + 1]);
        }
      }
      spans = std::move(product);
    }
    return spans;
  }

  void search() const {
    std::vector<Spans> open = firstSpans();
    std::reverse(open.begin(), open.end());  // earliest first
    std::size_t looked_at = 0, cost = 1;
    for (const Quantity q : kAll) {
      for (const ClockedMotion& share : clocked_[q]) cost += share.cost();
    }
    while (!open.empty()) {
      if (work_ < cost)
        throw RigError(place() +
                       " is moved by so many waves that proving it to stay monotone takes too long; use "
                       "fewer, or make their y part smaller");
      work_ -= cost;
      Spans spans = std::move(open.back());
      open.pop_back();
      Values low = rest_;
      std::size_t widest = 0;
      double most_doubt = -1;
      for (std::size_t c = 0; c < clocks_.size(); ++c) {
        double doubt = 0;
        for (const Quantity q : kAll) {
          const Range range = clocked_[q][c].range(spans.times[c].first, spans.times[c].second);
          low.q[q] += range.low;
          doubt += range.high - range.low;
        }
        if (doubt > most_doubt) {
          most_doubt = doubt;
          widest = c;
        }
      }
      if (holds(low, least_rise_)) continue;

      std::vector<double> middle;
      for (const auto& [from, to] : spans.times) middle.push_back(0.5 * (from + to));
      if (const Values there = at(middle); !holds(there, least_rise_)) refuse(there, when(middle));
      const auto [from, to] = spans.times[widest];
      if (++looked_at + open.size() > kMostSpans || to - from < kShortestSpan * clocks_[widest].period) {
        throw RigError(place() + " could not be proven to stay monotone near " + when(middle) +
                       ": it comes too close to turning back; make the y part of its waves and keys smaller");
      }
      Spans later = spans;
      spans.times[widest].second = later.times[widest].first = middle[widest];
      open.push_back(std::move(later));
      open.push_back(std::move(spans));
    }
  }

  Values at(const std::vector<double>& readings) const {
    Values v = rest_;
    for (const Quantity q : kAll) {
      for (std::size_t c = 0; c < clocks_.size(); ++c) v.q[q] += clocked_[q][c].at(readings[c]);
    }
    return v;
  }

  // A time at which the clocks have these readings, or come nearest to them. With several clocks: the best of
  // many turns of the first one.
  std::string when(const std::vector<double>& readings) const {
    constexpr int kTurns = 20000;
    for (int turn = 0; turn < kTurns; ++turn) {
      const double time = readings[0] + turn * clocks_[0].period;
      if (clocks_.size() == 1 || !holds(at(std::vector<double>(clocks_.size(), time)), least_rise_))
        return printable(time) + " s";
    }
    std::string text = "the moment when motions of periods";
    for (std::size_t c = 0; c < clocks_.size(); ++c)
      text += (c ? " and " : " ") + printable(clocks_[c].period) + " s";
    return text + " fall together";
  }

  std::string place() const {
    return "clip '" + printable(clip_.name) + "', part " + std::to_string(part_) +
           ": the segment from knot " + std::to_string(segment_) + " (at " + printable(knots_[segment_].at) +
           ") to knot " + std::to_string(segment_ + 1) + " (at " + printable(knots_[segment_ + 1].at) + ")";
  }

  [[noreturn]] void refuse(const Values& v, const std::string& time) const {
    const std::string k0 = std::to_string(segment_), k1 = std::to_string(segment_ + 1);
    std::string reason, remedy;
    if (v.q[kRise] < least_rise_) {
      reason = "knot " + k1 + " sinks to knot " + k0 + " or below";
      remedy = "make the part of their offsets along the axis smaller";
    } else if (v.q[kD0] < 0 || v.q[kD2] < 0) {
      const std::string& k = v.q[kD0] < 0 ? k0 : k1;
      reason = "the tangent of knot " + k + " points backwards";
      remedy = "make the part of its tangent along the axis larger than 0 at every time";
    } else {
      reason =
          "the tangents of knots " + k0 + " and " + k1 + " are too long for the distance between the knots";
      remedy = "make the part of these tangents along the axis smaller, or move the knots apart";
    }
    throw RigError(place() + " turns back along the axis " + (time == "at rest" ? time : "at " + time) +
                   ": " + reason + "; " + remedy);
  }

  const RawClip& clip_;
  std::uint32_t part_;
  std::span<const Knot> knots_;
  std::size_t segment_;
  std::size_t& work_;
  double least_rise_ = 0;
  Values rest_;
  std::array<Motion, kQuantities> motions_;
  std::vector<Clock> clocks_;
  std::array<std::vector<ClockedMotion>, kQuantities> clocked_;  // by quantity, then clock
};

// Bounds of one coordinate of a segment's four Bezier points over all time.
Range boundSegment(const PartMotions& moved, std::span<const Knot> knots, std::size_t segment, int axis) {
  const Knot& k0 = knots[segment];
  const Knot& k1 = knots[segment + 1];
  const double third = (static_cast<double>(k1.at) - static_cast<double>(k0.at)) / 3;
  const auto i0 = static_cast<std::uint32_t>(segment), i1 = i0 + 1;
  Range all{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const auto& [knot, index, reach] : {std::tuple(&k0, i0, 0.0), std::tuple(&k0, i0, third),
                                           std::tuple(&k1, i1, -third), std::tuple(&k1, i1, 0.0)}) {
    const std::array<Term, 2> terms{
        {{index, Target::kKnotOffset, axis, 1}, {index, Target::kKnotTangent, axis, reach}}};
    const double rest =
        static_cast<double>(knot->position[axis]) + reach * static_cast<double>(knot->tangent[axis]);
    const Range by = moved.sum(terms).range();
    all.low = std::min(all.low, rest + by.low);
    all.high = std::max(all.high, rest + by.high);
  }
  return all;
}

}  // namespace

ClipReport proveClip(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size) {
  if (rest.bend == Bend::kSweep) return rig::sampleClip(clip, part, rest, size);
  const std::span<const Knot> knots = rest.knots;
  const PartMotions moved(clip, part, rest);
  std::size_t work = kMostWork;
  for (std::size_t s = 0; s + 1 < knots.size(); ++s) SegmentProof(clip, part, moved, knots, s, work).run();

  ClipReport report;
  const double height = size.y, slack = 1e-5;  // for those who evaluate the clip in float
  double beyond = 0;
  for (std::size_t s = 0; s + 1 < knots.size(); ++s) {
    for (int axis = 0; axis < 3; ++axis) {
      const Range range = boundSegment(moved, knots, s, axis);
      // copies of the base span [0, X] x [0, Z] from the spline
      const double side = size[axis] / height, base = axis == 1 ? 0.0 : side;
      beyond = std::max({beyond, -range.low, range.high + base - side});
      report.bounds.min[axis] =
          std::min(report.bounds.min[axis], static_cast<float>(height * (range.low - slack)));
      report.bounds.max[axis] =
          std::max(report.bounds.max[axis], static_cast<float>(height * (range.high + base + slack)));
    }
  }
  report.leaves_box = static_cast<float>(beyond);
  return report;
}

}  // namespace kelp
