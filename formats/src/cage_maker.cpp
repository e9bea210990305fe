// SPDX-License-Identifier: MIT
#include "cage_maker.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include <glm/common.hpp>

#include "cage_leaves.h"
#include "kelp/formats/brick.h"
#include "morton_walk.h"

namespace kelp {
namespace {

Error wrongCage(const char* text) { return {ErrorCode::kCorrupt, text}; }

bool holdsCells(std::uint8_t block) { return block != 0 && block != kInsideBlock; }

std::uint32_t cubeIndex(const glm::ivec3& at, const glm::ivec3& grid) {
  return static_cast<std::uint32_t>(at.x + grid.x * (at.y + grid.y * at.z));
}

glm::ivec3 cornerOf(std::uint32_t i) {
  return {static_cast<int>(i & 1), static_cast<int>(i >> 1 & 1), static_cast<int>(i >> 2)};
}

bool isInGrid(const glm::ivec3& at, const glm::ivec3& grid) {
  return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < grid.x && at.y < grid.y && at.z < grid.z;
}

// Words of the masks of one cell.
std::uint32_t maskWordsOf(const Cage& cage) {
  return cageMaskWords(cage.side, cage.level, cage.last_level + 1);
}

}  // namespace

// The cells of a cube.
struct CageMaker::Cube {
  std::uint32_t first = 0, count = 0;
  bool inside = false;
};

Result<Cage> cageShape(const glm::ivec3& size, int levels, int cell, int level) {
  Cage cage;
  cage.level = level;
  cage.last_level = std::min(level + 1, levels - 1);
  cage.side = cageSide(cell, level);
  cage.grid = cageGrid(size, cage.side);
  if (std::max({cage.grid.x, cage.grid.y, cage.grid.z}) > kMostCageCells)
    return wrongCage("a cage has more than 256 cells along an axis: it needs larger cells");
  return cage;
}

std::size_t cageMaskBytes(const Cage& shape) {
  const auto side = static_cast<std::size_t>(shape.side >> shape.level);
  return side * side * side / 8;
}

Result<void> CageMaker::count() {
  const glm::ivec3& grid = cage_.grid;
  if (source_.blocks.size() !=
      static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) * static_cast<std::size_t>(grid.z))
    return wrongCage("a cage does not have one number for each cube of its grid");
  std::uint64_t cells = 0, pieces = 0;
  for (const std::uint8_t block : source_.blocks) {
    if (!holdsCells(block)) continue;
    cells += block;
    if (block > 1) pieces += block;
  }
  if (cells == 0) return wrongCage("a cage has no cells");
  cell_count_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(cells, kMaxCells));
  piece_count_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(pieces, kMaxCells));
  // The GPU counts words in 32 bits, and faces name cells in 27.
  if (cell_count_ == kMaxCells || wordsFor(12 * cells) > std::numeric_limits<std::uint32_t>::max())
    return Error{ErrorCode::kLimit, "a cage has more cells than 32 bits can count"};
  return {};
}

std::uint64_t CageMaker::transientBytes() const { return cageMakingBytes(cell_count_); }

std::uint64_t CageMaker::wordsFor(std::uint64_t faces) const {
  return kCageHeader + std::uint64_t{kCageCellWords} * cell_count_ + faces +
         std::uint64_t{piece_count_} * maskWordsOf(cage_);
}

Result<void> CageMaker::connect(std::span<std::uint32_t> cells) {
  cells_ = cells;
  std::size_t cubes = 0;
  for (const std::uint8_t block : source_.blocks) cubes += holdsCells(block) ? 1 : 0;
  if (!cubes_.reset(cubes) || !corners_.reset(8 * std::uint64_t{cell_count_}))
    return Error{ErrorCode::kOutOfMemory, "no memory for a cage"};
  if (const Result<void> r = checkInsides(); !r) return r;
  placeCells();
  if (const Result<void> r = nameNodes(); !r) return r;
  joinCells();
  return {};
}

