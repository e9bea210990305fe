// SPDX-License-Identifier: MIT
#include "kelp/formats/cage.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "kelp/formats/brick.h"
#include "morton_walk.h"

namespace kelp {
namespace {

constexpr Error kNoCageMemory{ErrorCode::kOutOfMemory, "no memory for a cage"};
Error wrong(const char* text) { return {ErrorCode::kCorrupt, text}; }

bool holdsCells(std::uint8_t block) { return block != 0 && block != kInsideBlock; }

std::uint32_t indexOf(const glm::ivec3& at, const glm::ivec3& grid) {
  return static_cast<std::uint32_t>(at.x + grid.x * (at.y + grid.y * at.z));
}

glm::ivec3 placeOf(std::uint32_t word) {
  return {static_cast<int>(word & 255), static_cast<int>(word >> 8 & 255), static_cast<int>(word >> 16)};
}

// Words of the masks of one cell, for all levels of a cage.
std::uint32_t maskWords(const Cage& cage) {
  std::uint32_t words = 0;
  for (int level = cage.first_level; level <= cage.last_level; ++level) {
    const auto side = static_cast<std::uint32_t>(cage.side >> level);
    words += std::max(side * side * side / 32, 1u);
  }
  return words;
}

// The cells of a cube.
struct Cube {
  std::uint32_t first = 0, count = 0;
  bool inside = false;
};

// What makeCage() works on.
struct Maker {
  const CageSource& source;
  Cage cage;
  Buffer<std::uint32_t> cells;    // as the final words, kCageCellWords each
  Buffer<std::uint64_t> cubes;    // of cubes that hold cells: index << 32 | first cell, ascending
  Buffer<std::uint64_t> corners;  // of all cells: point of the lattice << 32 | cell << 3 | corner, ascending
  std::uint32_t cell_count = 0, node_count = 0, face_count = 0;
  std::uint32_t with_masks = 0;  // cells

  std::uint32_t* cell(std::uint32_t i) { return &cells[std::size_t{kCageCellWords} * i]; }
  std::uint32_t& node(std::uint32_t i, int corner) { return cell(i)[2 + corner]; }

  Result<void> countCells(std::uint64_t max_bytes);
  Result<void> placeCells();
  Result<void> nameNodes(CageMemory& memory);
  void joinCells();
  Result<void> write(CageMemory& memory);
  bool isWrapped(const glm::ivec3& at) const;
  Cube cubeAt(const glm::ivec3& at) const;
  std::uint32_t beyond(std::uint32_t cell, int side);
  std::uint32_t sharing(const Cube& cube, std::uint32_t cell, int face, int other, std::uint32_t& one);
};

// True if all 26 cubes around are solid or hold cells.
bool Maker::isWrapped(const glm::ivec3& at) const {
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 beside = at + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
    for (int axis = 0; axis < 3; ++axis)
      if (beside[axis] < 0 || beside[axis] >= cage.grid[axis]) return false;
    if (source.blocks[indexOf(beside, cage.grid)] == 0) return false;
  }
  return true;
}

Result<void> Maker::countCells(std::uint64_t max_bytes) {
  const std::uint64_t blocks = static_cast<std::uint64_t>(cage.grid.x) *
                               static_cast<std::uint64_t>(cage.grid.y) *
                               static_cast<std::uint64_t>(cage.grid.z);
  if (source.blocks.size() != blocks)
    return wrong("a cage does not have one number for each cube of its grid");
  std::uint64_t count = 0, cube_count = 0, divided = 0;
  for (const std::uint8_t block : source.blocks) {
    if (!holdsCells(block)) continue;
    count += block;
    ++cube_count;
    if (block > 1) divided += block;
  }
  if (count == 0) return wrong("a cage has no cells");
  const auto side = static_cast<std::uint64_t>(cage.side >> cage.first_level);
  if (source.masks.size() != divided * (side * side * side / 8))
    return wrong("a cage's masks do not match the pieces of its cells");
  // Nodes and faces come later; a cell has at most 8 nodes and 12 faces.
  if (count > kMaxCells - 1 ||
      (count * kCageCellWords + divided * maskWords(cage)) * sizeof(std::uint32_t) > max_bytes)
    return Error{ErrorCode::kLimit, "a cage has more cells than the limits allow"};
  cell_count = static_cast<std::uint32_t>(count);
  with_masks = static_cast<std::uint32_t>(divided);
  if (!cells.reset(std::uint64_t{kCageCellWords} * count) || !cubes.reset(cube_count) ||
      !corners.reset(8 * count))
    return kNoCageMemory;
  return {};
}

// Cells in Morton order of their cubes; which cubes have them.
Result<void> Maker::placeCells() {
  std::uint32_t next = 0, cube = 0;
  const glm::ivec3 points = cage.grid + 1;
  for (MortonWalk walk(cage.grid); !walk.done(); walk.next()) {
    const glm::ivec3 at = walk.cell();
    const std::uint32_t index = indexOf(at, cage.grid);
    const std::uint8_t block = source.blocks[index];
    if (block == kInsideBlock && !isWrapped(at))
      return wrong("a cube of a cage is said to be inside, but around it is a cube without solid");
    if (!holdsCells(block)) continue;
    cubes[cube++] = std::uint64_t{index} << 32 | next;
    for (int piece = 0; piece < block; ++piece, ++next) {
      cell(next)[0] = static_cast<std::uint32_t>(at.x | at.y << 8 | at.z << 16);
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 point = at + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
        corners[std::size_t{8} * next + static_cast<std::size_t>(corner)] =
            std::uint64_t{indexOf(point, points)} << 32 | next << 3 | static_cast<std::uint32_t>(corner);
      }
    }
  }
  std::sort(cubes.begin(), cubes.end());
  std::sort(corners.begin(), corners.end());
  return {};
}

