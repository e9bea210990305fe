// SPDX-License-Identifier: MIT
#include "kelp/simd/clip_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <tuple>

#include "kelp/formats/pack.h"
#include "kelp/simd/lanes.h"
#include "kelp/simd/tangent_overrides.h"

namespace kelp::simd {
namespace {

constexpr std::size_t kPeriods = std::size(WaveBlock{}.frequencies);
constexpr std::uint32_t kLanes = std::size(WaveSums{}.of[0].sine);

// A wave moves its knot and up to three tangents.
constexpr std::size_t kMostMoves = 4;
static_assert(sizeof(Wave) + sizeof(WaveBlock) +
                  kMostMoves * (sizeof(WaveSums) + sizeof(Wave) + sizeof(void*)) <=
              kWaveMemory);
// addWaves counts through the knots as floats.
static_assert(sizeof(Knot) == 7 * sizeof(float) && offsetof(Knot, position) == sizeof(float) &&
              offsetof(Knot, tangent) == 4 * sizeof(float));

// sin(2 pi x) for |x| <= 1/4, by the minimax polynomial of this degree. Error 3.4e-9; 2e-7 with rounding to
// float.
Lanes quarterSine(Lanes x) {
  const Lanes xx = x * x;
  return x * (6.28318501f + xx * (-41.3416557f + xx * (81.6010056f + xx * (-76.5497818f + xx * 39.536705f))));
}

// seconds * frequency, less the nearest whole number: within half a turn of 0.
Lanes restOfTurns(double seconds, const double* frequencies) {
  constexpr double kRound = 0x1.8p52;  // adding and subtracting 1.5 * 2^52 rounds a double to a whole number
  const DoubleLanes low = seconds * DoubleLanes::load(frequencies),
                    high = seconds * DoubleLanes::load(frequencies + 2);
  return rounded(low - ((low + kRound) - kRound), high - ((high + kRound) - kRound));
}

// `sines` and `cosines`: one lane for each period.
template <int kPeriodCount>
void addSums(Lanes sines, Lanes cosines, std::span<const WaveSums> all, float* numbers) {
  const Lanes s0 = sines.all<0>(), s1 = sines.all<1>(), s2 = sines.all<2>(), s3 = sines.all<3>();
  const Lanes c0 = cosines.all<0>(), c1 = cosines.all<1>(), c2 = cosines.all<2>(), c3 = cosines.all<3>();
  for (const WaveSums& sums : all) {
    Lanes sine = s0 * Lanes::load(sums.of[0].sine), cosine = c0 * Lanes::load(sums.of[0].cosine);
    const auto add = [&](Lanes s, Lanes c, int period) {
      sine = sine + s * Lanes::load(sums.of[period].sine);
      cosine = cosine + c * Lanes::load(sums.of[period].cosine);
    };
    if constexpr (kPeriodCount > 1) add(s1, c1, 1);
    if constexpr (kPeriodCount > 2) add(s2, c2, 2);
    if constexpr (kPeriodCount > 3) add(s3, c3, 3);
    (Lanes::load(numbers + sums.first) + (sine + cosine)).store(numbers + sums.first);
  }
}

// Visits the waves of a clip, and the waves by which automatic tangents follow them (followOf).
template <class Visit>
void visitMoves(const Clip& clip, std::span<const Part> parts, const TangentOverrides& overrides,
                const Visit& visit) {
  for (const Wave& wave : clip.waves) {
    visit(wave);
    if (wave.target != Target::kKnotOffset) continue;
    const Part& part = parts[wave.part];
    const Follow follow = followOf(part.knots, wave.knot, overrides.following(part, wave.part));
    const float factors[] = {follow.before, follow.self, follow.after};
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (factors[i] == 0) continue;
      Wave tangent = wave;
      tangent.knot = wave.knot + i - 1;
      tangent.target = Target::kKnotTangent;
      tangent.amplitude *= factors[i];
      visit(tangent);
    }
  }
}

bool isSameVector(const Wave& a, const Wave& b) {
  return a.part == b.part && a.knot == b.knot && a.target == b.target;
}

}  // namespace

