// SPDX-License-Identifier: MIT
#include "record_cage.h"

#include <bit>
#include <cstring>

#include <glm/common.hpp>

namespace kelp::draw {
namespace {

glm::uvec4 texelOf(const glm::vec3& v, std::uint32_t more = 0) {
  return {glm::floatBitsToUint(v.x), glm::floatBitsToUint(v.y), glm::floatBitsToUint(v.z), more};
}

}  // namespace

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
                      leaves | static_cast<std::uint32_t>(cage.level) << 8 |
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
