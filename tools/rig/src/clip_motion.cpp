// SPDX-License-Identifier: MIT
#include "clip_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp::rig {
namespace {

constexpr double kTau = 2 * std::numbers::pi;
constexpr double kRatioTolerance = 2.5e-7;  // two roundings to float, and a little
constexpr int kLargestRatio = 1024;    // numerator times denominator of a ratio that counts as commensurate
constexpr double kMostSwings = 1024;   // of the shortest member within a clock's period
constexpr double kMostCuts = 1 << 15;  // keys times repetitions within a clock's period

bool samePeriod(double a, double b) { return std::abs(a - b) <= kRatioTolerance * b; }

// c(u + shift)
Cubic shifted(const Cubic& c, double shift) {
  return {c[0] + shift * (c[1] + shift * (c[2] + shift * c[3])), c[1] + shift * (2 * c[2] + shift * 3 * c[3]),
          c[2] + 3 * shift * c[3], c[3]};
}

// A track's channel at `time`, until the next key: a cubic in seconds since `time`.
Cubic trackCubic(const RawTrack& track, int axis, double time) {
  const auto& keys = track.keys;
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Key& key) {
    return t < static_cast<double>(key.time);
  });
  if (next == keys.begin()) return {keys.front().value[axis], 0, 0, 0};
  const Key& from = *(next - 1);
  if (next == keys.end() || track.interpolation == Interpolation::kStep) return {from.value[axis], 0, 0, 0};
  const double span = static_cast<double>(next->time) - static_cast<double>(from.time);
  const double v0 = from.value[axis], v1 = next->value[axis];
  Cubic cubic{v0, (v1 - v0) / span, 0, 0};
  if (track.interpolation == Interpolation::kCubic) {
    const double m0 = from.out[axis], m1 = next->in[axis];
    cubic = {v0, m0, (3 * (v1 - v0) / span - 2 * m0 - m1) / span,
             (m0 + m1 - 2 * (v1 - v0) / span) / (span * span)};
  }
  return shifted(cubic, time - static_cast<double>(from.time));
}

// The piece of a motion at `time`, which is `local` seconds after its start. Null if there are none.
const Piece* findPiece(const std::vector<Piece>& pieces, double duration, double time, double& local) {
  if (pieces.empty()) return nullptr;
  const double wrapped = time - duration * std::floor(time / duration);
  auto next = std::upper_bound(pieces.begin(), pieces.end(), wrapped,
                               [](double t, const Piece& piece) { return t < piece.start; });
  if (next != pieces.begin()) --next;
  local = std::clamp(wrapped - next->start, 0.0, next->end - next->start);
  return &*next;
}

double valueOf(const Cubic& c, double u) { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); }

void addHarmonic(std::vector<Harmonic>& harmonics, const Wave& wave, double amplitude) {
  const double phase = kTau * static_cast<double>(wave.phase);
  const double period = wave.period;
  auto same = std::find_if(harmonics.begin(), harmonics.end(),
                           [&](const Harmonic& h) { return samePeriod(h.period, period); });
  if (same == harmonics.end()) same = harmonics.insert(same, Harmonic{period, 0, 0});
  same->a += amplitude * std::cos(phase);
  same->b += amplitude * std::sin(phase);
}

// The fraction of small integers that `ratio` equals up to rounding, or {0, 0}.
struct Ratio {
  int numerator = 0, denominator = 0;
};
Ratio smallRatio(double ratio) {
  for (int denominator = 1; denominator <= kLargestRatio; ++denominator) {
    const double numerator = std::round(ratio * denominator);
    if (numerator * denominator > kLargestRatio) break;
    if (numerator >= 1 && std::abs(ratio * denominator - numerator) <= kRatioTolerance * numerator)
      return {static_cast<int>(numerator), denominator};
  }
  return {};
}

// Index of the first clock that holds the period, or clocks.size().
std::size_t clockOf(std::span<const Clock> clocks, double period) {
  std::size_t i = 0;
  while (i < clocks.size() && !clocks[i].holds(period)) ++i;
  return i;
}

}  // namespace

Range rangeOf(const Cubic& cubic, double u0, double u1) {
  const Cubic c = shifted(cubic, u0);
  const double w = u1 - u0, c1 = c[1] * w, c2 = c[2] * w * w, c3 = c[3] * w * w * w;
  const auto [low, high] =
      std::minmax({c[0], c[0] + c1 / 3, c[0] + 2 * c1 / 3 + c2 / 3, c[0] + c1 + c2 + c3});
  return {low, high};
}

Range Motion::range() const {
  Range range;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Range piece = rangeOf(pieces[i].cubic, 0, pieces[i].end - pieces[i].start);
    range.low = i == 0 ? piece.low : std::min(range.low, piece.low);
    range.high = i == 0 ? piece.high : std::max(range.high, piece.high);
  }
  for (const Harmonic& h : harmonics) {
    range.low -= std::hypot(h.a, h.b);
    range.high += std::hypot(h.a, h.b);
  }
  return range;
}

