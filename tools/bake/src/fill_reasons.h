// SPDX-License-Identifier: MIT
// Why components became solid or stayed surfaces, in words.
#pragma once

#include "fill_topology.h"

namespace kelp::bake {

// One line for the part.
std::string summariseFill(const Topology& mesh, Fill fill);

// One entry a component, the largest Report::kMaxComponents by area, in that order.
std::vector<Report::Component> describeComponents(const Topology& mesh, Fill fill);

}  // namespace kelp::bake
