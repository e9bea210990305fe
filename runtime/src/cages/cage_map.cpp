// SPDX-License-Identifier: MIT
#include "cage_map.h"

#include <bit>

#include "kelp/formats/brick.h"
#include "solid_voxels.h"

namespace kelp::runtime {
namespace {

constexpr double kInTetrahedron = 1e-9;  // shares that are as good as 0

PosedTetrahedron tetrahedronBy(const CageTetrahedron& kind, double side, const glm::dvec3& rest,
                               const glm::dvec3 (&corners)[4]) {
  PosedTetrahedron t;
  t.kind = &kind;
  t.side = side;
  t.rest = rest;
  for (int k = 0; k < 4; ++k) t.corners[k] = corners[k];
  for (int k = 0; k < 3; ++k) t.gradient[kind.axes[k]] = (corners[k + 1] - corners[k]) / side;
  t.volume = glm::determinant(t.gradient);
  return t;
}

// The nearest point of a triangle, by the shares of its corners: Ericson, Real-Time Collision
// Detection, 5.1.5.
glm::dvec3 sharesOfTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                            const glm::dvec3& p) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  const double along = d4 - d3, back = d5 - d6;
  if (va <= 0 && along >= 0 && back >= 0) return {0, 1 - along / (along + back), along / (along + back)};
  return glm::dvec3(va, vb, vc) / (va + vb + vc);
}

// Cells from `first` to `last` - 1, which may be all of a cube, or of many.
struct CellRange {
  std::uint32_t first = 0, last = 0;
};
std::uint32_t cellFrom(const Cage& cage, CellRange range, std::uint64_t code) {
  while (range.first < range.last) {
    const std::uint32_t middle = range.first + (range.last - range.first) / 2;
    if (mortonCode(cage.place(middle)) < code)
      range.first = middle + 1;
    else
      range.last = middle;
  }
  return range.first;
}
bool isInGrid(const Cage& cage, const glm::ivec3& cube) {
  return glm::all(glm::greaterThanEqual(cube, glm::ivec3(0))) && glm::all(glm::lessThan(cube, cage.grid));
}
CellRange cellsOf(const Cage& cage, const glm::ivec3& cube) {
  if (!isInGrid(cage, cube)) return {};
  const std::uint32_t first = cellFrom(cage, {0, cage.cells()}, mortonCode(cube));
  std::uint32_t last = first;
  while (last < cage.cells() && cage.place(last) == cube) ++last;
  return {first, last};
}

// The cube of a point at rest; beside the grid where the point is.
glm::ivec3 cubeAt(const Cage& cage, const glm::dvec3& rest) {
  return glm::ivec3(glm::clamp(glm::floor(rest / double(cage.side)), glm::dvec3(-1), glm::dvec3(cage.grid)));
}

// The cell of a cube whose piece is the nearest to a point.
std::uint32_t nearestPiece(const Cage& cage, CellRange cells, const glm::dvec3& at) {
  std::uint32_t nearest = cells.first;
  double best = INFINITY;
  for (std::uint32_t i = cells.first; i < cells.last && cells.last > cells.first + 1; ++i) {
    const double distance = cage.cell(i)[1] != 0 ? toMask(cage, i, at, true) : 0.0;
    if (distance < best) best = distance, nearest = i;
  }
  return nearest;
}

// Cells are in Morton order, so those of a cube of 2^k cubes follow one another: an octree.
struct NearestCube {
  const Cage& cage;
  glm::dvec3 at;  // in sides of a cell
  double best2 = INFINITY;
  std::uint32_t cell = kNoCell;

