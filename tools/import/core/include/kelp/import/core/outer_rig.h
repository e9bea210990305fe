// SPDX-License-Identifier: MIT
// Rigs from outside the model's own file. The first of these that exists counts: --rig FILE, --rig PRESET,
// STEM.rig.json beside the input.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The values of --rig that are no files: the presets, and kSkinRig.
std::vector<std::string> rigNames();

// For SourceModel::outer. ToolError kUsage for the rig of a whole file where nodes are parts.
std::optional<OuterRig> findOuterRig(const InputFiles& files, const ImportSettings& settings);

// Gives a part the outer rig, or the one that the outer file has for a part of its name; else a part without
// a rig of its own gets the straight one. A rig that names no axis gets that of the settings. ToolError
// kUsage if it names another axis than the settings.
void giveRig(SourcePart& part, const std::optional<OuterRig>& outer, const ImportSettings& settings);

// Names of parts, each one different: "arm", "arm.2".
class PartNames {
 public:
  std::string take(const std::string& wanted);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> suffix_;  // the last one tried
};

// The input's name without folder and extension: the name of its main part.
std::string stemOf(const InputFiles& files);

}  // namespace kelp::bake
