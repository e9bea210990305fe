// SPDX-License-Identifier: MIT
// Which samples form a rigid part.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "moments.h"
#include "samples.h"

namespace kelp::bake {

// The joints that a part is for, where that is not the one in SkinLabels::joints alone. A part that has knots
// is swept along them; then each is below the one before.
struct SkinChain {
  std::vector<std::uint32_t> joints;
  std::size_t knots = 0;  // at least 3, or 0

  bool swept() const { return knots > 0; }
};

// A partition of the samples. Every part has at least one.
struct SkinLabels {
  std::vector<std::uint32_t> parts;   // of each sample
  std::vector<std::uint32_t> joints;  // of each part: the joint that it was made for
  std::vector<SkinChain> chains;      // of each part

  std::vector<std::vector<std::uint32_t>> members() const;
};

// Starts with the joint that moves each sample most, then improves the parts by Lloyd's iteration, then cuts
// parts in two while that pays: until there are twice as many parts as joints. `step` is told 0 to 1. The
// same result with any number of threads.
SkinLabels decompose(const SkinSamples& samples, const SkinMoments& moments, int threads,
                     const std::function<void(double)>& step);

}  // namespace kelp::bake