// All 26 cubes around one that is inside are solid or hold cells. Row by row: there may be millions.
Result<void> CageMaker::checkInsides() const {
  const glm::ivec3& grid = cage_.grid;
  for (int z = 0; z < grid.z; ++z) {
    for (int y = 0; y < grid.y; ++y) {
      const auto rowAt = [&](int dy, int dz) {
        return source_.blocks.subspan(cubeIndex({0, y + dy, z + dz}, grid), static_cast<std::size_t>(grid.x));
      };
      const std::span<const std::uint8_t> row = rowAt(0, 0);
      if (std::find(row.begin(), row.end(), kInsideBlock) == row.end()) continue;
      // Of each x: the nine cubes in this row and beside it hold something.
      std::array<std::uint8_t, kMostCageCells> filled{};
      if (isInGrid({0, y - 1, z - 1}, grid) && isInGrid({0, y + 1, z + 1}, grid)) {
        filled.fill(1);
        for (int i = 0; i < 9; ++i) {
          const std::span<const std::uint8_t> beside = rowAt(i % 3 - 1, i / 3 - 1);
          for (std::size_t x = 0; x < beside.size(); ++x) filled[x] &= beside[x] != 0;
        }
      }
      for (std::size_t x = 0; x < row.size(); ++x)
        if (row[x] == kInsideBlock &&
            (x == 0 || x + 1 == row.size() || !(filled[x - 1] & filled[x] & filled[x + 1])))
          return wrongCage("a cube of a cage is said to be inside, but around it is a cube without solid");
    }
  }
  return {};
}

// Cells in Morton order of their cubes; which cubes have them; all corners.
void CageMaker::placeCells() {
  std::uint32_t next = 0, cube = 0;
  const glm::ivec3 points = cage_.grid + 1;
  for (MortonWalk walk(cage_.grid); !walk.done(); walk.next()) {
    const glm::ivec3 at = walk.cell();
    const std::uint32_t index = cubeIndex(at, cage_.grid);
    const std::uint8_t block = source_.blocks[index];
    if (!holdsCells(block)) continue;
    cubes_[cube++] = std::uint64_t{index} << 32 | next;
    for (int piece = 0; piece < block; ++piece, ++next) {
      cell(next)[0] = static_cast<std::uint32_t>(at.x | at.y << 8 | at.z << 16);
      for (std::uint32_t corner = 0; corner < 8; ++corner)
        corners_[std::size_t{8} * next + corner] =
            std::uint64_t{cubeIndex(at + cornerOf(corner), points)} << 32 | next << 3 | corner;
    }
  }
  std::sort(cubes_.begin(), cubes_.end());
  std::sort(corners_.begin(), corners_.end());
}

// Nodes in the order of the lattice's points; those of one point in the order of their first corners.
Result<void> CageMaker::nameNodes() {
  std::size_t split = 0, number = 0;
  for (std::size_t first = 0, end = 0; first < corners_.size(); first = end) {
    const auto point = static_cast<std::uint32_t>(corners_[first] >> 32);
    while (end < corners_.size() && corners_[end] >> 32 == point) ++end;
    const bool divided = split < source_.split_points.size() && source_.split_points[split] == point;
    std::uint32_t here = 1;
    if (divided) {
      ++split;
      here = 0;
      if (end - first > source_.splits.size() - number)
        return wrongCage("a cage's points of several nodes do not have a number for each corner");
    }
    for (std::size_t i = first; i < end; ++i) {
      std::uint32_t which = 0;
      if (divided) {
        which = source_.splits[number++];
        if (which > here) return wrongCage("the nodes of a cage's point are not numbered in their order");
        here = std::max(here, which + 1);
      }
      // The second corner of a pair is at a later point.
      const auto corner = static_cast<std::uint32_t>(corners_[i]);
      std::uint32_t& pair = cell(corner >> 3)[2 + (corner >> 1 & 3)];
      pair = corner & 1 ? pair | (node_count_ + which - pair) << kCageNodeBits : node_count_ + which;
    }
    if (here < 2 && divided) return wrongCage("a cage's point of several nodes has one");
    node_count_ += here;
    if (node_count_ > kMaxCageNodes)
      return Error{ErrorCode::kLimit, "a cage has more than 4194304 nodes: it needs larger cells"};
  }
  if (split != source_.split_points.size() || number != source_.splits.size())
    return wrongCage("a cage's points of several nodes do not ascend, or are no corners of cells");
  return {};
}

CageMaker::Cube CageMaker::cubeAt(const glm::ivec3& at) const {
  if (!isInGrid(at, cage_.grid)) return {};
  const std::uint32_t index = cubeIndex(at, cage_.grid);
  const std::uint8_t block = source_.blocks[index];
  if (!holdsCells(block)) return {0, 0, block == kInsideBlock};
  const std::uint64_t* const found =
      std::lower_bound(cubes_.begin(), cubes_.end(), std::uint64_t{index} << 32);
  return {static_cast<std::uint32_t>(*found), block, false};
}

