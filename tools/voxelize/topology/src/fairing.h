// SPDX-License-Identifier: MIT
// A patch that continues the surface around it.
#pragma once

#include <span>

#include "patch.h"

namespace kelp::bake {

// Moves the points within `patch`, the rim stays: to where a thin plate comes to rest that at each point of
// the rim is clamped along the line to `beyond`, the point of the surface around it that many steps of the
// rim away (one a point of the rim). Source: Botsch, Kobbelt, "An Intuitive Framework for Real-Time Freeform
// Modeling", 2004: the energy is the sum of the squared cotangent Laplacians, each divided by its point's
// area. Weights are those of the shape itself, by a few rounds of fixed-point iteration.
void fairPatch(Patch& patch, std::span<const glm::dvec3> beyond);

}  // namespace kelp::bake
