// SPDX-License-Identifier: MIT
#include "record_cage.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace kelp::draw {
namespace {

glm::uvec4 texelOf(const glm::vec3& v) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
          std::bit_cast<std::uint32_t>(v.z), 0u};
}

}  // namespace

CageChoice CageChoice::of(const Part& part, float level, int finest, bool one) {
  const Detail about = Detail::of(level);
  const int drawn = std::min(std::max(about.level, finest), part.levels - 1);
  CageChoice choice;
  choice.first = cageOfLevel(part.cages[0].side, drawn);
  const bool mixed = drawn == about.level && about.coarser > 0;
  if (mixed && !one && drawn == part.cages[static_cast<std::size_t>(choice.first)].last_level)
    choice.count = 2;
  return choice;
}

Detail servedDetail(const Detail& wanted, int finest, int coarsest) {
  if (wanted.level < finest) return {finest, 0};
  return wanted.level < coarsest ? wanted : Detail{coarsest, 0};
}

std::size_t cageTexels(const runtime::PosedCage& posed, bool tree) {
  return kCageHeadTexels + posed.nodes.size() + (tree ? 4 * std::size_t{posed.leaves} : 0);
}

glm::uvec4* writeNodes(std::span<const glm::vec3> nodes, glm::uvec4* out) {
  for (const glm::vec3& node : nodes) *out++ = texelOf(node);
  return out;
}

glm::uvec4* writeCage(const runtime::PosedCage& posed, bool tree, glm::uvec4* out) {
  const Cage& cage = *posed.cage;
  const auto leaves = tree ? static_cast<std::uint32_t>(std::bit_width(posed.leaves)) : 0u;
  const CageHead head{posed.inverted.min,
                      leaves | static_cast<std::uint32_t>(cage.first_level) << 8 |
                          static_cast<std::uint32_t>(cage.last_level) << 16,
                      posed.inverted.max, cage.faces()};
  std::memcpy(static_cast<void*>(out), &head, sizeof head);
  out = writeNodes(posed.nodes, out + kCageHeadTexels);
  if (!tree) return out;
  for (const Box& box : posed.tree.first(2 * std::size_t{posed.leaves})) {
    *out++ = texelOf(box.min);
    *out++ = texelOf(box.max);
  }
  return out;
}

}  // namespace kelp::draw
