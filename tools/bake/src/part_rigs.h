// SPDX-License-Identifier: MIT
// Rigs and clips of the parts, in the voxels of their frames.
#pragma once

#include <filesystem>

#include "kelp/bake/bake.h"

namespace kelp::bake {

// Gives the parts of `pack`, whose names and sizes are set, their knots, and the pack its clips
// and sockets. Proves that
// no clip folds a part; `report` gets a line per clip and part. ToolError for rigs and clips that cannot be.
void rigParts(const SourceModel& model, const std::filesystem::path& input, RawPack& pack, Report& report);

}  // namespace kelp::bake
