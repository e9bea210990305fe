// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "kelp/formats/model.h"
#include "kelp/rig_json/rig_json.h"

namespace kelp::dump {

// The axis of its file, or node, along which a part was baked: its voxels are turned against the space that its pivot stands in. None if that is turned, too, or
// skewed.
std::optional<Axis> bakedAxis(const Part& part);

}  // namespace kelp::dump
