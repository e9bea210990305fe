// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <tuple>

#include "add_waves.h"
#include "metadata.h"

namespace kelp {
namespace {

constexpr std::size_t kPeriods = std::size(WaveBlock{}.frequencies);
constexpr std::uint32_t kLanes = std::size(WaveSums{}.of[0].sine);

// The tables while they fill up.
struct Filling {
  Metadata& out;
  std::span<const std::uint32_t> first_knot;  // of each part
  std::size_t blocks = 0, sums = 0;

  // One block of waves, ordered by what they move, of at most kPeriods rising periods.
  void addBlock(std::span<const Wave* const> waves, std::span<const float> period_of) {
    WaveBlock block;
    for (std::size_t i = 0; i < period_of.size(); ++i) block.frequencies[i] = 1.0 / double{period_of[i]};
    block.periods = period_of.size();

    const std::size_t first_sum = sums;
    const auto isSame = [](const Wave& a, const Wave& b) { return a.part == b.part && a.knot == b.knot && a.target == b.target; };
    // From the last number down: four that end with one that moves never reach beyond the knots, and overlap others only at the very first.
    std::uint32_t least = ~0u;  // the first number that has a sum
    for (std::size_t to = waves.size(), from = to; to > 0; to = from) {
      while (from > 0 && isSame(*waves[from - 1], *waves[to - 1])) --from;
      const auto moving = waves.subspan(from, to - from);
      const std::uint32_t knot = first_knot[moving[0]->part] + moving[0]->knot;
      const std::uint32_t vector = 7 * knot + (moving[0]->target == Target::kKnotTangent ? 4u : 1u);
      for (int axis = 2; axis >= 0; --axis) {
        if (std::all_of(moving.begin(), moving.end(), [axis](const Wave* wave) { return wave->amplitude[axis] == 0; })) continue;
        const std::uint32_t number = vector + static_cast<std::uint32_t>(axis);
        if (number < least) {
          least = number < kLanes ? 0 : number - (kLanes - 1);
          out.wave_sums[sums++] = {least, {}};
        }
        addSum(moving, axis, period_of, number - least, out.wave_sums[sums - 1]);
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
      to.of[period].sine[lane] += static_cast<float>(std::cos(phase) * double{wave->amplitude[axis]});
      to.of[period].cosine[lane] += static_cast<float>(std::sin(phase) * double{wave->amplitude[axis]});
    }
  }
};

// Adding and subtracting 1.5 * 2^52 rounds a double to a whole number.
constexpr double kRound = 0x1.8p52;

// Loaded in one; and the numbers of knots are counted through.
static_assert(sizeof(WaveSums{}.of[0]) == 8 * sizeof(float));
static_assert(sizeof(Knot) == 7 * sizeof(float) && offsetof(Knot, position) == sizeof(float) && offsetof(Knot, tangent) == 4 * sizeof(float));

}  // namespace

namespace four {
struct Floats8 {
  Lanes a, b;
  Floats8(float all) : a(all), b(all) {}
  Floats8(Lanes first, Lanes last) : a(first), b(last) {}
  static Floats8 of(Lanes first, Lanes last) { return {first, last}; }
  static Floats8 load(const float* eight) { return {Lanes::load(eight), Lanes::load(eight + 4)}; }
  Lanes low() const { return a; }
  Lanes high() const { return b; }
  template <int kLane>
  Floats8 all() const { return {a.all<kLane>(), b.all<kLane>()}; }
};
inline Floats8 operator+(const Floats8& x, const Floats8& y) { return {x.a + y.a, x.b + y.b}; }
inline Floats8 operator*(const Floats8& x, const Floats8& y) { return {x.a * y.a, x.b * y.b}; }
inline Lanes restOfTurns(double seconds, const double* frequencies) {
  const DoubleLanes low = seconds * DoubleLanes::load(frequencies), high = seconds * DoubleLanes::load(frequencies + 2);
  return rounded(low - ((low + kRound) - kRound), high - ((high + kRound) - kRound));
}
#include "add_waves.inl"
}  // namespace four

#if defined(KELP_EIGHT_LANES)
KELP_EIGHT_LANES_BEGIN
namespace eight {
using Floats8 = Lanes8;
inline Lanes restOfTurns(double seconds, const double* frequencies) {
  const DoubleLanes4 all = seconds * DoubleLanes4::load(frequencies);
  return rounded(all - ((all + kRound) - kRound));
}
#include "add_waves.inl"
}  // namespace eight
KELP_EIGHT_LANES_END
#endif

void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots) {
#if defined(KELP_EIGHT_LANES)
  if (hasEightLanes()) return eight::addWaves(block, seconds, weight, knots);
#endif
  four::addWaves(block, seconds, weight, knots);
}

Result<void> sumWaves(Metadata& out) {
  const std::size_t count = out.waves.size();
  Buffer<const Wave*> order(out.allocator);
  Buffer<std::uint32_t> first_knot(out.allocator);
  // Four sums begin only where a wave moves a number that has none, and hold what else it moves.
  if (!out.wave_blocks.reset(count) || !out.wave_sums.reset(count) || !order.reset(count) || !first_knot.reset(out.parts.size())) {
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
