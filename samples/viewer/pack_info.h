// SPDX-License-Identifier: MIT
// What kelp-bake noted about itself in a pack.
#pragma once

#include <string_view>

#include "kelp/rig_json/rig_json.h"

namespace viewer {

// The axis of the source file that became the object's +y. +y where INFO does not say; it is not trusted to be JSON.
kelp::Axis upAxisOf(std::string_view info_json);

}  // namespace viewer
