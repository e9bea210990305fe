// SPDX-License-Identifier: MIT
// Queries of kelp/runtime/distance.h with one instance that passed checkInstance(), and arguments that were
// checked. Each improves what it is given, if it can.
#pragma once

#include "kelp/runtime/distance.h"

namespace kelp::runtime {

void findNearest(const Instance& instance, const glm::vec3& point, Distance& nearest);
void findClosest(const Instance& instance, const glm::dvec3& point, ClosestPoint& nearest);
bool touches(const Instance& instance, const Sphere& shape);
bool touches(const Instance& instance, const Capsule& shape);
bool touches(const Instance& instance, const OrientedBox& shape);
void cast(const Instance& instance, const glm::dvec3& from, const glm::dvec3& way, double radius,
          SphereCast& nearest);

}  // namespace kelp::runtime
