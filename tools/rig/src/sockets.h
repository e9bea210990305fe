// SPDX-License-Identifier: MIT
// Sockets of a rig.
#pragma once

#include <string>

#include "kelp/rig/rig.h"

namespace kelp::rig {

// The fault of a socket's offset for a spline along this axis; empty if there is none.
std::string faultOfOffset(const glm::vec3& offset, Axis axis);

}  // namespace kelp::rig

namespace kelp {

// The inverse of realizeSockets: adds the sockets of the part to a rig whose axis is set.
void describeSockets(std::span<const RawSocket> sockets, std::uint32_t part, RigDescription& rig);

}  // namespace kelp
