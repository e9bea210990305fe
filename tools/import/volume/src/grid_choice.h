// SPDX-License-Identifier: MIT
// Chooses which grids of a file become the part.
#pragma once

#include <optional>

#include "grid_file.h"
#include "kelp/import/core/import_settings.h"

namespace kelp::bake {

struct VolumeChoice {
  std::size_t grid = 0;
  std::optional<std::size_t> color, heat;
  std::optional<std::size_t> attribute, palette;  // see solid.h; both or neither
  bool color_named = false, heat_named = false;   // named by the settings
  std::string notice;                             // names the grids that could have been meant as well
};
// ToolError kUsage if the settings name a grid that does not exist, or if nothing tells which of several is
// meant: the message lists them.
VolumeChoice chooseGrids(const InputFiles& files, const std::vector<GridHeader>& grids,
                         const ImportSettings& settings);

// ToolError kUnsupported if a grid cannot become voxels.
void requireVoxels(const InputFiles& files, const GridHeader& grid);

// "'density' (float, fog volume, 1049275 active voxels in 111 x 222 x 112)".
std::string describeGrid(const GridHeader& grid);
// The place of an error about a grid: "grid 'density' (...)"; "" for a raw volume.
std::string gridPlace(const GridHeader& grid);
// The subject of a notice: "grid 'density'"; "the volume" for a raw one.
std::string gridSubject(const GridHeader& grid);

}  // namespace kelp::bake
