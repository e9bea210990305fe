// SPDX-License-Identifier: MIT
// Where and how large a model is in the object: its up axis, its unit.
#pragma once

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Units a file may be in; metres.
inline constexpr double kSmallestUnit = 1e-6, kLargestUnit = 1e6;

// Turns Settings::up to the object's +y and scales by Settings::unit: only matrices change, so voxels, rigs
// and clips stay in the file's own axes and units.
void placeInObject(SourceModel& model, const ImportSettings& settings);

}  // namespace kelp::bake
