// SPDX-License-Identifier: MIT
// What the numbers of a grid mean: where a solid is, or how dense fog is.
#pragma once

#include "grid_file.h"
#include "kelp/import/core/import_settings.h"

namespace kelp::bake {

struct VolumeRule {
  bool fog = false;
  bool below = true;  // solid where the value is at most iso; else at least
  double iso = 0;
  bool binary = false;  // values are 0 and 1: there is no field to take normals from

  bool solid(double value) const { return below ? value <= iso : value >= iso; }     // a NaN is not
  double distance(double value) const { return below ? value - iso : iso - value; }  // at most 0 in the solid
};

// From the grid's type and class, and from its values where these say nothing; `notices` gets what had to be
// guessed. ToolError kUsage for settings that do not go together, kInvalid for a background that would fill
// all space.
VolumeRule volumeRule(const InputFiles& files, const GridHeader& header, const VolumeGrid& grid,
                      const ImportSettings& settings, std::vector<std::string>& notices);

}  // namespace kelp::bake
