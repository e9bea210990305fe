// SPDX-License-Identifier: MIT
// A cage: a lattice around a part's solid whose nodes anything may move. Space between the nodes follows, and
// the voxels with it. formats/SPEC.md, section 4.9, defines it; shaders/METHOD.md explains how rays cross it.
//
//   cell         A cube of side^3 level-0 voxels that holds solid voxels, once for each piece of solid in it.
//   node         A corner of cells. Where pieces do not touch, one place at rest has several nodes.
//   inside       A cube that is wholly solid, and so is all around it: no cell. A ray that would enter it
//                has hit the solid.
//   tetrahedron  A cell has six, cut along its diagonal from corner 0 to corner 7. The order (a, b, c) of
//                the axes names one: its corners are 0, a, a + b, a + b + c = 7, and at rest it is where
//                f[a] >= f[b] >= f[c] for coordinates f in the cell, 0 to 1. The orders in ascending order,
//                xyz xzy yxz yzx zxy zyx, are tetrahedra 0 .. 5.
//   face         0 is opposite corner 0 and lies in the cell's high face along a; 1 and 2 are within the
//                cell; 3 is opposite corner 7 and lies in the cell's low face along c.
//
// In memory a cage is 32-bit words, the same on the CPU and on the GPU, where a renderer copies them to:
//   0            cells
//   1            nodes
//   2            faces
//   3            binary logarithm of the side | its level << 8 | coarsest level seen through it << 16
//   4 ..         12 words for each cell, in Morton order of their place, then in the order of pieces:
//                  0        its place: x | y << 8 | z << 16, in sides; bit 24 + i: word 6 + i is
//                           kCageOutside; bit 30: it has masks
//                  1        where its masks begin, counted from word 0 of the cage; 0: it is the only piece
//                  2 .. 5   its nodes; corner i is at x + (i & 1), y + (i >> 1 & 1), z + (i >> 2). Word 2 + i
//                           has corners 2 i and 2 i + 1: the first | second - first << 22. Nodes are numbered
//                           in the order of the lattice's points, x fastest, so that is 1 .. 511
//                  6 .. 11  the cell beyond its faces -x, +x, -y, +y, -z, +z; kCageOutside: there is none;
//                           kCageInside: the solid goes on, without a cell
//   then         for each boundary face of a tetrahedron, that is one beyond which there is no cell:
//                cell << 5 | tetrahedron << 2 | face
//   then         masks: for its level and the next coarser one, if the part has that, a bit for each voxel
//                in the cell, x fastest, then y, then z, 32 to a word: 1 if the voxel belongs to this piece
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"

