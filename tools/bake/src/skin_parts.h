// SPDX-License-Identifier: MIT
// A part that bends by joints becomes rigid parts that move.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/skin/skin.h"

namespace kelp::bake {

struct DividedSkin {
  std::vector<SkinFit> fits;       // how well the new parts follow the skin, for each clip
  std::vector<SocketFit> sockets;  // and their sockets
  std::string info;                // JSON: what a pack says of its parts, INFO's "skin"
};

// ToolError kInvalid if the rig asks for parts that the skin cannot have.
void requirePlan(const SourcePart& part, const std::filesystem::path& input);

// Replaces the model's first part, whose voxels are made, and its line of the report.
DividedSkin divideSkinnedPart(SourceModel& model, const Frame& frame, int pad, int threads,
                              const Progress& progress, Report& report);

// Adds what a skin needs to the size of its part: the division itself, and parts that have cuts and voxels of
// their neighbours beside the surface.
void countSkin(const SourceSkin& skin, PartSize& size);

// Adds how well clips fit to the report, and a notice for those that do not fit well. `frame` is the whole's.
void reportFits(const DividedSkin& divided, const Frame& frame, Report& report);

}  // namespace kelp::bake
