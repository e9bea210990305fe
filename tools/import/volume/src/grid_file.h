// SPDX-License-Identifier: MIT
// A file of sparse grids, whichever format it has.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kelp/import/core/import_settings.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"
#include "sparse_grid.h"

namespace kelp::bake {

struct VolumeFile {
  std::string format;             // "OpenVDB", "NanoVDB"
  std::vector<GridHeader> grids;  // in the file's order
  // of kinds that can be read; the file's bytes stay until the last copy of it goes
  std::function<SparseGrid(std::size_t grid)> load;
  std::vector<std::string> notices = {};  // of the reading
};

// Memory that reading a file may take, bytes.
std::uint64_t readingLimit(const ImportSettings& settings);

// Active voxels and their box, and whether the grid is more than its background.
void countActive(const SparseGrid& grid, GridHeader& header);

// ToolError kInvalid for whatever is damaged. Safe for hostile input: nothing is allocated that the file's
// own bytes do not account for, and not beyond the limit. No byte is read for two grids, so that time is
// bounded as memory is. At most, for each byte
// - of an OpenVDB tree: some 120 bytes (vectors of doubles; 50 where values are single numbers);
// - of a NanoVDB tree: some 25 (masks). Packed ones count, and take memory, as what they unpack to: at most
// 1032 times their bytes, as zlib can, and for all grids
//   of a file together 256 MiB and 64 times the file;
// and as much again while an array grows.
VolumeFile readVdb(const InputFiles& files, std::uint64_t limit);
VolumeFile readNanoVdb(const InputFiles& files, std::uint64_t limit);

// From the file to the model: which grid, solid or fog, on which lattice.
SourceModel importVolume(const InputFiles& files, const std::function<VolumeFile()>& read,
                         const ImportSettings& settings);

}  // namespace kelp::bake