double Motion::at(double time) const {
  double value = 0, local = 0;
  for (const Harmonic& h : harmonics) {
    const double angle = kTau * time / h.period;
    value += h.a * std::sin(angle) + h.b * std::cos(angle);
  }
  if (const Piece* piece = findPiece(pieces, duration, time, local)) value += valueOf(piece->cubic, local);
  return value;
}

PartMotions::PartMotions(const RawClip& clip, std::uint32_t part, const RawRig& rest)
    : clip_(clip), part_(part), rest_(rest), following_(rest.automatic_tangents) {
  const auto overrides = [&](const auto& move) {
    if (move.part == part && move.target == Target::kKnotTangent)
      following_ &= ~(std::uint64_t{1} << move.knot);
  };
  for (const Wave& wave : clip.waves) overrides(wave);
  for (const RawTrack& track : clip.tracks) overrides(track);

  for (const Wave& wave : clip.waves)
    if (wave.part == part) knots_[wave.knot].waves.push_back(&wave);
  for (const RawTrack& track : clip.tracks) {
    if (track.part != part || track.keys.empty() || !movesKnot(track.target)) continue;
    std::vector<const RawTrack*>& same =
        knots_[track.knot].tracks[track.target == Target::kKnotTangent ? 1 : 0];
    same.push_back(&track);
    if (same.size() > kMostTracks)
      throw RigError("clip '" + printable(clip.name) + "', part " + std::to_string(part) + ": more than " +
                     std::to_string(kMostTracks) + " tracks move knot " + std::to_string(track.knot) +
                     "; merge them into one");
  }
}

const PartMotions::OfKnot* PartMotions::find(std::uint32_t knot) const {
  const auto found = knots_.find(knot);
  return found == knots_.end() ? nullptr : &found->second;
}

// The terms and, for tangents that follow, those of the offsets that they follow; each moved thing once.
std::vector<Term> PartMotions::followed(std::span<const Term> terms) const {
  std::vector<Term> all;
  const auto add = [&](const Term& term) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const Term& each) {
      return each.knot == term.knot && each.target == term.target && each.axis == term.axis;
    });
    if (same == all.end())
      all.push_back(term);
    else
      same->weight += term.weight;
  };
  const auto count = static_cast<std::uint32_t>(rest_.knots.size());
  for (const Term& term : terms) {
    add(term);
    if (term.target != Target::kKnotTangent) continue;
    const auto addOffset = [&](std::uint32_t knot, float Follow::*factor) {
      const Follow follow = followOf(rest_.knots, knot, following_);
      if (follow.*factor != 0)
        add({knot, Target::kKnotOffset, term.axis, term.weight * static_cast<double>(follow.*factor)});
    };
    if (term.knot > 0) addOffset(term.knot - 1, &Follow::after);
    addOffset(term.knot, &Follow::self);
    if (term.knot + 1 < count) addOffset(term.knot + 1, &Follow::before);
  }
  return all;
}

