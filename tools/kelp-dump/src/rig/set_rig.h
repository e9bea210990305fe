// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "kelp/common/error.h"
#include "kelp/rig/rig.h"

namespace kelp::dump {

struct SetRigRequest {
  std::string path;
  std::string part;          // name or index; empty: the only one
  std::string rig;           // a file or a preset's name
  std::optional<Axis> axis;  // of a rig that names none; none: the one that kelp-bake would take
  std::string output;        // empty: the pack itself is replaced; "-": standard output
};

// `rig --set`: gives a part another rig, without baking. ToolError.
Exit setRig(const SetRigRequest& request);

}  // namespace kelp::dump
