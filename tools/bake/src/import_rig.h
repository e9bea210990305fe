// SPDX-License-Identifier: MIT
// Rigs that come from outside the model's own file, in the order in which they win: --rig FILE, a preset, STEM.rig.json beside the input.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "import_files.h"

namespace kelp::bake {

struct OuterRig {
  RigDescription rig;
  std::string origin;
};
std::optional<OuterRig> findOuterRig(const InputFiles& files, const Settings& settings);

// Gives a part of a file that brings no rig of its own the outer rig or the straight one, and a rig that names no axis that of the settings;
// BakeError (kUsage) if it names another one.
void giveRig(SourcePart& part, const std::optional<OuterRig>& outer, const Settings& settings);

// The input's name without folder and extension: the name of its main part.
std::string stemOf(const InputFiles& files);

}  // namespace kelp::bake
