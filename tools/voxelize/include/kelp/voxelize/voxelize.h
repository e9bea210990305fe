// SPDX-License-Identifier: MIT
// From a mesh to voxels: which are solid, and the material and normal of each surface voxel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kelp/common/progress.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/topology/fill_report.h"

namespace kelp::bake {

struct VoxelizeResult {
  VoxelGrid grid;
  std::uint64_t solid_voxels = 0;
  bool closed = false;                      // no boundary edges after welding equal positions
  std::string fill;                         // "solid" or "surface", and why
  std::vector<ComponentReport> components;  // the largest kMaxComponentReports, by area
  std::vector<std::string> notices;
  FillCounts counts;
};
// Voxelizes one part into the box of `frame`. The same result with any number of threads. Throws ToolError:
// kInvalid for materials or images that are out of range, kInterrupted if `progress` asks to stop.
VoxelizeResult voxelize(const SourceModel& model, const SourcePart& part, const Frame& frame, Fill fill,
                        int threads, const Progress& progress);

}  // namespace kelp::bake
