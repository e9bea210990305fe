// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pack/pack_file.h"

namespace kelp::dump {

struct SliceOptions {
  int level = 0;
  char axis = 'y';        // across the layer
  std::optional<int> at;  // which layer; none: the middle one
  // occupancy, clearance, normals, color; of fog density, heat. Empty: occupancy or density.
  std::string what;
  int scale = 1;  // pixels a voxel
};

// Writes one layer of a part's voxels as a PNG. Across y: x to the right, z down. Across z: x
// to the right, y up. Across x: z to the right, y up. ToolError; kUnsupported if this program was
// built without libpng.
void writeSlice(PackFile& file, std::uint32_t part, const SliceOptions& options, const std::string& output);

// Throws that ToolError, before the pack is read.
void checkSlices();

}  // namespace kelp::dump