  void look(CellRange range, const glm::ivec3& corner, int log_side) {
    const glm::dvec3 low(corner), off = at - glm::clamp(at, low, low + double(1 << log_side));
    if (range.first == range.last || !(glm::dot(off, off) < best2)) return;
    if (log_side == 0) {
      best2 = glm::dot(off, off);
      cell = range.first;
      return;
    }
    const int half = 1 << (log_side - 1);
    const glm::dvec3 middle(corner + half);
    const int near = (at.x >= middle.x ? 1 : 0) | (at.y >= middle.y ? 2 : 0) | (at.z >= middle.z ? 4 : 0);
    for (int n = 0; n < 8; ++n) {
      const int i = n ^ near;
      const glm::ivec3 child = corner + half * glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      const std::uint64_t code = mortonCode(child), cubes = std::uint64_t{1} << (3 * (log_side - 1));
      look({cellFrom(cage, range, code), cellFrom(cage, range, code + cubes)}, child, log_side - 1);
    }
  }
};

// The node at a point of the lattice of which one cell has a corner there; kNoCell: none has.
std::uint32_t nodeAt(const Cage& cage, const glm::ivec3& point) {
  for (int i = 0; i < 8; ++i) {
    const CellRange cells = cellsOf(cage, point - glm::ivec3(i & 1, i >> 1 & 1, i >> 2));
    if (cells.first < cells.last) return cage.node(cells.first, i);
  }
  return kNoCell;
}

// Where a point of the lattice in the middle of the solid goes.
glm::dvec3 innerPoint(const PosedCage& posed, const glm::ivec3& point) {
  const Cage& cage = *posed.cage;
  if (const std::uint32_t node = nodeAt(cage, point); node != kNoCell) return glm::dvec3(posed.nodes[node]);
  glm::dvec3 sum(0);
  double weights = 0;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 at[2];
    int steps[2] = {0, 0};
    for (const int way : {0, 1}) {
      glm::ivec3 next = point;
      std::uint32_t node = kNoCell;
      while (node == kNoCell && next[axis] >= 0 && next[axis] <= cage.grid[axis]) {
        next[axis] += way == 0 ? -1 : 1;
        ++steps[way];
        node = nodeAt(cage, next);
      }
      if (node == kNoCell)
        steps[way] = 0;
      else
        at[way] = glm::dvec3(posed.nodes[node]);
    }
    if (steps[0] == 0 || steps[1] == 0) continue;
    const double weight = 1.0 / (steps[0] * steps[1]);
    sum += weight * glm::mix(at[0], at[1], double(steps[0]) / (steps[0] + steps[1]));
    weights += weight;
  }
  return weights > 0 ? sum / weights : double(cage.side) * glm::dvec3(point);
}

// True if a cube without a cell is in the middle of the solid: the next cells along x go on into it.
bool isInnerCube(const Cage& cage, glm::ivec3 cube) {
  while (isInGrid(cage, cube)) {
    const CellRange cells = cellsOf(cage, cube);
    if (cells.first < cells.last) return cage.beyond(cells.first, 0) == kCageInside;
    ++cube.x;
  }
  return false;
}

PosedTetrahedron innerTetrahedron(const PosedCage& posed, const glm::ivec3& cube, int number) {
  const CageTetrahedron& kind = kCageTetrahedra[number];
  glm::dvec3 corners[4];
  for (int k = 0; k < 4; ++k) {
    const int c = kind.corners[k];
    corners[k] = innerPoint(posed, cube + glm::ivec3(c & 1, c >> 1 & 1, c >> 2));
  }
  const double side = posed.cage->side;
  return tetrahedronBy(kind, side, side * glm::dvec3(cube), corners);
}

PosedTetrahedron tetrahedronBeside(const PosedCage& posed, std::uint32_t cell, const glm::dvec3& rest) {
  const double side = posed.cage->side;
  return tetrahedronOf(posed, cell, tetrahedronAt(rest / side - glm::dvec3(posed.cage->place(cell))));
}

