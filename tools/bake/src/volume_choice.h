// SPDX-License-Identifier: MIT
// Which grids of a file become the part.
#pragma once

#include <optional>

#include "volume_file.h"

namespace kelp::bake {

struct VolumeChoice {
  std::size_t grid = 0;
  std::optional<std::size_t> color, heat;
  std::optional<std::size_t> attribute, palette;  // see volume_paint.h; both or neither
  bool color_named = false, heat_named = false;  // by the settings
};
// BakeError kUsage where the settings name what is not there, or name none of several that could be meant: it lists them.
VolumeChoice chooseGrids(const InputFiles& files, const std::vector<GridHeader>& grids, const Settings& settings);

// "'density' (float, fog volume, 1049275 active voxels in 111 x 222 x 112)".
std::string describeGrid(const GridHeader& grid);

}  // namespace kelp::bake
