// SPDX-License-Identifier: MIT
// Notes of kelp-bake in a pack.
#pragma once

#include <string_view>

#include "kelp/rig/rig.h"

namespace kelp::view {

// The axis of the source file that became the object's +y; +y if INFO does not say. Safe for hostile text.
Axis upAxisOf(std::string_view info_json);

}  // namespace kelp::view
