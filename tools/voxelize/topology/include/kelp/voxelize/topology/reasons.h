// SPDX-License-Identifier: MIT
// Why components became solid or stayed surfaces, in words.
#pragma once

#include "kelp/voxelize/topology/fill_report.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {

// One line for the part.
std::string summariseFill(const Topology& mesh, Fill fill);

// One entry per component, the largest kMaxComponentReports by area, in that order.
std::vector<ComponentReport> describeComponents(const Topology& mesh, Fill fill);

}  // namespace kelp::bake
