// SPDX-License-Identifier: MIT
// How joints move.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count);
std::vector<glm::dmat4x3> motionsAt(const SourceSkin& skin, std::uint32_t clip, double time);

}  // namespace kelp::bake