namespace kelp {

inline constexpr std::uint32_t kCageHeader = 4;      // words before the cells
inline constexpr std::uint32_t kCageCellWords = 12;  // of a cell
inline constexpr std::uint32_t kFollowsAll = 0x80000000u;
inline constexpr std::uint32_t kCageOutside = 0xffffffffu, kCageInside = 0xfffffffeu;
inline constexpr int kMostCageCells = 256;            // along an axis
inline constexpr std::uint8_t kInsideBlock = 255;     // in CageSource::blocks
inline constexpr int kMostPieces = kInsideBlock - 1;  // in a cell's cube
inline constexpr std::uint32_t kMaxCells = 1u << 27;  // of a cage
inline constexpr std::uint32_t kLeafCells = 2;        // of the tree over posed cells
inline constexpr int kCageNodeBits = 22;
inline constexpr std::uint32_t kMaxCageNodes = 1u << kCageNodeBits;

// The side of the cells in which a level is bent, in level-0 voxels. cell: that of level 0: 2, 4, 8 or 16.
// So those of coarser levels have as many of their own voxels along a side, but at least four.
constexpr int cageSide(int cell, int level) { return level == 0 ? cell : std::max(cell, 4) << level; }
// Leaves of the complete binary tree over so many posed cells: a power of two.
constexpr std::uint32_t cageLeaves(std::uint32_t cells) {
  return std::bit_ceil((cells + cells / 4 + kLeafCells - 1) / kLeafCells);
}
// Bytes that a reader needs while it makes a cage, and then gives back.
constexpr std::uint64_t cageMakingBytes(std::uint32_t cells) { return std::uint64_t{72} * cells; }
// Number of cells along each axis.
constexpr glm::ivec3 cageGrid(const glm::ivec3& size, int side) {
  return {(size.x + side - 1) / side, (size.y + side - 1) / side, (size.z + side - 1) / side};
}

// Words of a cell's masks of the levels `own` to level - 1.
constexpr std::uint32_t cageMaskWords(int side, int own, int level) {
  std::uint32_t words = 0;
  for (int l = own; l < level; ++l) {
    const auto along = static_cast<std::uint32_t>(side >> l);
    words += std::max(along * along * along / 32, 1u);
  }
  return words;
}

// The part of a cage that a file holds and a baker makes. makeCage() computes the rest.
struct CageSource {
  // One for each cube of the grid, x fastest, then y, then z: 0: no solid; 1 .. 254: so many pieces, each a
  // cell; kInsideBlock.
  std::span<const std::uint8_t> blocks;
  // For each cube of several pieces, in Morton order, for each piece: a bit for each voxel of the cage's
  // level, x fastest, then y, then z, the lowest bit of a byte first: 1 if it is of that piece.
  // (side >> level)^3 / 8 bytes.
  std::span<const std::uint8_t> masks;
  // The points of the lattice at which not all corners of cells are one node, ascending: x + (grid.x + 1) (y
  // + (grid.y + 1) z). And for each, one number for each corner of a cell there, in the order of cells and
  // their corners: 0, 1, ... in the order of first occurrence. Corners with the same number are one node: at
  // most 256 nodes at a point.
  std::span<const std::uint32_t> split_points;
  std::span<const std::uint8_t> splits;
  // Of coarser cages: the cells of the next finer cage that nodes move with, where the rule of SPEC.md 4.9
  // does not tell: for each node that shares a cube with another at its point, and where the cubes of its
  // cells hold no finer cell.
  std::span<const std::uint32_t> follows;
};

// The node at a corner of a cell, of its words.
constexpr std::uint32_t cageNode(const std::uint32_t* cell, int corner) {
  const std::uint32_t pair = cell[2 + corner / 2];
  return (pair & (kMaxCageNodes - 1)) + (corner % 2 ? pair >> kCageNodeBits : 0);
}

// The parts that a node follows, by weight: at most four, ascending. The rest is 0. It goes where these parts
// take its place at rest, the sum of each weighted (SPEC.md 4.9).
struct Influences {
  std::uint16_t parts[4] = {0, 0, 0, 0};
  std::uint8_t weights[4] = {0, 0, 0, 0};  // in 255ths; their sum is 255

  bool operator==(const Influences&) const = default;
};

// Where a morph target moves a node if its weight is 1.
struct MovedNode {
  std::uint32_t node = 0;
  glm::vec3 offset{0};  // level-0 voxels of the part
};
// A morph target. Its weight is the translation along x of an empty part, in pivot units, so clips and poses
// move it as any part. Nodes go to where the parts that they follow take rest + weight * offset, the sum over
// all morph targets.
struct Morph {
  std::uint32_t part = 0;
  std::span<const MovedNode> moved;  // ascending
};

// A cage in memory. The spans lie in memory that the Pack owns, or a CageMemory.
struct Cage {
  int side = 0;                           // of a cell, level-0 voxels
  int level = 0;                          // that is bent by it
  int last_level = 0;                     // the coarsest seen through it: the next one, if there is that
  glm::ivec3 grid{0};                     // cells along each axis
  std::span<const std::uint32_t> words;   // as above
  std::span<const std::uint32_t> places;  // one a node: where the lattice is: x | y << 10 | z << 20, in sides
  // Of coarser cages, one a node: the node of the next finer cage that it moves with; or, if the cell that it
  // follows has none at its place, kFollowsAll | that cell.
  std::span<const std::uint32_t> follows;
  // One a node; empty: nodes follow no parts, but the part's own spline, or the next finer cage.
  std::span<const Influences> influences;
  std::span<const Morph> morphs;  // by part; only with influences
  // Cells of the tree's leaves, kLeafCells of each, the first of them first; kCageOutside: none.
  std::span<const std::uint32_t> leaves;

