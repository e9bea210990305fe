// SPDX-License-Identifier: MIT
// How joints move at moments of a clip.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"

namespace kelp::bake {

// The middles of `count` equal stretches of a clip.
std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count);

// The motions of all joints, posed <- bind pose in the soup's space; between samples, motions within the
// parent joint are linear.
std::vector<glm::dmat4x3> motionsAt(const SourceSkin& skin, std::uint32_t clip, double time);

// The weights of all morph targets, likewise.
std::vector<double> weightsAt(const SourceSkin& skin, std::uint32_t clip, double time);

}  // namespace kelp::bake
