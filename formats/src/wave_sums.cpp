// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <tuple>

#include "kelp/formats/lanes.h"
#include "metadata.h"

namespace kelp {
namespace {

constexpr std::size_t kPeriods = std::size(WaveBlock{}.frequencies);
constexpr std::size_t kLanes = std::size(WaveSums{}.number);

// The tables while they fill up.
struct Filling {
  Metadata& out;
  std::span<const std::uint32_t> first_knot;  // of each part
  std::size_t blocks = 0, sums = 0;

  // One block of waves, ordered by what they move, of at most kPeriods rising periods.
  void addBlock(std::span<const Wave* const> waves, std::span<const float> period_of) {
    WaveBlock block;
    for (std::size_t i = 0; i < period_of.size(); ++i) block.frequencies[i] = 1.0 / double{period_of[i]};

    const std::size_t first_sum = sums;
    std::size_t lane = kLanes;  // the next free one of the last sums
    const auto isSame = [](const Wave& a, const Wave& b) { return a.part == b.part && a.knot == b.knot && a.target == b.target; };
    for (std::size_t from = 0, to = 0; from < waves.size(); from = to) {
      while (to < waves.size() && isSame(*waves[from], *waves[to])) ++to;
      const std::uint32_t knot = first_knot[waves[from]->part] + waves[from]->knot;
      const std::uint32_t vector = 7 * knot + (waves[from]->target == Target::kKnotTangent ? 4u : 1u);
      for (int axis = 0; axis < 3; ++axis) {
        const auto moving = waves.subspan(from, to - from);
        if (std::all_of(moving.begin(), moving.end(), [axis](const Wave* wave) { return wave->amplitude[axis] == 0; })) continue;
        if (lane == kLanes) {
          // Lanes that stay free add nothing to what the first one moves.
          out.wave_sums[sums++] = {};
          std::fill_n(out.wave_sums[sums - 1].number, kLanes, vector + static_cast<std::uint32_t>(axis));
          lane = 0;
        }
        addSum(moving, axis, period_of, lane, out.wave_sums[sums - 1]);
        out.wave_sums[sums - 1].number[lane++] = vector + static_cast<std::uint32_t>(axis);
      }
    }
    block.sums = out.wave_sums.span().subspan(first_sum, sums - first_sum);
    out.wave_blocks[blocks++] = block;
  }

