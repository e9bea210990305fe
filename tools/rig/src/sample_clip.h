// SPDX-License-Identifier: MIT
// Swept parts: what a clip does to them, at many moments.
#pragma once

#include <cstdint>

#include "kelp/rig/rig.h"

namespace kelp::rig {

// proveClip() of a swept part.
ClipReport sampleClip(const RawClip& clip, std::uint32_t part, const RawRig& rest, const glm::ivec3& size);

}  // namespace kelp::rig
