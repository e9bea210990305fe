// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "kelp/formats/model.h"
#include "kelp/rig/rig.h"

namespace kelp::dump {

// The axis of the part's file (or node) along which it was baked, found from its voxels' rotation against its
// pivot. Nothing if the pivot is rotated too, or skewed.
std::optional<Axis> bakedAxis(const Part& part);

}  // namespace kelp::dump
