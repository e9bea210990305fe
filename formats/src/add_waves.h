// SPDX-License-Identifier: MIT
// addWaves as four and as eight lanes compute it, which is the same.
#pragma once

#include "kelp/formats/lanes8.h"
#include "kelp/formats/model.h"

namespace kelp {

namespace four {
void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots);
}
#if defined(KELP_EIGHT_LANES)
namespace eight {
void addWaves(const WaveBlock& block, double seconds, float weight, std::span<Knot> knots);
}
#endif

}  // namespace kelp