// Nodes in the order of the lattice's points; those of one point in the order of their first corners.
Result<void> Maker::nameNodes(CageMemory& memory) {
  std::size_t split = 0, number = 0;
  const auto places = [&](bool write) -> Result<void> {
    std::uint32_t nodes = 0;
    split = number = 0;
    for (std::size_t first = 0, end = 0; first < corners.size(); first = end) {
      const auto point = static_cast<std::uint32_t>(corners[first] >> 32);
      while (end < corners.size() && corners[end] >> 32 == point) ++end;
      const bool divided = split < source.split_points.size() && source.split_points[split] == point;
      std::uint32_t here = 1;
      if (divided) {
        ++split;
        here = 0;
        if (end - first > source.splits.size() - number)
          return wrong("a cage's points of several nodes do not have a number for each corner");
      }
      for (std::size_t i = first; i < end; ++i) {
        std::uint32_t which = 0;
        if (divided) {
          which = source.splits[number++];
          if (which > here) return wrong("the nodes of a cage's point are not numbered in their order");
          here = std::max(here, which + 1);
        }
        const auto corner = static_cast<std::uint32_t>(corners[i]);
        node(corner >> 3, static_cast<int>(corner & 7)) = nodes + which;
        if (!write) continue;
        const std::uint32_t place = cell(corner >> 3)[0];
        memory.places[nodes + which] = ((place & 255) + (corner & 1)) |
                                       ((place >> 8 & 255) + (corner >> 1 & 1)) << 10 |
                                       ((place >> 16) + (corner >> 2 & 1)) << 20;
      }
      if (divided && here < 2) return wrong("a cage's point of several nodes has one");
      nodes += here;
    }
    if (split != source.split_points.size() || number != source.splits.size())
      return wrong("a cage's points of several nodes do not ascend, or are no corners of cells");
    node_count = nodes;
    return {};
  };
  if (Result<void> counted = places(false); !counted) return counted;
  if (!memory.places.reset(node_count)) return kNoCageMemory;
  return places(true);
}

Cube Maker::cubeAt(const glm::ivec3& at) const {
  for (int axis = 0; axis < 3; ++axis)
    if (at[axis] < 0 || at[axis] >= cage.grid[axis]) return {};
  const std::uint32_t index = indexOf(at, cage.grid);
  const std::uint8_t block = source.blocks[index];
  if (block == kInsideBlock) return {0, 0, true};
  if (block == 0) return {};
  const std::uint64_t* const found = std::lower_bound(cubes.begin(), cubes.end(), std::uint64_t{index} << 32);
  return {static_cast<std::uint32_t>(*found), block, false};
}

// How many cells of the cube have, at their face `other`, the nodes that `cell` has at `face`; the last one.
std::uint32_t Maker::sharing(const Cube& cube, std::uint32_t from, int face, int other, std::uint32_t& one) {
  std::uint32_t count = 0;
  const int bit = 1 << (face >> 1), high = face & 1 ? bit : 0, other_high = other & 1 ? bit : 0;
  for (std::uint32_t i = cube.first; i < cube.first + cube.count; ++i) {
    bool same = true;
    for (int corner = 0; corner < 8; ++corner)
      if (!(corner & bit)) same = same && node(from, corner | high) == node(i, corner | other_high);
    if (!same) continue;
    ++count;
    one = i;
  }
  return count;
}

// What lies beyond a face of a cell, 0 .. 5 = -x, +x, -y, +y, -z, +z. A face that more than two cells have in
// common is boundary for all of them.
std::uint32_t Maker::beyond(std::uint32_t from, int face) {
  const glm::ivec3 at = placeOf(cell(from)[0]);
  glm::ivec3 to = at;
  to[face >> 1] += face & 1 ? 1 : -1;
  const Cube there = cubeAt(to);
  if (there.inside) return kCageInside;
  std::uint32_t one = kCageOutside, self = 0;
  if (there.count == 0 || sharing(there, from, face, face ^ 1, one) != 1) return kCageOutside;
  return sharing(cubeAt(at), from, face, face, self) == 1 ? one : kCageOutside;
}

void Maker::joinCells() {
  for (std::uint32_t i = 0; i < cell_count; ++i) {
    for (int face = 0; face < 6; ++face) {
      cell(i)[10 + face] = beyond(i, face);
      if (cell(i)[10 + face] == kCageOutside) face_count += 2;
    }
  }
}