// The cell of a solid voxel that a point lies on, where cubes meet; kNoCell: there is none.
std::uint32_t cellOfVoxelAt(const Cage& cage, const Asset& asset, int part, const glm::dvec3& rest) {
  constexpr double kOn = 1e-3;
  const double side = cage.side;
  const glm::dvec3 off = glm::abs(rest - side * glm::round(rest / side));
  if (!(std::min({off.x, off.y, off.z}) < kOn)) return kNoCell;
  const SolidVoxels voxels(asset, part);
  const glm::dvec3 size(asset.pack().parts()[static_cast<std::size_t>(part)].size);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 at = rest + kOn * (2.0 * glm::dvec3(i & 1, i >> 1 & 1, i >> 2) - 1.0);
    if (at != glm::clamp(at, glm::dvec3(0), size - kOn)) continue;
    const glm::ivec3 voxel(at);
    const CellRange cells = cellsOf(cage, voxel / cage.side);
    if (cells.first == cells.last || !voxels.isSolid(voxel)) continue;
    for (std::uint32_t cell = cells.first; cell < cells.last; ++cell)
      if (isOfPiece(cage, cell, voxel, 1)) return cell;
  }
  return kNoCell;
}

}  // namespace

bool isEmptyCube(const Cage& cage, const glm::ivec3& cube) {
  const CellRange cells = cellsOf(cage, cube);
  return isInGrid(cage, cube) && cells.first == cells.last;
}

bool PosedTetrahedron::holds(const glm::dvec3& at) const {
  const glm::dvec3 f = (at - rest) / side;
  const double a = f[kind->axes[0]], b = f[kind->axes[1]], c = f[kind->axes[2]];
  return a <= 1 + kInTetrahedron && b <= a + kInTetrahedron && c <= b + kInTetrahedron &&
         c >= -kInTetrahedron;
}

PosedTetrahedron tetrahedronOf(const PosedCage& posed, std::uint32_t cell, int number) {
  const Cage& cage = *posed.cage;
  const CageTetrahedron& kind = kCageTetrahedra[number];
  glm::dvec3 corners[4];
  for (int k = 0; k < 4; ++k) corners[k] = glm::dvec3(posed.nodes[cage.node(cell, kind.corners[k])]);
  return tetrahedronBy(kind, cage.side, glm::dvec3(cage.side * cage.place(cell)), corners);
}

PosedTetrahedron tetrahedronBy(const CageTetrahedron& kind, const Cage& cage, std::uint32_t cell,
                               const glm::dvec3 (&corners)[8]) {
  const int* const c = kind.corners;
  return tetrahedronBy(kind, cage.side, glm::dvec3(cage.side * cage.place(cell)),
                       {corners[c[0]], corners[c[1]], corners[c[2]], corners[c[3]]});
}

int tetrahedronAt(const glm::dvec3& f) {
  for (int i = 0; i < 6; ++i) {
    const int* const axes = kCageTetrahedra[i].axes;
    if (f[axes[0]] >= f[axes[1]] && f[axes[1]] >= f[axes[2]]) return i;
  }
  return 0;
}

NearestPoint nearestOfFace(const PosedTetrahedron& t, int face, const glm::dvec3& p) {
  const int a = face == 0 ? 1 : 0, b = face <= 1 ? 2 : 1, c = face <= 2 ? 3 : 2;
  const glm::dvec3 of = sharesOfTriangle(t.corners[a], t.corners[b], t.corners[c], p);
  glm::dvec4 shares(0);
  shares[a] = of.x;
  shares[b] = of.y;
  shares[c] = of.z;
  NearestPoint nearest;
  double share = 0;
  nearest.rest = t.rest;
  for (int k = 3; k > 0; --k) {
    share += shares[k];
    nearest.rest[t.kind->axes[k - 1]] += t.side * share;
  }
  for (int k = 0; k < 4; ++k) nearest.at += shares[k] * t.corners[k];
  nearest.distance = glm::distance(nearest.at, p);
  return nearest;
}

