// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <tuple>

#include "lanes.h"
#include "metadata.h"

namespace kelp {
namespace {

constexpr std::size_t kPeriods = std::size(WaveBlock{}.frequencies);

auto movedBy(const Wave& wave) { return std::tie(wave.part, wave.knot, wave.target); }

// Adds what the wave does to the term: amplitude sin(x + 2 pi phase).
void addWave(const Wave& wave, WaveTerm& term) {
  const double turns = double{wave.phase} - std::floor(double{wave.phase});
  const double angle = 2 * std::numbers::pi * turns;
  for (int axis = 0; axis < 3; ++axis) {
    term.sine[axis] += static_cast<float>(std::cos(angle) * double{wave.amplitude[axis]});
    term.cosine[axis] += static_cast<float>(std::sin(angle) * double{wave.amplitude[axis]});
  }
}

// The tables while they fill up. There are at most as many entries of each kind as there are waves.
struct Filling {
  Metadata& out;
  std::span<const std::uint32_t> first_knot;  // of each part
  std::size_t blocks = 0, sums = 0, terms = 0;

  // One block of waves, ordered by target and then by period.
  void addBlock(std::span<const Wave* const> waves) {
    WaveBlock block;
    std::size_t periods = 0;
    float period_of[kPeriods] = {};
    // Falling frequencies are rising periods.
    while (true) {
      float next = 0;
      for (const Wave* wave : waves) {
        if ((periods == 0 || wave->period > period_of[periods - 1]) && (next == 0 || wave->period < next)) next = wave->period;
      }
      if (next == 0) break;
      period_of[periods] = next;
      block.frequencies[periods++] = 1.0 / double{next};
    }
    const std::size_t first_sum = sums;
    for (std::size_t i = 0; i < waves.size();) {
      WaveSum sum{first_knot[waves[i]->part] + waves[i]->knot, waves[i]->target, {}};
      const std::size_t first_term = terms;
      const Wave& moved = *waves[i];
      while (i < waves.size() && movedBy(*waves[i]) == movedBy(moved)) {
        const float period = waves[i]->period;
        WaveTerm term;
        term.period = static_cast<std::uint32_t>(std::find(period_of, period_of + periods, period) - period_of);
        for (; i < waves.size() && waves[i]->period == period && movedBy(*waves[i]) == movedBy(moved); ++i) addWave(*waves[i], term);
        out.wave_terms[terms++] = term;
      }
      sum.terms = out.wave_terms.span().subspan(first_term, terms - first_term);
      out.wave_sums[sums++] = sum;
    }
    block.sums = out.wave_sums.span().subspan(first_sum, sums - first_sum);
    out.wave_blocks[blocks++] = block;
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
  float turns[kPeriods] = {};
  if (std::abs(seconds * block.frequencies[0]) < 0x1p51) {
    for (std::size_t i = 0; i < kPeriods; ++i) {
      const double all = seconds * block.frequencies[i];
      turns[i] = static_cast<float>(all - ((all + kRound) - kRound));
    }
  }
  // Within half a turn to both sides: sin(x) = sin(1/2 - x), cos(x) = sin(1/4 - |x|).
  const Lanes x = Lanes::load(turns), size = abs(x);
  float sine[4], cosine[4];
  (weight * quarterSine(copysign(min(size, 0.5f - size), x))).store(sine);
  (weight * quarterSine(0.25f - size)).store(cosine);
  for (const WaveSum& sum : block.sums) {
    Lanes moved = 0.0f;
    for (const WaveTerm& term : sum.terms) {
      moved = moved + (sine[term.period] * Lanes::load(term.sine) + cosine[term.period] * Lanes::load(term.cosine));
    }
    float by[4];
    moved.store(by);
    Knot& knot = knots[sum.knot];
    (sum.target == Target::kKnotOffset ? knot.position : knot.tangent) += glm::vec3(by[0], by[1], by[2]);
  }
}

Result<void> sumWaves(Metadata& out) {
  const std::size_t count = out.waves.size();
  Buffer<const Wave*> order(out.allocator);
  Buffer<std::uint32_t> first_knot(out.allocator);
  if (!out.wave_blocks.reset(count) || !out.wave_sums.reset(count) || !out.wave_terms.reset(count) || !order.reset(count) ||
      !first_knot.reset(out.parts.size())) {
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
      std::size_t periods = 0;
      auto to = from;
      for (float last = 0; to != end && (periods < kPeriods || (*to)->period == last); ++to) {
        if ((*to)->period != last) ++periods;
        last = (*to)->period;
      }
      // By the waves' own order last, so that sums of floats are the same everywhere.
      std::sort(from, to, [](const Wave* a, const Wave* b) {
        return std::tie(a->part, a->knot, a->target, a->period, a) < std::tie(b->part, b->knot, b->target, b->period, b);
      });
      filling.addBlock({from, to});
      from = to;
    }
    clip.wave_blocks = out.wave_blocks.span().subspan(first_block, filling.blocks - first_block);
  }
  return {};
}

}  // namespace kelp