Result<void> Maker::write(CageMemory& memory) {
  const std::uint32_t words_each = maskWords(cage), cells_at = kCageHeader,
                      faces_at = cells_at + kCageCellWords * cell_count;
  const std::uint64_t masks_at = std::uint64_t{faces_at} + face_count;
  if (!memory.words.reset(masks_at + std::uint64_t{with_masks} * words_each)) return kNoCageMemory;
  std::uint32_t* const words = memory.words.data();
  words[0] = cell_count;
  words[1] = node_count;
  words[2] = face_count;
  words[3] = static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(cage.side)) |
                                        cage.first_level << 8 | cage.last_level << 16);
  std::uint32_t face = faces_at, mask = static_cast<std::uint32_t>(masks_at);
  const std::uint8_t* bits = source.masks.data();
  for (std::uint32_t i = 0; i < cell_count; ++i) {
    for (std::uint32_t t = 0; t < 6; ++t) {
      const CageTetrahedron& order = kCageTetrahedra[t];
      if (cell(i)[10 + 2 * order.axes[0] + 1] == kCageOutside) words[face++] = i << 5 | t << 2;
      if (cell(i)[10 + 2 * order.axes[2]] == kCageOutside) words[face++] = i << 5 | t << 2 | 3;
    }
    if (source.blocks[indexOf(placeOf(cell(i)[0]), cage.grid)] > 1) {
      cell(i)[1] = mask;
      const int finest = cage.side >> cage.first_level;
      bool any = false;
      for (int v = 0; v < finest * finest * finest; ++v) {
        if (!(bits[v >> 3] >> (v & 7) & 1)) continue;
        any = true;
        std::uint32_t at_level = mask;
        for (int side = finest, shift = 0; shift <= cage.last_level - cage.first_level; side >>= 1, ++shift) {
          const int x = v % finest >> shift, y = v / finest % finest >> shift,
                    z = v / finest / finest >> shift;
          const auto bit = static_cast<std::uint32_t>(x + side * (y + side * z));
          words[at_level + (bit >> 5)] |= 1u << (bit & 31);
          at_level += std::max(static_cast<std::uint32_t>(side * side * side) / 32, 1u);
        }
      }
      if (!any) return wrong("a piece of a cage's cell has no voxel");
      bits += finest * finest * finest / 8;
      mask += words_each;
    }
    std::copy_n(cell(i), kCageCellWords, words + cells_at + std::size_t{kCageCellWords} * i);
  }
  return {};
}

}  // namespace

Result<Cage> makeCage(const CageSource& source, const glm::ivec3& size, int levels, int cell, int number,
                      const Cage* finer, std::uint64_t max_bytes, CageMemory& memory) {
  const Allocator& allocator = memory.words.allocator();
  Maker maker{source,
              {},
              Buffer<std::uint32_t>(allocator),
              Buffer<std::uint64_t>(allocator),
              Buffer<std::uint64_t>(allocator)};
  Cage& cage = maker.cage;
  cage.first_level = firstLevelOfCage(cell, number);
  cage.side = cageSide(cell, cage.first_level);
  cage.last_level = cage.first_level;
  while (cage.last_level + 1 < levels && cageOfLevel(cell, cage.last_level + 1) == number) ++cage.last_level;
  cage.grid = cageGrid(size, cage.side);
  if (std::max({cage.grid.x, cage.grid.y, cage.grid.z}) > kMostCageCells)
    return wrong("a cage has more than 256 cells along an axis");
  if (Result<void> good = maker.countCells(max_bytes); !good) return good.error();
  if (Result<void> good = maker.placeCells(); !good) return good.error();
  if (Result<void> good = maker.nameNodes(memory); !good) return good.error();
  maker.joinCells();
  if (Result<void> good = maker.write(memory); !good) return good.error();
  if (source.follows.size() != (finer ? maker.node_count : 0))
    return wrong("a coarser cage does not say for each node what it follows, or the finest one does");
  for (const std::uint32_t follow : source.follows)
    if (follow >= finer->cells()) return wrong("a node of a cage follows a cell that does not exist");
  cage.words = memory.words.span();
  cage.places = memory.places.span();
  cage.follows = source.follows;
  return cage;
}

CageFollow cageFollows(const Cage& cage, std::uint32_t node, const Cage& finer) {
  const std::uint32_t at = cage.follows[node];
  const glm::vec3 f =
      glm::vec3(cage.rest(node) - finer.side * finer.place(at)) / static_cast<float>(finer.side);
  int order[3] = {0, 1, 2};
  if (f[order[1]] > f[order[0]]) std::swap(order[0], order[1]);
  if (f[order[2]] > f[order[1]]) std::swap(order[1], order[2]);
  if (f[order[1]] > f[order[0]]) std::swap(order[0], order[1]);
  const std::uint32_t* const corners = finer.cell(at) + 2;
  const int a = 1 << order[0], b = a | 1 << order[1];
  return {{corners[0], corners[a], corners[b], corners[7]},
          {1 - f[order[0]], f[order[0]] - f[order[1]], f[order[1]] - f[order[2]], f[order[2]]}};
}

}  // namespace kelp
