// SPDX-License-Identifier: MIT
// Cages that parts are drawn through: which of them, and what records hold of them (shaders/instance.glsl).
#pragma once

#include <span>

#include <glm/gtc/type_precision.hpp>

#include "kelp/cages/posed_cage.h"

namespace kelp::draw {

// In RecordHead::segments, beside the number of nodes.
inline constexpr std::uint32_t kCagedSpline = 0x40000000u;

// The texels between a record's head and the nodes.
struct CageHead {
  glm::vec3 fold_low;
  // Leaves of the tree as a binary logarithm plus 1, 0: there is no tree | the cage's level << 8 | the
  // coarsest that is seen through it << 16.
  std::uint32_t shape;
  glm::vec3 fold_high;
  std::uint32_t faces;
};
static_assert(sizeof(CageHead) == 2 * sizeof(glm::uvec4));
inline constexpr std::size_t kCageHeadTexels = 2;

// Of the nodes, the tree if there is to be one, and the head of both.
std::size_t cageTexels(const runtime::PosedCage& posed, bool tree);
// These return where the next texel is.
glm::uvec4* writeCage(const runtime::PosedCage& posed, glm::uvec4* out);  // with its tree, if it has one
glm::uvec4* writeNodes(std::span<const glm::vec3> nodes, glm::uvec4* out);

}  // namespace kelp::draw
