// SPDX-License-Identifier: MIT
// Ground truth for swept parts, in double precision and independent of shaders/sweep.glsl: fine sampling and
// bisection of the inverse map of each slice. The arcs as the library rounds them are the arcs; tests/formats
// compares these with the spline.
#pragma once

#include <optional>

#include "kelp/formats/sweep.h"
#include "reference/ground_truth.h"
#include "reference/judge.h"

namespace kelp::reference {

// World (part space) -> rest, through the slice of one arc, voxels of level 0.
glm::dvec3 unswept(const Arc& arc, const glm::ivec3& size, const glm::dvec3& point);
// And back.
glm::dvec3 swept(const Arc& arc, const glm::ivec3& size, const glm::dvec3& rest);

// As firstTouch() for splines; Touch::segment is the number of the arc.
std::optional<Touch> firstTouch(const Volume& volume, const ArcChain& chain, const glm::dvec3& o,
                                const glm::dvec3& r, double s_min, double s_max, double erode);
Truth truthOf(const Volume& volume, const ArcChain& chain, const glm::dvec3& o, const glm::dvec3& r,
              double s_max);

}  // namespace kelp::reference
