// SPDX-License-Identifier: MIT
// Waves as four lanes add them up are those of the lanes that this processor has, to the last bit. tests/runtime compares them with the truth.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "add_waves.h"

namespace kelp {
namespace {

TEST(Waves, FourLanesAndEightComeToTheSameBits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (std::size_t n = 0; n < 2000; ++n) {
    std::vector<Knot> knots(2 + n % 7);
    for (Knot& knot : knots) knot = {unit(random), {unit(random), unit(random), unit(random)}, {unit(random), unit(random), unit(random)}};
    std::vector<WaveSums> sums(1 + n % 5);
    for (WaveSums& four : sums) {
      four.first = static_cast<std::uint32_t>(random() % (7 * knots.size() - 3));
      for (auto& period : four.of) {
        for (float& share : period.sine) share = unit(random);
        for (float& share : period.cosine) share = unit(random);
      }
    }
    WaveBlock block;
    block.periods = 1 + n % 4;
    for (std::size_t i = 0; i < block.periods; ++i) block.frequencies[i] = 1.0 / (1.0 + static_cast<double>(i));
    block.sums = sums;
    const double seconds = n % 50 == 0 ? 1e300 : 1e5 * static_cast<double>(unit(random));
    std::vector<Knot> others = knots;
    addWaves(block, seconds, 0.7f, knots);
    four::addWaves(block, seconds, 0.7f, others);
    ASSERT_EQ(std::memcmp(knots.data(), others.data(), knots.size() * sizeof(Knot)), 0) << n;
  }
}

}  // namespace
}  // namespace kelp