void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots) {
  // From 2^51 on, a double has no phase.
  const Lanes turns = std::abs(seconds * block.frequencies[0]) < 0x1p51
                          ? restOfTurns(seconds, block.frequencies)
                          : Lanes(0.0f);
  // Within half a turn of 0: sin(x) = sin(1/2 - x), cos(x) = sin(1/4 - |x|).
  const Lanes size = abs(turns);
  const Lanes sines = weight * quarterSine(copysign(min(size, 0.5f - size), turns));
  const Lanes cosines = weight * quarterSine(0.25f - size);
  float* const numbers = reinterpret_cast<float*>(knots.data());
  switch (block.periods) {
    case 1:
      return addSums<1>(sines, cosines, block.sums, numbers);
    case 2:
      return addSums<2>(sines, cosines, block.sums, numbers);
    case 3:
      return addSums<3>(sines, cosines, block.sums, numbers);
    default:
      return addSums<4>(sines, cosines, block.sums, numbers);
  }
}

// The tables while they are filled.
struct ClipTables::Filling {
  ClipTables& out;
  std::span<const std::uint32_t> first_knot;  // of each part
  std::size_t blocks = 0, sums = 0;

  // Adds one clip. Sorts the waves.
  void addClip(std::span<const Wave*> waves) {
    std::sort(waves.begin(), waves.end(), [](const Wave* a, const Wave* b) { return a->period < b->period; });
    for (auto from = waves.begin(); from != waves.end();) {
      float period_of[kPeriods] = {};
      std::size_t periods = 0;
      auto to = from;
      for (; to != waves.end(); ++to) {
        if (periods > 0 && (*to)->period == period_of[periods - 1]) continue;
        if (periods == kPeriods) break;
        period_of[periods++] = (*to)->period;
      }
      // The wave's own place decides last, so that the sums of floats are the same everywhere.
      std::sort(from, to, [](const Wave* a, const Wave* b) {
        return std::tie(a->part, a->knot, a->target, a) < std::tie(b->part, b->knot, b->target, b);
      });
      addBlock({from, to}, {period_of, periods});
      from = to;
    }
  }

  // `waves` are sorted by the vector that they move; `period_of` holds their periods, ascending.
  void addBlock(std::span<const Wave* const> waves, std::span<const float> period_of) {
    WaveBlock block;
    for (std::size_t i = 0; i < period_of.size(); ++i) block.frequencies[i] = 1.0 / double{period_of[i]};
    block.periods = period_of.size();

    const std::size_t first_sum = sums;
    // From the last number down: each group of four ends with a number that moves. So no group reaches beyond
    // the knots, and only the very first may overlap another.
    std::uint32_t least = ~0u;  // the first number that has a sum
    for (std::size_t to = waves.size(), from = to; to > 0; to = from) {
      while (from > 0 && isSameVector(*waves[from - 1], *waves[to - 1])) --from;
      const auto moving = waves.subspan(from, to - from);
      const std::uint32_t knot = first_knot[moving[0]->part] + moving[0]->knot;
      const std::uint32_t vector = 7 * knot + (moving[0]->target == Target::kKnotTangent ? 4u : 1u);
      for (int axis = 2; axis >= 0; --axis) {
        if (std::all_of(moving.begin(), moving.end(),
                        [axis](const Wave* wave) { return wave->amplitude[axis] == 0; }))
          continue;
        const std::uint32_t number = vector + static_cast<std::uint32_t>(axis);
        if (number < least) {
          least = number < kLanes ? 0 : number - (kLanes - 1);
          out.sums_[sums++] = {least, {}};
        }
        addSum(moving, axis, period_of, number - least, out.sums_[sums - 1]);
      }
    }
    block.sums = out.sums_.span().subspan(first_sum, sums - first_sum);
    out.blocks_[blocks++] = block;
  }