  // Waves that move the same vector: one of its numbers. amplitude sin(x + 2 pi phase) as shares of sin(x) and cos(x).
  static void addSum(std::span<const Wave* const> waves, int axis, std::span<const float> period_of, std::size_t lane, WaveSums& to) {
    for (const Wave* wave : waves) {
      const auto period = static_cast<std::size_t>(std::find(period_of.begin(), period_of.end(), wave->period) - period_of.begin());
      const double phase = 2 * std::numbers::pi * (double{wave->phase} - std::floor(double{wave->phase}));
      to.sine[period][lane] += static_cast<float>(std::cos(phase) * double{wave->amplitude[axis]});
      to.cosine[period][lane] += static_cast<float>(std::sin(phase) * double{wave->amplitude[axis]});
    }
  }
};

// sin(2 pi x) for x within a quarter to both sides, by the polynomial of least error of that degree: 3.4e-9, and 2e-7 with the rounding of floats.
Lanes quarterSine(const Lanes& x) {
  const Lanes xx = x * x;
  return x * (6.28318501f + xx * (-41.3416557f + xx * (81.6010056f + xx * (-76.5497818f + xx * 39.536705f))));
}

}  // namespace

void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots) {
  // What is left of whole turns: adding and subtracting 1.5 * 2^52 rounds to a whole number. From 2^51 on a double has no phase.
  constexpr double kRound = 0x1.8p52;
  Lanes turns = 0.0f;
  if (std::abs(seconds * block.frequencies[0]) < 0x1p51) {
    const auto rest = [&](std::size_t period) {
      const double all = seconds * block.frequencies[period];
      return static_cast<float>(all - ((all + kRound) - kRound));
    };
    turns = Lanes::of(rest(0), rest(1), rest(2), rest(3));
  }
  // Within half a turn to both sides: sin(x) = sin(1/2 - x), cos(x) = sin(1/4 - |x|).
  const Lanes size = abs(turns);
  const Lanes sine = weight * quarterSine(copysign(min(size, 0.5f - size), turns));
  const Lanes cosine = weight * quarterSine(0.25f - size);
  const Lanes s0 = sine.all<0>(), s1 = sine.all<1>(), s2 = sine.all<2>(), s3 = sine.all<3>();
  const Lanes c0 = cosine.all<0>(), c1 = cosine.all<1>(), c2 = cosine.all<2>(), c3 = cosine.all<3>();
  static_assert(sizeof(Knot) == 7 * sizeof(float) && offsetof(Knot, position) == sizeof(float) && offsetof(Knot, tangent) == 4 * sizeof(float));
  float* const numbers = reinterpret_cast<float*>(knots.data());
  for (const WaveSums& sums : block.sums) {
    const Lanes from_sines =
        (s0 * Lanes::load(sums.sine[0]) + s1 * Lanes::load(sums.sine[1])) + (s2 * Lanes::load(sums.sine[2]) + s3 * Lanes::load(sums.sine[3]));
    const Lanes from_cosines =
        (c0 * Lanes::load(sums.cosine[0]) + c1 * Lanes::load(sums.cosine[1])) + (c2 * Lanes::load(sums.cosine[2]) + c3 * Lanes::load(sums.cosine[3]));
    float by[kLanes];
    (from_sines + from_cosines).store(by);
    for (std::size_t i = 0; i < kLanes; ++i) numbers[sums.number[i]] += by[i];
  }
}

Result<void> sumWaves(Metadata& out) {
  const std::size_t count = out.waves.size();
  // A wave moves at most three numbers, and what is left of four lanes is wasted once a block: never more than one and a half sums a wave.
  const std::size_t most_sums = count + (count + 1) / 2;
  Buffer<const Wave*> order(out.allocator);
  Buffer<std::uint32_t> first_knot(out.allocator);
  if (!out.wave_blocks.reset(count) || !out.wave_sums.reset(most_sums) || !order.reset(count) || !first_knot.reset(out.parts.size())) {
    return Error{ErrorCode::kOutOfMemory, "no memory for the clips"};
  }
  for (std::size_t i = 0; i < count; ++i) order[i] = &out.waves[i];
  for (std::size_t i = 1; i < out.parts.size(); ++i) first_knot[i] = first_knot[i - 1] + static_cast<std::uint32_t>(out.parts[i - 1].knots.size());
  Filling filling{out, first_knot.span()};
  for (Clip& clip : out.clips) {
    const std::size_t first_block = filling.blocks;
    const auto begin = order.begin() + (clip.waves.data() - out.waves.data()), end = begin + static_cast<std::ptrdiff_t>(clip.waves.size());
    std::sort(begin, end, [](const Wave* a, const Wave* b) { return a->period < b->period; });
    for (auto from = begin; from != end;) {
      float period_of[kPeriods] = {};
      std::size_t periods = 0;
      auto to = from;
      for (; to != end; ++to) {
        if (periods > 0 && (*to)->period == period_of[periods - 1]) continue;
        if (periods == kPeriods) break;
        period_of[periods++] = (*to)->period;
      }
      // By the waves' own order last, so that sums of floats are the same everywhere.
      std::sort(from, to, [](const Wave* a, const Wave* b) {
        return std::tie(a->part, a->knot, a->target, a) < std::tie(b->part, b->knot, b->target, b);
      });
      filling.addBlock({from, to}, {period_of, periods});
      from = to;
    }
    clip.wave_blocks = out.wave_blocks.span().subspan(first_block, filling.blocks - first_block);
  }
  return {};
}

}  // namespace kelp
