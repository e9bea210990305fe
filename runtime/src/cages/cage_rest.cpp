// SPDX-License-Identifier: MIT
// From the pose to rest.
#include "cage_map.h"
#include "solid_voxels.h"

namespace kelp::runtime {
namespace {

// Which side of the line from a to b a point is on, seen along x, as if it were moved a little along y, and
// less along z, so that it is on none. Whoever asks for the same edge gets the same answer.
bool isLeft(const glm::vec3& a, const glm::vec3& b, const glm::dvec3& p) {
  const double y = double{b.y} - double{a.y}, z = double{b.z} - double{a.z};
  const double turn = y * (p.z - double{a.z}) - z * (p.y - double{a.y});
  return turn != 0 ? turn > 0 : z != 0 ? z < 0 : y > 0;
}

// Counts where the line from a point towards +x leaves the inside, less where it enters it.
struct InsideTurns {
  const PosedCage& posed;
  glm::dvec3 p;
  int turns = 0;

  double key(const Box& box) const {
    const bool meets = double{box.max.x} >= p.x && double{box.min.y} <= p.y && double{box.max.y} >= p.y &&
                       double{box.min.z} <= p.z && double{box.max.z} >= p.z;
    return meets ? 0.0 : INFINITY;
  }
  static double limit() { return INFINITY; }
  void skip(double) {}
  void visit(std::uint32_t cell) {
    const Cage& cage = *posed.cage;
    for (int face = 0; face < 6; ++face) {
      if (cage.beyond(cell, face) != kCageInside) continue;
      // Several cells of a cube may have this face; it counts once.
      if (cell > 0 && cage.place(cell - 1) == cage.place(cell) && cage.beyond(cell - 1, face) == kCageInside)
        continue;
      const int first = face & 1 ? 1 << (face >> 1) : 0, b = 1 << ((face >> 1) + 1) % 3,
                c = 1 << ((face >> 1) + 2) % 3;
      const int corners[4] = {first, first + b, first + b + c, first + c};
      const int way = face & 1 ? -1 : 1;
      turns += way * (across(cell, corners[0], corners[1], corners[2]) +
                      across(cell, corners[0], corners[2], corners[3]));
    }
  }
  // 1 or -1: the line goes through a triangle, with its normal or against it; 0: past it.
  int across(std::uint32_t cell, int a, int b, int c) const {
    const std::uint32_t nodes[3] = {posed.cage->node(cell, a), posed.cage->node(cell, b),
                                    posed.cage->node(cell, c)};
    bool left[3];
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t from = nodes[i], to = nodes[(i + 1) % 3];
      left[i] = from < to ? isLeft(posed.nodes[from], posed.nodes[to], p)
                          : !isLeft(posed.nodes[to], posed.nodes[from], p);
    }
    if (left[0] != left[1] || left[1] != left[2]) return 0;
    const glm::dvec3 at(posed.nodes[nodes[0]]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(posed.nodes[nodes[1]]) - at, glm::dvec3(posed.nodes[nodes[2]]) - at);
    const double ahead = glm::dot(normal, at - p) * (left[0] ? 1 : -1);
    return ahead > 0 ? (left[0] ? 1 : -1) : 0;
  }
};

// The tetrahedra that hold a point.
struct HoldingRest {
  const PosedCage& posed;
  const SolidVoxels& voxels;
  glm::ivec3 size;  // of the part
  glm::dvec3 p;
  std::optional<glm::dvec3> solid_rest{}, rest{};

  double key(const Box& box) const { return toBox2(box, p) > 0 ? INFINITY : 0.0; }
  double limit() const { return solid_rest ? 0.0 : INFINITY; }
  void skip(double) {}
  void visit(std::uint32_t cell) {
    for (int i = 0; i < 6 && !solid_rest; ++i) {
      const PosedTetrahedron t = tetrahedronOf(posed, cell, i);
      if (!(t.volume > 0)) continue;
      const glm::dvec3 at = t.toRest(p);
      if (!t.holds(at)) continue;
      const glm::ivec3 corner(t.rest), last = glm::min(corner + posed.cage->side, size) - 1;
      const glm::ivec3 voxel = glm::clamp(glm::ivec3(glm::floor(at)), corner, last);
      if (isOfPiece(*posed.cage, cell, voxel, 1) && voxels.isSolid(voxel))
        solid_rest = at;
      else if (!rest)
        rest = at;
    }
  }
};

struct NearestRest {
  const PosedCage& posed;
  glm::dvec3 p;
  double best = INFINITY;
  std::optional<glm::dvec3> rest{};

  double key(const Box& box) const { return std::sqrt(toBox2(box, p)); }
  double limit() const { return best; }
  void skip(double) {}
  void visit(std::uint32_t cell) {
    for (int i = 0; i < 6; ++i) {
      const PosedTetrahedron t = tetrahedronOf(posed, cell, i);
      if (!(t.volume > 0)) continue;
      const NearestPoint found = nearestPoint(t, p);
      if (!(found.distance < best)) continue;
      best = found.distance;
      rest = t.toRest(p);
    }
  }
};

// Goes from tetrahedron to tetrahedron, each time to where the last one's map would have the point, if it
// were that of all space.
std::optional<glm::dvec3> restOfInside(const PosedCage& posed, const glm::dvec3& p, glm::dvec3 guess) {
  constexpr int kWhole = 8, kMost = 40;  // steps: as they are; with those that are halved
  const glm::dvec3 extent = double(posed.cage->side) * glm::dvec3(posed.cage->grid);
  for (int i = 0; i < kMost; ++i) {
    guess = glm::clamp(guess, glm::dvec3(0), extent);
    const PosedTetrahedron t = tetrahedronFor(posed, guess);
    const glm::dvec3 next = t.toRest(p);
    if (!(t.volume > 0) || !std::isfinite(glm::dot(next, next))) return std::nullopt;
    if (t.holds(next)) return next;
    guess = i < kWhole ? next : glm::mix(guess, next, 0.5);
  }
  return std::nullopt;
}

}  // namespace

int turnsOfInside(const PosedCage& posed, const glm::dvec3& p) {
  InsideTurns goal{posed, p};
  searchCells(posed, goal);
  return goal.turns;
}

std::optional<glm::dvec3> restInCage(const PosedCage& posed, const Asset& asset, int part,
                                     const glm::dvec3& p) {
  const SolidVoxels voxels(asset, part);
  HoldingRest holding{posed, voxels, asset.pack().parts()[static_cast<std::size_t>(part)].size, p};
  searchCells(posed, holding);
  if (holding.solid_rest) return holding.solid_rest;
  const bool inside = turnsOfInside(posed, p) > 0;
  if (holding.rest && !inside) return holding.rest;
  NearestRest nearest{posed, p};
  searchCells(posed, nearest);
  if (!inside || !nearest.rest) return nearest.rest;
  const std::optional<glm::dvec3> within = restOfInside(posed, p, *nearest.rest);
  return within ? within : nearest.rest;
}

}  // namespace kelp::runtime
