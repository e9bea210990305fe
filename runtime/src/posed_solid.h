// SPDX-License-Identifier: MIT
// One solid part of an instance as distances see it.
#pragma once

#include <optional>
#include <span>

#include "kelp/runtime/distance.h"
#include "spline_map.h"

namespace kelp::runtime {

struct PosedSolid {
  const Asset* asset = nullptr;
  int part = 0;
  std::span<const Knot> knots;
  SplineMap map;
  glm::ivec3 size{0};      // voxels of level 0
  glm::dmat3 to_world{1};  // part space -> world, without the translation
  glm::dvec3 origin{0};    // of part space, in the world
};

bool allFinite(const glm::vec3& v);

// What all queries refuse of an instance. False: it is not drawn, so it has no solid.
Result<bool> checkInstance(const Instance& instance);
// The part, if it is solid and its matrix is finite. The instance must have passed checkInstance().
std::optional<PosedSolid> posedSolid(const Instance& instance, int part);
// distance() with one part. nullopt: none of its distances is in memory.
std::optional<Distance> distanceToPart(const PosedSolid& solid, const glm::vec3& point);
// The least factor by which the matrix lengthens a vector, or a little less; 0 for a singular one.
double leastScale(const glm::dmat3& matrix);

}  // namespace kelp::runtime