NearestPoint nearestPoint(const PosedTetrahedron& t, const glm::dvec3& p) {
  const glm::dvec3 rest = t.toRest(p), f = (rest - t.rest) / t.side;
  const double a = f[t.kind->axes[0]], b = f[t.kind->axes[1]], c = f[t.kind->axes[2]];
  const double shares[4] = {1 - a, a - b, b - c, c};
  NearestPoint best{p, rest, 0};
  bool outside = false;
  // The nearest point lies on a face that p is beyond.
  for (int face = 0; face < 4; ++face) {
    if (shares[face] >= 0) continue;
    const NearestPoint found = nearestOfFace(t, face, p);
    if (!outside || found.distance < best.distance) best = found;
    outside = true;
  }
  return best;
}

double toMask(const Cage& cage, std::uint32_t cell, const glm::dvec3& at, bool in_mask) {
  const int side = cage.side;
  const glm::dvec3 q = at - glm::dvec3(side * cage.place(cell));
  const std::uint32_t* const mask = &cage.words[cage.cell(cell)[1]];
  const std::uint32_t whole = (1u << side) - 1;
  const auto beside = [](double x, double low) { return std::max({low - x, x - low - 1, 0.0}); };
  const int here = static_cast<int>(std::clamp(std::floor(q.x), 0.0, side - 1.0));
  double best2 = INFINITY;
  for (int row = 0; row < side * side; ++row) {
    const double y = beside(q.y, row % side), z = beside(q.z, row / side), across2 = y * y + z * z;
    if (across2 >= best2) continue;
    const int bit = side * row;
    std::uint32_t bits = mask[bit >> 5] >> (bit & 31) & whole;
    if (!in_mask) bits = ~bits & whole;
    const std::uint32_t above = bits >> here << here, below = bits & ((2u << here) - 1);
    if (above != 0) {
      const double x = beside(q.x, std::countr_zero(above));
      best2 = std::min(best2, across2 + x * x);
    }
    if (below != 0) {
      const double x = beside(q.x, 31 - std::countl_zero(below));
      best2 = std::min(best2, across2 + x * x);
    }
  }
  return std::sqrt(best2);
}

bool isOfPiece(const Cage& cage, std::uint32_t cell, const glm::ivec3& first, int side) {
  if (cage.cell(cell)[1] == 0) return true;
  const std::uint32_t* const mask = &cage.words[cage.cell(cell)[1]];
  const glm::ivec3 v = first - cage.side * cage.place(cell);
  const std::uint32_t whole = (1u << side) - 1;
  for (int row = 0; row < side * side; ++row) {
    const int bit = v.x + cage.side * (v.y + row % side + cage.side * (v.z + row / side));
    if (mask[bit >> 5] >> (bit & 31) & whole) return true;
  }
  return false;
}

std::uint32_t cellNear(const Cage& cage, const glm::dvec3& rest) {
  CellRange cells = cellsOf(cage, cubeAt(cage, rest));
  if (cells.first == cells.last) {
    NearestCube nearest{cage, rest / double(cage.side)};
    nearest.look({0, cage.cells()}, glm::ivec3(0),
                 static_cast<int>(std::bit_width(static_cast<unsigned>(kMostCageCells))) - 1);
    cells = cellsOf(cage, cage.place(nearest.cell));
  }
  return nearestPiece(cage, cells, rest);
}

PosedTetrahedron tetrahedronFor(const PosedCage& posed, const glm::dvec3& rest) {
  const Cage& cage = *posed.cage;
  const glm::ivec3 cube = cubeAt(cage, rest);
  if (isEmptyCube(cage, cube) && isInnerCube(cage, cube))
    return innerTetrahedron(posed, cube, tetrahedronAt(rest / double(cage.side) - glm::dvec3(cube)));
  return tetrahedronBeside(posed, cellNear(cage, rest), rest);
}

PosedTetrahedron tetrahedronFor(const PosedCage& posed, const Asset& asset, int part,
                                const glm::dvec3& rest) {
  const std::uint32_t cell = cellOfVoxelAt(*posed.cage, asset, part, rest);
  return cell != kNoCell ? tetrahedronBeside(posed, cell, rest) : tetrahedronFor(posed, rest);
}

}  // namespace kelp::runtime