// Joins the cells of two cubes side by side: those of which exactly one on each side has the same four nodes.
void CageMaker::joinCubes(const Cube& low, const Cube& high, int axis) {
  struct Face {
    std::array<std::uint32_t, 4> nodes;
    std::uint32_t cell;
  };
  std::array<Face, std::size_t{2} * kMostPieces> faces;
  std::size_t count = 0;
  for (const Cube* cube : {&low, &high}) {
    for (std::uint32_t i = cube->first; i < cube->first + cube->count; ++i, ++count) {
      faces[count].cell = i;
      for (int corner = 0, next = 0; corner < 8; ++corner)
        if (((corner >> axis & 1) == 1) == (cube == &low))
          faces[count].nodes[static_cast<std::size_t>(next++)] = node(i, corner);
    }
  }
  const auto end = faces.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(faces.begin(), end, [](const Face& a, const Face& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.cell < b.cell;
  });
  const auto isOf = [](const Cube& cube, std::uint32_t i) { return i - cube.first < cube.count; };
  for (auto first = faces.begin(); first != end;) {
    const auto next = std::find_if(first, end, [&](const Face& face) { return face.nodes != first->nodes; });
    std::uint32_t a = first->cell, b = (next - 1)->cell;
    if (next - first == 2 && isOf(low, a) != isOf(low, b)) {
      if (!isOf(low, a)) std::swap(a, b);
      beyond(a, 2 * axis + 1) = b;
      beyond(b, 2 * axis) = a;
    }
    first = next;
  }
}

// Finds the cell beyond each face. A face that more than two cells share is boundary for all of them.
void CageMaker::joinCells() {
  for (std::uint32_t i = 0; i < cell_count_; ++i) std::fill_n(&beyond(i, 0), 6, kCageOutside);
  for (const std::uint64_t entry : cubes_) {
    const auto first = static_cast<std::uint32_t>(entry);
    const glm::ivec3 at = placeOf(first);
    const Cube here = cubeAt(at);
    for (int face = 0; face < 6; ++face) {
      glm::ivec3 to = at;
      to[face >> 1] += face & 1 ? 1 : -1;
      const Cube there = cubeAt(to);
      if (there.inside)
        for (std::uint32_t i = first; i < first + here.count; ++i) beyond(i, face) = kCageInside;
      if (there.count > 0 && face & 1) joinCubes(here, there, face >> 1);
    }
  }
  for (std::uint32_t i = 0; i < cell_count_; ++i)
    face_count_ += 2 * static_cast<std::uint32_t>(std::count(&beyond(i, 0), &beyond(i, 0) + 6, kCageOutside));
}

// The masks of all levels of a cell from the bits of the finest. False: there are none.
bool CageMaker::writeMask(const std::uint8_t* bits, std::uint32_t* words) const {
  const int finest = cage_.side >> cage_.level;
  bool any = false;
  for (int v = 0; v < finest * finest * finest; ++v) {
    if (!(bits[v >> 3] >> (v & 7) & 1)) continue;
    any = true;
    for (int level = cage_.level; level <= cage_.last_level; ++level) {
      const int side = cage_.side >> level, shift = level - cage_.level;
      const int x = v % finest >> shift, y = v / finest % finest >> shift, z = v / finest / finest >> shift;
      const auto bit = static_cast<std::uint32_t>(x + side * (y + side * z));
      words[cageMaskWords(cage_.side, cage_.level, level) + (bit >> 5)] |= 1u << (bit & 31);
    }
  }
  return any;
}