Motion PartMotions::sum(std::span<const Term> given) const {
  const std::vector<Term> terms = followed(given);
  Motion motion;
  motion.duration = clip_.duration;
  std::vector<std::pair<const RawTrack*, const Term*>> moved;
  std::vector<std::uint32_t> seen;
  for (const Term& term : terms) {
    const OfKnot* const knot = find(term.knot);
    if (!knot || term.weight == 0) continue;
    for (const RawTrack* const track : knot->tracks[term.target == Target::kKnotTangent ? 1 : 0])
      moved.emplace_back(track, &term);
    if (std::find(seen.begin(), seen.end(), term.knot) != seen.end()) continue;
    seen.push_back(term.knot);
    for (const Wave* const wave : knot->waves) {
      double amplitude = 0;
      for (const Term& each : terms) {
        if (wave->knot == each.knot && wave->target == each.target)
          amplitude += each.weight * static_cast<double>(wave->amplitude[each.axis]);
      }
      if (amplitude != 0) addHarmonic(motion.harmonics, *wave, amplitude);
      if (motion.harmonics.size() > kMostPeriods)
        throw RigError("clip '" + printable(clip_.name) + "', part " + std::to_string(part_) +
                       ": more than " + std::to_string(kMostPeriods) +
                       " periods move one segment; let waves share a period");
    }
  }
  if (moved.empty()) return motion;

  std::vector<double> cuts{0, motion.duration};
  for (const auto& [track, term] : moved) {
    for (const Key& key : track->keys) {
      if (key.time > 0 && static_cast<double>(key.time) < motion.duration) cuts.push_back(key.time);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    Piece piece{cuts[i], cuts[i + 1], {}};
    for (const auto& [track, term] : moved) {
      const Cubic cubic = trackCubic(*track, term->axis, cuts[i]);
      for (std::size_t k = 0; k < 4; ++k) piece.cubic[k] += term->weight * cubic[k];
    }
    motion.pieces.push_back(piece);
  }
  return motion;
}

bool Clock::holds(double member) const {
  return std::any_of(members.begin(), members.end(), [&](double m) { return samePeriod(m, member); });
}

std::vector<Clock> makeClocks(std::span<const Motion* const> motions) {
  std::vector<Clock> clocks;
  double track_period = 0;
  std::size_t cuts = 0;
  const auto add = [&](double period) {
    if (clockOf(clocks, period) < clocks.size()) return;
    for (Clock& clock : clocks) {
      const Ratio ratio = smallRatio(clock.period / period);
      if (ratio.numerator == 0) continue;
      const double common = clock.period * ratio.denominator;
      const double shortest = std::min(period, *std::min_element(clock.members.begin(), clock.members.end()));
      // A long common period would also repeat every key of the tracks.
      const double repeated_cuts =
          cuts > 0 && clock.holds(track_period) ? common / track_period * static_cast<double>(cuts) : 0;
      if (common > kMostSwings * shortest || repeated_cuts > kMostCuts) continue;
      clock.period = common;
      clock.members.push_back(period);
      return;
    }
    clocks.push_back({period, {period}});
  };
  for (const Motion* motion : motions) {
    if (motion->pieces.empty()) continue;
    track_period = motion->duration;
    cuts += motion->pieces.size();
    add(track_period);
  }
  for (const Motion* motion : motions) {
    for (const Harmonic& h : motion->harmonics) {
      if (clocks.size() > kMostClocks) return clocks;
      add(h.period);
    }
  }
  return clocks;
}

std::vector<ClockedMotion> shareOut(const Motion& motion, std::span<const Clock> clocks) {
  std::vector<ClockedMotion> shares(clocks.size());
  for (const Harmonic& h : motion.harmonics) {
    const std::size_t which = clockOf(clocks, h.period);
    // exactly whole, so that the clock's period fits the motion
    const double swings = std::round(clocks[which].period / h.period);
    shares[which].waves_.push_back(
        {kTau * swings / clocks[which].period, std::hypot(h.a, h.b), std::atan2(h.b, h.a)});
  }
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    shares[i].duration_ = motion.duration;
    shares[i].cuts_ = {0, clocks[i].period};
  }
  if (motion.pieces.empty()) return shares;
  const std::size_t which = clockOf(clocks, motion.duration);
  const double period = clocks[which].period;
  ClockedMotion& share = shares[which];
  share.pieces_ = motion.pieces;
  const auto repeats = static_cast<std::int64_t>(std::llround(period / motion.duration));
  share.duration_ = period / static_cast<double>(repeats);
  for (std::int64_t r = 0; r < repeats; ++r) {
    for (const Piece& piece : share.pieces_)
      share.cuts_.push_back(static_cast<double>(r) * share.duration_ + piece.start);
  }
  std::sort(share.cuts_.begin(), share.cuts_.end());
  share.cuts_.erase(std::unique(share.cuts_.begin(), share.cuts_.end()), share.cuts_.end());
  return shares;
}

const Piece* ClockedMotion::pieceAt(double time, double& local) const {
  return findPiece(pieces_, duration_, time, local);
}

double ClockedMotion::at(double time) const {
  double value = 0;
  for (const Wave& wave : waves_) value += wave.amplitude * std::sin(wave.omega * time + wave.phase);
  double local = 0;
  if (const Piece* piece = pieceAt(time, local)) value += valueOf(piece->cubic, local);
  return value;
}

Range ClockedMotion::range(double t0, double t1) const {
  Range range;
  for (const Wave& wave : waves_) {
    // A crest is at a quarter turn plus whole turns, a trough half a turn later. Without either the ends are
    // the extremes.
    const double from = wave.omega * t0 + wave.phase, to = wave.omega * t1 + wave.phase;
    const auto passes = [&](double angle) { return angle + kTau * std::ceil((from - angle) / kTau) <= to; };
    const auto [least, most] = std::minmax({std::sin(from), std::sin(to)});
    constexpr double kRounding = 1e-12;
    range.low += wave.amplitude * ((passes(-kTau / 4) ? -1.0 : least) - kRounding);
    range.high += wave.amplitude * ((passes(kTau / 4) ? 1.0 : most) + kRounding);
  }
  double middle = 0;
  if (const Piece* piece = pieceAt(0.5 * (t0 + t1), middle)) {
    const double half = 0.5 * (t1 - t0);
    const Range r = rangeOf(piece->cubic, middle - half, middle + half);
    range.low += r.low;
    range.high += r.high;
  }
  return range;
}

}  // namespace kelp::rig
