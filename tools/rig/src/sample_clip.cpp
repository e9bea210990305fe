// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "clip_motion.h"
#include "kelp/formats/sweep.h"
#include "words.h"

namespace kelp::rig {
namespace {

constexpr double kPerPeriod = 64;  // moments of the shortest period, or of the clip if it has keys
// If the motions have no common period: how many of the longest are looked at.
constexpr double kPeriods = 16;
// The most work of a proof, in waves, for all moments: seconds. The arcs of one knot cost as much as
// kArcsOfKnot waves.
constexpr double kMostWork = 1 << 26, kArcsOfKnot = 256;

// The bounds of arcs may be wider than they by this, voxels.
constexpr float kSlack = 0.05f;

class ClipSampler {
 public:
  ClipSampler(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size)
      : clip_(clip), part_(part), rest_(rest), size_(size), moved_(clip, part, rest) {}

  ClipReport run() {
    for (const double moment : moments()) look(moment);
    const glm::vec3 size(size_);
    float beyond = kSlack;
    for (int axis = 0; axis < 3; ++axis)
      beyond = std::max({beyond, -report_.bounds.min[axis], report_.bounds.max[axis] - size[axis]});
    report_.leaves_box = (beyond - kSlack) / size.y;
    return report_;
  }

 private:
  std::vector<double> moments() const {
    std::vector<const Motion*> moving;
    for (const MovedKnots::OfKnot& knot : moved_.motions())
      for (const Motion& motion : knot)
        if (!motion.still()) moving.push_back(&motion);
    std::vector<double> all{0};
    if (moving.empty()) return all;

    double shortest = INFINITY, longest = 0, cost = kArcsOfKnot * static_cast<double>(rest_.knots.size());
    for (const Motion* motion : moving) {
      cost += static_cast<double>(motion->harmonics.size()) + 1;
      if (!motion->pieces.empty()) shortest = std::min(shortest, motion->duration);
      for (const Harmonic& h : motion->harmonics) shortest = std::min(shortest, h.period);
    }
    const std::vector<Clock> clocks = makeClocks(moving);
    for (const Clock& clock : clocks) longest = std::max(longest, clock.period);
    const double length = clocks.size() == 1 ? longest : kPeriods * longest;
    const double steps = std::ceil(kPerPeriod * length / shortest);
    const std::vector<double> keys = keyTimes(moving);
    const double repeats = std::ceil(length / static_cast<double>(clip_.duration));
    if (!((steps + repeats * static_cast<double>(keys.size())) * cost <= kMostWork))
      throw RigError(place() +
                     " would have to be looked at for too many moments; use fewer waves, and no periods that "
                     "are very short beside the others or the clip");

    for (double i = 1; i <= steps; ++i) all.push_back(i * length / steps);
    for (double i = 0; i < repeats; ++i)
      for (const double key : keys) all.push_back(i * static_cast<double>(clip_.duration) + key);
    std::sort(all.begin(), all.end());
    return all;
  }

  // The times of keys, halfway to the next, and just before the clip repeats.
  static std::vector<double> keyTimes(const std::vector<const Motion*>& moving) {
    std::vector<double> times;
    for (const Motion* motion : moving) {
      for (const Piece& piece : motion->pieces) {
        times.push_back(piece.start);
        times.push_back(0.5 * (piece.start + piece.end));
      }
      if (!motion->pieces.empty()) times.push_back(motion->duration * (1 - 1e-12));
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
  }

  void look(double moment) {
    const std::vector<Knot> knots = moved_.at(moment);
    const Result<void> made = makeArcs(knots, size_, rest_.roll, kArcTolerance, chain_);
    if (!made)
      throw RigError(
          place() + ": at " + printable(moment) + " s, " + placeOf(knots, made.error().offset) + ": " +
          made.error().detail + "; " +
          (made.error().code == ErrorCode::kFolds
               ? "a swept part may not fold: move it less there, or let it turn over a greater length"
               : "move it or the next in another way"));
    report_.bounds.add(chain_.bounds.min);
    report_.bounds.add(chain_.bounds.max);
  }

  std::string place() const { return "clip '" + printable(clip_.name) + "', part " + std::to_string(part_); }

  const RawClip& clip_;
  std::uint32_t part_;
  const RawRig& rest_;
  glm::ivec3 size_;
  MovedKnots moved_;
  ArcChain chain_;
  ClipReport report_;
};

}  // namespace

MovedKnots::MovedKnots(const RawClip& clip, std::uint32_t part, const RawRig& rest)
    : rest_(rest), motions_(rest.knots.size()) {
  const PartMotions moved(clip, part, rest);
  for (std::size_t knot = 0; knot < motions_.size(); ++knot) {
    for (int i = 0; i < 6; ++i) {
      const std::array<Term, 1> term{
          {{static_cast<std::uint32_t>(knot), i < 3 ? Target::kKnotOffset : Target::kKnotTangent, i % 3, 1}}};
      motions_[knot][static_cast<std::size_t>(i)] = moved.sum(term);
    }
  }
}

std::vector<Knot> MovedKnots::at(double time) const {
  std::vector<Knot> knots = rest_.knots;
  for (std::size_t knot = 0; knot < knots.size(); ++knot) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      knots[knot].position[axis] += static_cast<float>(motions_[knot][i].at(time));
      knots[knot].tangent[axis] += static_cast<float>(motions_[knot][i + 3].at(time));
    }
  }
  return knots;
}

ClipReport sampleClip(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size) {
  return ClipSampler(clip, part, rest, size).run();
}

}  // namespace kelp::rig
