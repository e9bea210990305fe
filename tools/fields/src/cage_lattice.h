// SPDX-License-Identifier: MIT
// The cubes of a cage, the pieces of solid in them, and which of these touch.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "kelp/fields/solid_bits.h"

namespace kelp::fields {

struct CageLattice {
  // Of the 26 directions to neighbors, those to cubes that come later: number i is code i + kFirstForward.
  static constexpr int kDirections = 13, kFirstForward = 14;
  static constexpr std::uint16_t kFull = 1 << 13, kInside = 1 << 14;  // in `touches`

  struct Divided {  // a cube of several pieces
    std::uint32_t cube = 0;
    std::size_t labels = 0;  // where its labels begin
    std::size_t mask = 0;    // where its masks begin in RawCage::masks
  };

  int side = 0;      // of a cube, level-0 voxels
  int ratio = 0;     // finer cubes along one; 0: there is no finer lattice
  bool cut = false;  // some neighbors do not touch
  glm::ivec3 grid{0};
  std::vector<std::uint8_t> pieces;    // of each cube
  std::vector<std::uint16_t> touches;  // of each cube: bit i: a voxel touches one of the cube in direction i
  // Pairs of pieces that touch, if one of their cubes has several, ascending: cube << 20 | direction << 16 |
  // piece << 8 | piece of the other cube.
  std::vector<std::uint64_t> links;
  std::vector<Divided> divided;  // ascending by cube
  // Of divided cubes, the pieces: of each voxel, if this is the finest lattice (kNoPiece: empty); else of
  // each cell of the finer lattice, in the order of cubes (x fastest, then y, then z), then pieces.
  static constexpr std::uint8_t kNoPiece = 255;
  std::vector<std::uint8_t> labels;

  std::uint32_t index(const glm::ivec3& at) const {
    return static_cast<std::uint32_t>(at.x + grid.x * (at.y + grid.y * at.z));
  }
  bool has(const glm::ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < grid.x && at.y < grid.y && at.z < grid.z;
  }
  // Finds the cube, which has several pieces.
  const Divided& dividedAt(std::uint32_t cube) const {
    return *std::lower_bound(divided.begin(), divided.end(), cube,
                             [](const Divided& one, std::uint32_t c) { return one.cube < c; });
  }
  // Calls visit(piece, piece of the other) for the pieces of both cubes that touch.
  template <class Visit>
  void forEachLink(std::uint32_t cube, int direction, std::uint32_t other, const Visit& visit) const {
    if (!(touches[cube] >> direction & 1)) return;
    if (pieces[cube] == 1 && pieces[other] == 1) return visit(0, 0);
    const std::uint64_t pair = std::uint64_t{cube} << 4 | static_cast<std::uint64_t>(direction);
    for (auto link = std::lower_bound(links.begin(), links.end(), pair << 16);
         link != links.end() && *link >> 16 == pair; ++link)
      visit(static_cast<int>(*link >> 8 & 255), static_cast<int>(*link & 255));
  }
  // Calls visit(place) for all cubes, x fastest, then y, then z.
  template <class Visit>
  void forEachCube(const Visit& visit) const {
    glm::ivec3 at{0};
    for (at.z = 0; at.z < grid.z; ++at.z)
      for (at.y = 0; at.y < grid.y; ++at.y)
        for (at.x = 0; at.x < grid.x; ++at.x) visit(at);
  }
  // Calls visit(place) for the cubes of the finer lattice in a cube, in the same order.
  template <class Visit>
  void forEachFiner(const CageLattice& finer, const glm::ivec3& cube, const Visit& visit) const {
    const glm::ivec3 low = ratio * cube, high = glm::min(low + ratio, finer.grid);
    glm::ivec3 at{0};
    for (at.z = low.z; at.z < high.z; ++at.z)
      for (at.y = low.y; at.y < high.y; ++at.y)
        for (at.x = low.x; at.x < high.x; ++at.x) visit(at);
  }

  static glm::ivec3 offset(int code) { return glm::ivec3(code % 3, code / 3 % 3, code / 9) - 1; }
  static int codeOf(const glm::ivec3& offset) { return offset.x + 3 * offset.y + 9 * offset.z + 13; }
};

// Union-find over few things. The root of a set is its least member.
class Classes {
 public:
  void reset(std::size_t count) {
    root_.resize(count);
    for (std::size_t i = 0; i < count; ++i) root_[i] = static_cast<std::uint32_t>(i);
  }
  std::size_t size() const { return root_.size(); }
  std::uint32_t find(std::size_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return static_cast<std::uint32_t>(i);
  }
  void join(std::size_t a, std::size_t b) {
    const std::uint32_t one = find(a), other = find(b);
    root_[std::max(one, other)] = std::min(one, other);
  }
  // Numbers the sets in the order of their first members, up to `most`, which is then the last for all
  // others. `number` gets one for each member. Returns how many there are.
  int number(int most, std::vector<std::uint8_t>& number) {
    int count = 0;
    number.resize(root_.size());
    for (std::size_t i = 0; i < root_.size(); ++i) {
      const std::uint32_t root = find(i);
      if (root == i) count = std::min(count + 1, most);
      number[i] = root == i ? static_cast<std::uint8_t>(count - 1) : number[root];
    }
    return count;
  }

 private:
  std::vector<std::uint32_t> root_;
};

// cuts: as buildCages has them.
CageLattice finestLattice(const SolidBits& solid, int side, std::span<const std::uint16_t> cuts);
CageLattice coarserLattice(const CageLattice& finer, const glm::ivec3& size, int side);

}  // namespace kelp::fields