// The finer cell that each node moves with: the nearest in the cubes of its cells, the first of several; or
// what the source names, where these hold none or also have cells with another node there.
Result<void> CageMaker::follow(const Cage& finer, std::span<const std::uint32_t> places,
                               std::span<std::uint32_t> follows) {
  const int ratio = cage_.side / finer.side;
  const auto distance = [&](const glm::ivec3& point, std::uint32_t other) {
    const glm::ivec3 low = finer.place(other), gap = ratio * point - glm::clamp(ratio * point, low, low + 1);
    return gap.x * gap.x + gap.y * gap.y + gap.z * gap.z;
  };
  std::fill(follows.begin(), follows.end(), kCageOutside);
  // Of nodes that share a cube with another at their point: kCageInside. Cells of a cube lie together.
  for (std::uint32_t first = 0, i = 0; i < cell_count_; ++i) {
    if (placeOf(i) != placeOf(first)) first = i;
    for (int corner = 0; corner < 8; ++corner)
      if (node(i, corner) != node(first, corner))
        follows[node(i, corner)] = follows[node(first, corner)] = kCageInside;
  }
  // Both are in Morton order, so the finer cells of a cube lie together.
  std::uint32_t next = 0;
  const auto cubeOf = [&](std::uint32_t other) { return mortonCode(finer.place(other) / ratio); };
  for (std::uint32_t i = 0; i < cell_count_; ++i) {
    const glm::ivec3 at = placeOf(i);
    const std::uint64_t cube = mortonCode(at);
    while (next < finer.cells() && cubeOf(next) < cube) ++next;
    for (; next < finer.cells() && cubeOf(next) == cube; ++next) {
      for (std::uint32_t corner = 0; corner < 8; ++corner) {
        const glm::ivec3 point = at + cornerOf(corner);
        std::uint32_t& best = follows[node(i, static_cast<int>(corner))];
        if (best == kCageInside) continue;
        if (best == kCageOutside ||
            std::pair(distance(point, next), next) < std::pair(distance(point, best), best))
          best = next;
      }
    }
  }
  const Error wrong_count = wrongCage("a coarser cage names too few or too many cells that its nodes follow");
  std::size_t named = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (follows[i] < kCageInside) continue;
    if (named == source_.follows.size()) return wrong_count;
    follows[i] = source_.follows[named++];
    if (follows[i] >= finer.cells()) return wrongCage("a node of a cage follows a cell that does not exist");
  }
  if (named != source_.follows.size()) return wrong_count;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::ivec3 point(places[i] & 1023, places[i] >> 10 & 1023, places[i] >> 20);
    const glm::ivec3 f = ratio * point - finer.place(follows[i]);
    const bool at_corner = ((f.x | f.y | f.z) & ~1) == 0;
    follows[i] = at_corner ? finer.node(follows[i], f.x | f.y << 1 | f.z << 2) : kFollowsAll | follows[i];
  }
  return {};
}

Result<Cage> CageMaker::write(std::span<std::uint32_t> words, std::span<std::uint32_t> places,
                              std::span<std::uint32_t> follows, const Cage* finer,
                              std::span<std::uint32_t> slots) {
  cells_ = words.subspan(kCageHeader, std::size_t{kCageCellWords} * cell_count_);
  words[0] = cell_count_;
  words[1] = node_count_;
  words[2] = face_count_;
  words[3] = static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(cage_.side)) |
                                        cage_.level << 8 | cage_.last_level << 16);
  std::uint32_t face = kCageHeader + kCageCellWords * cell_count_, mask = face + face_count_;
  if (source_.masks.size() != piece_count_ * cageMaskBytes(cage_))
    return wrongCage("a cage's masks do not match the pieces of its cells");
  const std::uint8_t* bits = source_.masks.data();
  for (std::uint32_t i = 0; i < cell_count_; ++i) {
    for (std::uint32_t t = 0; t < 6; ++t) {
      const CageTetrahedron& order = kCageTetrahedra[t];
      if (beyond(i, 2 * order.axes[0] + 1) == kCageOutside) words[face++] = i << 5 | t << 2;
      if (beyond(i, 2 * order.axes[2]) == kCageOutside) words[face++] = i << 5 | t << 2 | 3;
    }
    const glm::ivec3 at = placeOf(i);
    for (int face = 0; face < 6; ++face)
      if (beyond(i, face) == kCageOutside) cell(i)[0] |= 1u << (24 + face);
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      const glm::uvec3 point = glm::uvec3(at + cornerOf(corner));
      places[node(i, static_cast<int>(corner))] = point.x | point.y << 10 | point.z << 20;
    }
    if (source_.blocks[cubeIndex(at, cage_.grid)] == 1) continue;
    cell(i)[0] |= 1u << 30;
    cell(i)[1] = mask;
    if (!writeMask(bits, &words[mask])) return wrongCage("a piece of a cage's cell has no voxel");
    bits += cageMaskBytes(cage_);
    mask += maskWordsOf(cage_);
  }
  if (!finer && !source_.follows.empty()) return wrongCage("the nodes of a part's finest cage follow cells");
  if (finer)
    if (const Result<void> r = follow(*finer, places, follows); !r) return r.error();
  Cage cage = cage_;
  cage.words = words;
  cage.places = places;
  cage.follows = follows;
  cage.leaves = slots;
  // corners_ is needed no more, and has eight for each cell.
  fillLeaves(cage, {reinterpret_cast<std::uint32_t*>(corners_.data()), cell_count_}, slots);
  return cage;
}

}  // namespace kelp
