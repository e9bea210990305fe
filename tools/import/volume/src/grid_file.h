// SPDX-License-Identifier: MIT
// A file of grids, whichever format it has.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"
#include "volume_grid.h"

namespace kelp::bake {

struct VolumeFile {
  std::string format;             // "OpenVDB", "NanoVDB"
  std::vector<GridHeader> grids;  // in the file's order
  // of kinds that can be read; makes the header that of what was read, for points that of their spheres. The
  // file's bytes stay until the last copy of it goes
  std::function<VolumeGrid(std::size_t grid, GridHeader& header)> load;
  std::vector<std::string> notices = {};  // of the reading
};

// By OpenVDB's and NanoVDB's own libraries. ToolError kInvalid for whatever is damaged, as far as that can be
// told; std::bad_alloc. The libraries believe what they read: hostile files can make them crash or take all
// memory, so programs call this in a process of its own.
VolumeFile readVdb(const InputFiles& files, const ImportSettings& settings);
VolumeFile readNanoVdb(const InputFiles& files);

// From the file to the model: which grid, solid or fog, on which lattice.
SourceModel importVolume(const InputFiles& files, const std::function<VolumeFile()>& read,
                         const ImportSettings& settings);

}  // namespace kelp::bake
