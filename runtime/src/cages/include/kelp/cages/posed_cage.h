// SPDX-License-Identifier: MIT
// A part's cage as an instance poses it, with all that rays and draws need. After each change of the pose the
// first caller makes it, and the pose keeps it.
#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "kelp/formats/geometry.h"
#include "kelp/runtime/instance.h"

namespace kelp::runtime {

inline constexpr float kNowhere = 1e38f;  // both corners of a box without cells: no ray comes there

// How much of a posed cage is made: a box around its nodes, and the nodes, unless they follow parts; all
// nodes and the inverted tetrahedra; the tree, for rays, too.
enum class CageUse { kBounds, kCells, kTree };

// Valid until the pose changes.
struct PosedCage {
  const Cage* cage = nullptr;
  std::span<const glm::vec3> nodes;  // part space
  Box bounds;                        // around the nodes
  // Around the tetrahedra whose determinant is not above 0, or too near to tell; empty: none.
  Box inverted;
  std::uint32_t inverted_count = 0;
  // If it was asked for: boxes around cells, as a complete binary tree: box 1 is the root, 2 i and 2 i + 1
  // are in box i. Box `leaves` + j holds the cells of leaf j of Cage::leaves. A box without cells is at
  // kNowhere. Box 0 is not used. leaves: a power of two.
  std::span<const Box> tree;
  std::uint32_t leaves = 0;
};

// kFolds, kNotMonotone: the spline that the nodes follow takes no point anywhere. kMisuse: a node that the
// host wrote is no finite number, or farther away than 2^20 times the part's longest side; `offset` is its
// number. kMisuse also if there is no such part, cage or node in the pose. kOutOfMemory: for the pose of
// instances without one, which the asset makes at its first use.
Result<PosedCage> posedCage(const Instance& instance, int part, int cage, CageUse use = CageUse::kCells);

}  // namespace kelp::runtime
