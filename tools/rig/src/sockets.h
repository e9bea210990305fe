// SPDX-License-Identifier: MIT
// Sockets of a rig.
#pragma once

#include <cstdint>
#include <span>

#include "kelp/rig/rig.h"

namespace kelp {

// The inverse of realizeSockets: adds the sockets of the part to a rig whose axis is set.
void describeSockets(std::span<const RawSocket> sockets, std::uint32_t part, RigDescription& rig);

}  // namespace kelp
