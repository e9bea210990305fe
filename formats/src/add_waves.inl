// SPDX-License-Identifier: MIT
// addWaves for eight lanes, or two times four. wave_sums.cpp includes it once for each; kelp/formats/lanes8.h.

// sin(2 pi x) for x within a quarter to both sides, by the polynomial of least error of that degree: 3.4e-9, and 2e-7 with the rounding of floats.
inline Floats8 quarterSine(const Floats8& x) {
  const Floats8 xx = x * x;
  return x * (6.28318501f + xx * (-41.3416557f + xx * (81.6010056f + xx * (-76.5497818f + xx * 39.536705f))));
}

// `waves`: the sines in one half, the cosines in the other; of each period.
template <int kPeriods>
inline void addSums(const Floats8& waves, std::span<const WaveSums> all, float* numbers) {
  const Floats8 w0 = waves.all<0>(), w1 = waves.all<1>(), w2 = waves.all<2>(), w3 = waves.all<3>();
  for (const WaveSums& sums : all) {
    Floats8 by = w0 * Floats8::load(sums.of[0].sine);
    if constexpr (kPeriods > 1) by = by + w1 * Floats8::load(sums.of[1].sine);
    if constexpr (kPeriods > 2) by = by + w2 * Floats8::load(sums.of[2].sine);
    if constexpr (kPeriods > 3) by = by + w3 * Floats8::load(sums.of[3].sine);
    (Lanes::load(numbers + sums.first) + (by.low() + by.high())).store(numbers + sums.first);
  }
}

void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots) {
  // From 2^51 on a double has no phase.
  const Lanes turns = std::abs(seconds * block.frequencies[0]) < 0x1p51 ? restOfTurns(seconds, block.frequencies) : Lanes(0.0f);
  // Within half a turn to both sides: sin(x) = sin(1/2 - x), cos(x) = sin(1/4 - |x|).
  const Lanes size = abs(turns);
  const Floats8 waves = weight * quarterSine(Floats8::of(copysign(min(size, 0.5f - size), turns), 0.25f - size));
  float* const numbers = reinterpret_cast<float*>(knots.data());
  switch (block.periods) {
    case 1: return addSums<1>(waves, block.sums, numbers);
    case 2: return addSums<2>(waves, block.sums, numbers);
    case 3: return addSums<3>(waves, block.sums, numbers);
    default: return addSums<4>(waves, block.sums, numbers);
  }
}
