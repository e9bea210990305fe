// SPDX-License-Identifier: MIT
// A mesh in, voxels out: which voxels are solid, and what the surface looks like where it is.
#pragma once

#include <string>
#include <vector>

#include "kelp/common/progress.h"
#include "kelp/import/core/frame.h"
#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/topology/fill_report.h"

namespace kelp::bake {

struct VoxelizeResult {
  VoxelGrid grid;
  bool closed = false;                      // the mesh has no boundary edge after welding equal positions
  std::string fill;                         // "solid" or "surface", and why
  std::vector<ComponentReport> components;  // the largest kMaxComponentReports, by area
  std::vector<std::string> notices;
  FillCounts counts;
};
VoxelizeResult voxelize(const SourceModel& model, const SourcePart& part, const Frame& frame, Fill fill,
                        int threads, const Progress& progress);

}  // namespace kelp::bake
