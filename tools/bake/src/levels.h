// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

namespace kelp::bake {

// Levels of a volume: down to a single brick, or as many as were asked for (0: all) if that is fewer.
int levelCount(const glm::ivec3& size, int asked);

}  // namespace kelp::bake
