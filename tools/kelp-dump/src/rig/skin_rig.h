// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "kelp/rig/rig.h"

namespace kelp::dump {

// The rig that divides a skin as the pack's parts do, from what INFO says of them.
struct SkinRig {
  std::optional<RigDescription> rig;
  std::string problem;  // why there is none although INFO speaks of a skin
};
// `parts`: how many the pack has. Safe for hostile input: parseRig accepts what printRig makes of the rig.
SkinRig skinRig(std::string_view info, std::size_t parts);

}  // namespace kelp::dump
