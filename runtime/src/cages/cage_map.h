// SPDX-License-Identifier: MIT
// How a posed cage moves points, in double precision: cells and pieces at rest, tetrahedra, the middle of the
// solid. Part space; lengths in level-0 voxels.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/glm.hpp>

#include "kelp/cages/posed_cage.h"

namespace kelp::runtime {

// A tetrahedron in a pose: an affine map.
struct PosedTetrahedron {
  const CageTetrahedron* kind = kCageTetrahedra;
  double side = 1;          // of its cell
  glm::dvec3 rest{0};       // corner 0 of its cell at rest
  glm::dvec3 corners[4]{};  // in the pose, in the order of CageTetrahedron::corners
  glm::dmat3 gradient{1};   // columns: where steps of a voxel along x, y and z at rest lead
  double volume = 1;        // the gradient's determinant; inverted or flat: not above 0

  glm::dvec3 place(const glm::dvec3& at) const { return corners[0] + gradient * (at - rest); }
  // As if all space were mapped like the tetrahedron.
  glm::dvec3 toRest(const glm::dvec3& p) const { return rest + glm::inverse(gradient) * (p - corners[0]); }
  // True if a point at rest lies in it, or beside it by less than rounding.
  bool holds(const glm::dvec3& at) const;
};
inline constexpr std::uint32_t kNoCell = kCageOutside;
PosedTetrahedron tetrahedronOf(const PosedCage& posed, std::uint32_t cell, int number);
// The same by the corners of its cell, in the pose.
PosedTetrahedron tetrahedronBy(const CageTetrahedron& kind, const Cage& cage, std::uint32_t cell,
                               const glm::dvec3 (&corners)[8]);
// The number of the tetrahedron that holds a place in a cell; beside the cell, the one whose map continues.
int tetrahedronAt(const glm::dvec3& in_cell);

// A point of a tetrahedron that is nearest to p.
struct NearestPoint {
  glm::dvec3 at{0}, rest{0};
  double distance = 0;
};
NearestPoint nearestPoint(const PosedTetrahedron& tetrahedron, const glm::dvec3& p);
NearestPoint nearestOfFace(const PosedTetrahedron& tetrahedron, int face, const glm::dvec3& p);

// True if the cube lies in the grid and has no cell.
bool isEmptyCube(const Cage& cage, const glm::ivec3& cube);
// The face of a cell, 0 .. 5, in which face 0 or 3 of a tetrahedron lies.
inline int cellFace(const CageTetrahedron& kind, int face) {
  return face == 0 ? 2 * kind.axes[0] + 1 : 2 * kind.axes[2];
}
// The distance from a point to the nearest voxel of a cell's mask, or to the nearest that is not in it;
// INFINITY: there is none. at: at rest. The cell must have a mask.
double toMask(const Cage& cage, std::uint32_t cell, const glm::dvec3& at, bool in_mask);
// True if the cell has no mask, or a voxel of its mask lies in a box of voxels of its cube.
bool isOfPiece(const Cage& cage, std::uint32_t cell, const glm::ivec3& first, int side);
inline bool isOfPiece(const Cage& cage, std::uint32_t cell, const glm::dvec3& rest) {
  const glm::ivec3 corner = cage.side * cage.place(cell);
  return isOfPiece(cage, cell, glm::clamp(glm::ivec3(glm::floor(rest)), corner, corner + cage.side - 1), 1);
}

// The cell nearest to a point at rest; of several pieces in a cube, the one with the nearest voxel.
std::uint32_t cellNear(const Cage& cage, const glm::dvec3& rest);
// The tetrahedron that moves a point at rest, as toWorld() in kelp/runtime/instance.h says. Without an asset
// the voxels that a point lies on are not asked.
PosedTetrahedron tetrahedronFor(const PosedCage& posed, const glm::dvec3& rest);
PosedTetrahedron tetrahedronFor(const PosedCage& posed, const Asset& asset, int part, const glm::dvec3& rest);

// How often the surface of the inside, the cubes without cells in the middle of the solid, goes around a
// point. Above 0: the point is in the solid, however the middle is filled. The cage must have its tree.
int turnsOfInside(const PosedCage& posed, const glm::dvec3& p);

// The point at rest that toRest() in kelp/runtime/instance.h names. The cage must have its tree. nullopt: all
// tetrahedra are inverted.
std::optional<glm::dvec3> restInCage(const PosedCage& posed, const Asset& asset, int part,
                                     const glm::dvec3& p);

inline double toBox2(const Box& box, const glm::dvec3& p) {
  const glm::dvec3 off = p - glm::clamp(p, glm::dvec3(box.min), glm::dvec3(box.max));
  return glm::dot(off, off);
}
// Goes through the cells of a tree, and leaves out boxes whose key is not below the limit, the lesser keys
// first: goal.key(box), goal.limit(), goal.visit(cell), and goal.skip(key) for boxes that are left out.
template <class Goal>
void searchCells(const PosedCage& posed, Goal& goal) {
  struct Open {
    double key;
    std::uint32_t box;
  };
  Open stack[40];  // a tree has at most 2^27 leaves
  int count = 0;
  stack[count++] = {goal.key(posed.tree[1]), 1};
  while (count > 0) {
    const Open open = stack[--count];
    if (!(open.key < goal.limit())) {
      goal.skip(open.key);
    } else if (open.box >= posed.leaves) {
      for (const std::uint32_t cell :
           posed.cage->leaves.subspan(kLeafCells * std::size_t{open.box - posed.leaves}, kLeafCells))
        if (cell != kCageOutside) goal.visit(cell);
    } else {
      Open near{goal.key(posed.tree[2 * open.box]), 2 * open.box},
          far{goal.key(posed.tree[2 * open.box + 1]), 2 * open.box + 1};
      if (far.key < near.key) std::swap(near, far);
      stack[count++] = far;
      stack[count++] = near;
    }
  }
}

}  // namespace kelp::runtime