  std::uint32_t cells() const { return words[0]; }
  std::uint32_t nodes() const { return words[1]; }
  std::uint32_t faces() const { return words[2]; }
  std::uint64_t bytes() const {
    std::uint64_t all = words.size_bytes() + places.size_bytes() + follows.size_bytes() +
                        influences.size_bytes() + leaves.size_bytes();
    for (const Morph& morph : morphs) all += sizeof(Morph) + morph.moved.size_bytes();
    return all;
  }
  // kCageCellWords words.
  const std::uint32_t* cell(std::uint32_t i) const { return &words[kCageHeader + kCageCellWords * i]; }
  // Of a cell: the node at a corner, 0 .. 7; what is beyond a face, 0 .. 5.
  std::uint32_t node(std::uint32_t cell, int corner) const { return cageNode(this->cell(cell), corner); }
  std::uint32_t beyond(std::uint32_t cell, int face) const { return this->cell(cell)[6 + face]; }
  std::uint32_t face(std::uint32_t i) const { return words[kCageHeader + kCageCellWords * cells() + i]; }
  glm::ivec3 place(std::uint32_t cell) const { return unpack(this->cell(cell)[0], 8); }
  // The word where the mask of a level begins, of a cell that has masks.
  std::uint32_t maskAt(std::uint32_t cell, int level) const {
    return this->cell(cell)[1] + cageMaskWords(side, this->level, level);
  }
  // Where a node is at rest, level-0 voxels.
  glm::ivec3 rest(std::uint32_t node) const { return side * unpack(places[node], 10); }

 private:
  static glm::ivec3 unpack(std::uint32_t word, int bits) {
    const std::uint32_t mask = (1u << bits) - 1;
    return {static_cast<int>(word & mask), static_cast<int>(word >> bits & mask),
            static_cast<int>(word >> (2 * bits) & mask)};
  }
};

struct CageMemory {
  CageMemory() = default;
  explicit CageMemory(const Allocator& allocator)
      : words(allocator), places(allocator), follows(allocator), leaves(allocator) {}

  Buffer<std::uint32_t> words, places, follows, leaves;
};

// Which of the six permutations: the corners of tetrahedron t as bits, in their order: 0, a, a + b, 7.
struct CageTetrahedron {
  int axes[3];
  int corners[4];
};
inline constexpr CageTetrahedron kCageTetrahedra[6] = {{{0, 1, 2}, {0, 1, 3, 7}}, {{0, 2, 1}, {0, 1, 5, 7}},
                                                       {{1, 0, 2}, {0, 2, 3, 7}}, {{1, 2, 0}, {0, 2, 6, 7}},
                                                       {{2, 0, 1}, {0, 4, 5, 7}}, {{2, 1, 0}, {0, 4, 6, 7}}};

// The nodes of a cell of the finer cage and their weights, which sum to 1: where a node of a coarser cage
// goes. At a corner of that cell it is that node alone; elsewhere the cell's mean gradient takes it there.
struct CageFollow {
  int count;  // 1 or 8
  std::uint32_t nodes[8];
  float weights[8];
};
CageFollow cageFollows(const Cage& cage, std::uint32_t node, const Cage& finer);
// The finer node whose influences a node of a coarser cage has: the one that it moves with, or the one at the
// nearest corner of the cell that it follows.
std::uint32_t cageInfluencer(const Cage& cage, std::uint32_t node, const Cage& finer);

// Makes the cage of a level that `source` describes, in `memory`. size: of the part, level-0 voxels. levels:
// of the part. finer: the cage of the next finer level; null for level 0. max_bytes: of the cage and of what
// making it takes meanwhile. kCorrupt, with a text, for what breaks the rules of
// SPEC.md 4.9; kLimit; kOutOfMemory. Safe for hostile sources: counts are checked before memory is taken.
Result<Cage> makeCage(const CageSource& source, const glm::ivec3& size, int levels, int cell, int level,
                      const Cage* finer, std::uint64_t max_bytes, CageMemory& memory);

}  // namespace kelp
