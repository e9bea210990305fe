// SPDX-License-Identifier: MIT
// Cages that parts are drawn through: which of them, and what records hold of them (shaders/instance.glsl).
#pragma once

#include <span>

#include <glm/gtc/type_precision.hpp>

#include "detail.h"
#include "kelp/cages/posed_cage.h"
#include "kelp/formats/model.h"

namespace kelp::draw {

// In RecordHead::segments, beside the number of nodes.
inline constexpr std::uint32_t kCagedSpline = 0x40000000u;

// The texels between a record's head and the nodes.
struct CageHead {
  glm::vec3 fold_low;
  // Leaves of the tree as a binary logarithm plus 1, 0: there is no tree | the finest level that the cage
  // serves << 8 | the coarsest << 16.
  std::uint32_t shape;
  glm::vec3 fold_high;
  std::uint32_t faces;
};
static_assert(sizeof(CageHead) == 2 * sizeof(glm::uvec4));
inline constexpr std::size_t kCageHeadTexels = 2;

// The cages of a part that its pixels are drawn through: `count` of them, 1 or 2, from `first` on. Two where
// the pattern of pixels is between two levels with different cages.
struct CageChoice {
  int first = 0, count = 1;
  // Of a part that is drawn at about that level (Detail::of), or, if that is coarser, at `finest`. one: never
  // two.
  static CageChoice of(const Part& part, float level, int finest, bool one);
};
// Detail within the levels that a choice of cages serves.
Detail servedDetail(const Detail& wanted, int finest, int coarsest);

// Of the nodes, the tree if there is to be one, and the head of both.
std::size_t cageTexels(const runtime::PosedCage& posed, bool tree);
// These return where the next texel is.
glm::uvec4* writeCage(const runtime::PosedCage& posed, glm::uvec4* out);  // with its tree, if it has one
glm::uvec4* writeNodes(std::span<const glm::vec3> nodes, glm::uvec4* out);

}  // namespace kelp::draw