  // Adds one coordinate of waves that move the same vector: amplitude sin(x + 2 pi phase) as factors of
  // sin(x) and cos(x).
  static void addSum(std::span<const Wave* const> waves, int axis, std::span<const float> period_of,
                     std::size_t lane, WaveSums& to) {
    for (const Wave* wave : waves) {
      const auto period = static_cast<std::size_t>(
          std::find(period_of.begin(), period_of.end(), wave->period) - period_of.begin());
      const double phase = 2 * std::numbers::pi * (double{wave->phase} - std::floor(double{wave->phase}));
      to.of[period].sine[lane] += static_cast<float>(std::cos(phase) * double{wave->amplitude[axis]});
      to.of[period].cosine[lane] += static_cast<float>(std::sin(phase) * double{wave->amplitude[axis]});
    }
  }
};

ClipTables::ClipTables(const Allocator& allocator)
    : first_block_(allocator),
      blocks_(allocator),
      sums_(allocator),
      first_track_(allocator),
      follows_(allocator) {}

Result<void> ClipTables::prepare(std::span<const Part> parts, std::span<const Clip> clips) {
  TangentOverrides overrides;
  if (!TangentOverrides::make(parts.size(), blocks_.allocator(), overrides))
    return Error{ErrorCode::kOutOfMemory, "no memory for the clips"};
  std::size_t given = 0, count = 0, tracks = 0;
  for (const Clip& clip : clips) {
    given += clip.waves.size();
    tracks += clip.tracks.size();
    overrides.begin(clip);
    visitMoves(clip, parts, overrides, [&count](const Wave&) { ++count; });
    overrides.end(clip);
  }
  Buffer<Wave> moves(blocks_.allocator());
  Buffer<const Wave*> waves(blocks_.allocator());
  Buffer<std::uint32_t> first_knot(blocks_.allocator());
  // A block for each given wave, and four sums for each move, are always enough: each has at least one of its
  // own.
  if (!first_block_.reset(clips.size() + 1) || !blocks_.reset(given) || !sums_.reset(count) ||
      !first_track_.reset(clips.size() + 1) || !follows_.reset(tracks) || !moves.reset(count) ||
      !waves.reset(count) || !first_knot.reset(parts.size()))
    return Error{ErrorCode::kOutOfMemory, "no memory for the clips"};
  for (std::size_t i = 1; i < parts.size(); ++i)
    first_knot[i] = first_knot[i - 1] + static_cast<std::uint32_t>(parts[i - 1].knots.size());
  Filling filling{*this, first_knot.span()};
  std::size_t used = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const std::size_t first = used;
    overrides.begin(clips[i]);
    visitMoves(clips[i], parts, overrides, [&](const Wave& move) {
      moves[used] = move;
      waves[used] = &moves[used];
      ++used;
    });
    filling.addClip(waves.span().subspan(first, used - first));
    std::uint32_t track = first_track_[i];
    for (const Track& each : clips[i].tracks) {
      Follow& follow = follows_[track++];
      if (each.target == Target::kKnotOffset)
        follow =
            followOf(parts[each.part].knots, each.knot, overrides.following(parts[each.part], each.part));
    }
    first_track_[i + 1] = track;
    overrides.end(clips[i]);
    first_block_[i + 1] = static_cast<std::uint32_t>(filling.blocks);
  }
  return {};
}

std::span<const WaveBlock> ClipTables::waves(std::size_t clip) const {
  return blocks_.span().subspan(first_block_[clip], first_block_[clip + 1] - first_block_[clip]);
}

std::span<const Follow> ClipTables::follows(std::size_t clip) const {
  return follows_.span().subspan(first_track_[clip], first_track_[clip + 1] - first_track_[clip]);
}

}  // namespace kelp::simd
