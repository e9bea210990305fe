// SPDX-License-Identifier: MIT
#include "record_cage.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace kelp::draw {
namespace {

glm::uvec4 texelOf(const glm::vec3& v, std::uint32_t more = 0) {
  return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
          std::bit_cast<std::uint32_t>(v.z), more};
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

glm::uvec4* writeCage(const runtime::PosedCage& posed, glm::uvec4* out) {
  const Cage& cage = *posed.cage;
  const auto leaves = static_cast<std::uint32_t>(std::bit_width(posed.tree.size() / 2));
  const CageHead head{posed.inverted.min,
                      leaves | static_cast<std::uint32_t>(cage.first_level) << 8 |
                          static_cast<std::uint32_t>(cage.last_level) << 16,
                      posed.inverted.max, cage.faces()};
  std::memcpy(static_cast<void*>(out), &head, sizeof head);
  out = writeNodes(posed.nodes, out + kCageHeadTexels);
  for (std::size_t i = 0; i < posed.tree.size(); ++i) {
    const std::uint32_t none[] = {0, 0};
    const std::uint32_t* const cells =
        i < posed.leaves ? none : &cage.leaves[kLeafCells * (i - posed.leaves)];
    *out++ = texelOf(posed.tree[i].min, cells[0]);
    *out++ = texelOf(posed.tree[i].max, cells[1]);
  }
  return out;
}

}  // namespace kelp::draw
