// SPDX-License-Identifier: MIT
#include "reference/cage_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace kelp::reference {
namespace {

using glm::dvec3;
using glm::ivec3;

constexpr double kThick = 1e-4;     // of a tetrahedron's volume at rest
constexpr double kMostVoxels = 16;  // along a cube
constexpr std::size_t kGroup = 32;  // cubes

// Where o + s r is in a ball, if it is for some s from 0 to s_max.
bool meets(const dvec3& middle, double radius, const dvec3& o, const dvec3& r, double s_max) {
  const dvec3 off = middle - o;
  const double along = dot(off, r), chord = radius * radius - (dot(off, off) - along * along);
  if (chord < 0) return false;
  return along - std::sqrt(chord) <= s_max && along + std::sqrt(chord) >= 0;
}

}  // namespace

// A part of the ray, in voxels of the level from the corner of a cube.
struct CageTruth::Line {
  dvec3 q{0}, dq{0};
  double from = 0, to = 0;

  dvec3 at(double s) const { return q + s * dq; }
  void keep(double value, double slope) {
    if (slope > 0) from = std::max(from, -value / slope);
    if (slope < 0) to = std::min(to, -value / slope);
    if (slope == 0 && value < 0) to = from - 1;
  }
  // Where it crosses the planes between voxels, and its ends; ascending.
  std::vector<double> crossings() const {
    std::vector<double> all{from, to};
    for (int a = 0; a < 3; ++a) {
      const double first = std::min(at(from)[a], at(to)[a]), last = std::max(at(from)[a], at(to)[a]);
      for (double plane = std::max(std::ceil(first), -1.0);
           plane <= std::min(last, kMostVoxels + 1.0) && dq[a] != 0; ++plane)
        all.push_back(std::clamp((plane - q[a]) / dq[a], from, to));
    }
    std::sort(all.begin(), all.end());
    return all;
  }
  // Where it is in a voxel that is larger by `more`; false: nowhere.
  bool inVoxel(const ivec3& voxel, double more, double& s0, double& s1) const {
    Line part = *this;
    for (int a = 0; a < 3; ++a) {
      part.keep(q[a] - (voxel[a] - more), dq[a]);
      part.keep(voxel[a] + 1 + more - q[a], -dq[a]);
    }
    s0 = part.from, s1 = part.to;
    return s0 <= s1;
  }
};

CageTruth::CageTruth(const CagedLevel& level, std::span<const glm::vec3> nodes,
                     const std::function<glm::vec3(const ivec3&)>& corner)
    : level_(level), side_(level.cage->side >> level.level), nodes_(nodes.begin(), nodes.end()) {
  const Cage& cage = *level.cage;
  // Nodes beside cubes inside, by place.
  std::map<std::tuple<int, int, int>, std::uint32_t> at_place;
  const int finest = cage.side >> cage.level;
  const auto mask_bytes = static_cast<std::uint32_t>(finest * finest * finest / 8);
  std::uint32_t face = 0, mask = 0;
  for (std::uint32_t i = 0; i < cage.cells(); ++i) {
    mask_at_.push_back(mask);
    if (cage.cell(i)[1] != 0) mask += mask_bytes;
    std::array<dvec3, 8> corners;
    for (int c = 0; c < 8; ++c) {
      corners[static_cast<std::size_t>(c)] = dvec3(nodes_[cage.node(i, c)]);
      const ivec3 p = cage.rest(cage.node(i, c)) / cage.side;
      for (int side = 0; side < 6; ++side)
        if (cage.beyond(i, side) == kCageInside && (c >> (side >> 1) & 1) == (side & 1))
          at_place[{p.x, p.y, p.z}] = cage.node(i, c);
    }
    add(cage.place(i), static_cast<int>(i), corners);
    cubes_.back().first_face = face;
    while (face < cage.faces() && cage.face(face) >> 5 == i) ++face;
    cubes_.back().end_face = face;
  }
  for (int n = 0; n < static_cast<int>(level.source.blocks.size()); ++n) {
    if (level.source.blocks[static_cast<std::size_t>(n)] != kInsideBlock) continue;
    const ivec3 place(n % cage.grid.x, n / cage.grid.x % cage.grid.y, n / cage.grid.x / cage.grid.y);
    std::array<dvec3, 8> corners;
    for (int c = 0; c < 8; ++c) {
      const ivec3 p = place + ivec3(c & 1, c >> 1 & 1, c >> 2);
      const auto found = at_place.find({p.x, p.y, p.z});
      corners[static_cast<std::size_t>(c)] =
          dvec3(found != at_place.end() ? nodes_[found->second] : corner(p));
    }
    const int before = inverted_;
    add(place, -1, corners);
    inverted_ = before;
  }
  for (std::size_t first = 0; first < cubes_.size(); first += kGroup) {
    Group group{{}, first, std::min(first + kGroup, cubes_.size())};
    for (std::size_t i = group.first; i < group.end; ++i)
      group.ball.middle += cubes_[i].ball.middle / static_cast<double>(group.end - group.first);
    for (std::size_t i = group.first; i < group.end; ++i)
      group.ball.radius =
          std::max(group.ball.radius,
                   glm::distance(group.ball.middle, cubes_[i].ball.middle) + cubes_[i].ball.radius + 1e-6);
    groups_.push_back(group);
  }
}

void CageTruth::add(const ivec3& place, int cell, const std::array<dvec3, 8>& corners) {
  Cube cube;
  cube.corner = side_ * place;
  cube.cell = cell;
  cube.first = tetrahedra_.size();
  for (const dvec3& p : corners) cube.ball.middle += p / 8.0;
  for (const dvec3& p : corners)
    cube.ball.radius = std::max(cube.ball.radius, glm::distance(p, cube.ball.middle));
  cube.ball.radius *= 1 + 8 * kMargin / side_;
  for (const CageTetrahedron& t : kCageTetrahedra) {
    glm::dmat3 posed, rest(0);
    for (int e = 0; e < 3; ++e) {
      posed[e] = corners[static_cast<std::size_t>(t.corners[e + 1])] -
                 corners[static_cast<std::size_t>(t.corners[e])];
      rest[e][t.axes[e]] = side_;
    }
    const double det = glm::determinant(posed) * glm::determinant(rest) / std::pow(side_, 6);
    if (!(det > 0)) {
      ++inverted_;
      continue;
    }
    Tetrahedron made{rest * glm::inverse(posed), dvec3(0), {t.axes[0], t.axes[1], t.axes[2]}, false};
    made.at = -(made.turn * corners[0]);
    // Against the level-0 volume at rest.
    made.thick = det > kThick * std::pow(static_cast<double>(level_.cage->side) / side_, 3);
    tetrahedra_.push_back(made);
  }
  cube.end = tetrahedra_.size();
  cubes_.push_back(cube);
}

// True if a voxel of the level, in the cube or beside it, is drawn by this cell or is joined to it.
bool CageTruth::isSolid(const Cube& cube, const ivec3& voxel) const {
  const Volume& volume = level_.volume;
  for (int a = 0; a < 3; ++a)
    if (voxel[a] < 0 || voxel[a] >= volume.size[a]) return false;
  const std::size_t index = static_cast<std::size_t>(voxel.x) +
                            static_cast<std::size_t>(volume.size.x) *
                                (static_cast<std::size_t>(voxel.y) +
                                 static_cast<std::size_t>(volume.size.y) * static_cast<std::size_t>(voxel.z));
  if (!volume.solid[index]) return false;
  const ivec3 in_cube = voxel - cube.corner;
  if (in_cube != glm::clamp(in_cube, ivec3(0), ivec3(side_ - 1))) return isJoined(cube, in_cube);
  if (cube.cell < 0 || level_.cage->cell(static_cast<std::uint32_t>(cube.cell))[1] == 0) return true;
  // A coarse voxel is of a piece if any of the finest ones in it is.
  const int above = level_.level - level_.cage->level +
                    (level_.coarser.empty() ? 0 : static_cast<int>(level_.coarser[index]));
  const int finest = level_.cage->side >> level_.cage->level, own = 1 << above;
  const ivec3 first = in_cube << (level_.level - level_.cage->level);
  const ivec3 coarse = own * (first / own);
  const std::uint8_t* const mask = &level_.source.masks[mask_at_[static_cast<std::size_t>(cube.cell)]];
  for (int i = 0; i < own * own * own; ++i) {
    const ivec3 v = coarse + ivec3(i % own, i / own % own, i / own / own);
    const int bit = v.x + finest * (v.y + finest * v.z);
    if (mask[bit >> 3] >> (bit & 7) & 1) return true;
  }
  return false;
}

// True if solid beside the cube goes on from that in it: no boundary is between them.
bool CageTruth::isJoined(const Cube& cube, const ivec3& voxel) const {
  if (cube.cell < 0) return true;
  for (int a = 0; a < 3; ++a) {
    const int side = voxel[a] < 0 ? 2 * a : voxel[a] >= side_ ? 2 * a + 1 : -1;
    if (side >= 0 && level_.cage->beyond(static_cast<std::uint32_t>(cube.cell), side) == kCageOutside)
      return false;
  }
  return true;
}

// The first point of the line in the solid grown by kMargin.
std::optional<double> CageTruth::firstPossible(const Cube& cube, const Line& line) const {
  const std::vector<double> crossings = line.crossings();
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const dvec3 a = line.at(crossings[i]), b = line.at(crossings[i + 1]);
    const ivec3 low(glm::clamp(glm::floor(glm::min(a, b) - 1.001 * kMargin), 0.0, double(side_)));
    const ivec3 high(glm::clamp(glm::floor(glm::max(a, b) + 1.001 * kMargin), -1.0, side_ - 1.0));
    std::optional<double> first;
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
          double s0, s1;
          if (!isSolid(cube, cube.corner + ivec3(x, y, z)) || !line.inVoxel({x, y, z}, kMargin, s0, s1))
            continue;
          if (!first || s0 < *first) first = s0;
        }
    if (first) return first;
  }
  return {};
}

// The first point of the line in the solid shrunk by kMargin.
std::optional<double> CageTruth::firstOwed(const Cube& cube, const Line& line) const {
  const std::vector<double> crossings = line.crossings();
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    double s = crossings[i];
    const double end = crossings[i + 1];
    const ivec3 voxel(glm::floor(line.at(0.5 * (s + end))));
    if (!isSolid(cube, cube.corner + voxel)) continue;
    // Behind all empty voxels, which are grown.
    bool pushed = true;
    while (pushed && s <= end) {
      pushed = false;
      for (int n = 0; n < 27; ++n) {
        const ivec3 beside = voxel + ivec3(n % 3, n / 3 % 3, n / 9) - 1;
        double s0, s1;
        if (n == 13 || isSolid(cube, cube.corner + beside) || !line.inVoxel(beside, kMargin, s0, s1))
          continue;
        if (s0 > s || s1 <= s) continue;
        s = s1;
        pushed = true;
      }
    }
    if (s < end) return s;
  }
  return {};
}

void CageTruth::search(const Cube& cube, const Tetrahedron& t, const dvec3& o, const dvec3& r, double s_max,
                       Truth& truth) const {
  const auto line = [&](double more, double to) {
    Line out{t.turn * o + t.at, t.turn * r, 0, to};
    const auto shares = [&](double before, double after, double before_slope, double after_slope) {
      out.keep(before - after + more, before_slope - after_slope);
    };
    const dvec3 &q = out.q, &d = out.dq;
    const auto [a, b, c] = t.axes;
    shares(side_, q[a], 0, d[a]);
    shares(q[a], q[b], d[a], d[b]);
    shares(q[b], q[c], d[b], d[c]);
    shares(q[c], 0, d[c], 0);
    // Where the part ends: within a voxel of a coarse level.
    const dvec3 extent = level_.volume.scale * dvec3(level_.volume.size0) - dvec3(cube.corner);
    for (int axis = 0; axis < 3; ++axis)
      out.keep(extent[axis] - q[axis] + (more > 0 ? more : -kMargin), -d[axis]);
    return out;
  };
  const Line grown = line(kMargin, std::min(s_max, truth.possible.value_or(s_max)));
  if (grown.from <= grown.to)
    if (const auto s = firstPossible(cube, grown); s && (!truth.possible || *s < *truth.possible))
      truth.possible = s;
  if (!t.thick) return;
  const Line exact = line(0, std::min(s_max, truth.owed.value_or(s_max)));
  if (exact.from < exact.to)
    if (const auto s = firstOwed(cube, exact); s && (!truth.owed || *s < *truth.owed)) truth.owed = s;
}

Truth CageTruth::truthOf(const dvec3& o, const dvec3& r, double s_max) const {
  Truth truth;
  for (const Group& group : groups_) {
    if (!meets(group.ball.middle, group.ball.radius, o, r, truth.owed.value_or(s_max))) continue;
    for (std::size_t i = group.first; i < group.end; ++i) {
      const Cube& cube = cubes_[i];
      if (!meets(cube.ball.middle, cube.ball.radius, o, r, truth.owed.value_or(s_max))) continue;
      for (std::size_t t = cube.first; t < cube.end; ++t) search(cube, tetrahedra_[t], o, r, s_max, truth);
    }
  }
  return truth;
}

std::vector<CageTruth::Start> CageTruth::starts(const dvec3& o, const dvec3& r, double s_max) const {
  std::vector<Start> all;
  const Cage& cage = *level_.cage;
  for (const Group& group : groups_) {
    if (!meets(group.ball.middle, group.ball.radius, o, r, s_max)) continue;
    for (std::size_t i = group.first; i < group.end; ++i) {
      const Cube& cube = cubes_[i];
      if (!meets(cube.ball.middle, cube.ball.radius, o, r, s_max)) continue;
      for (std::uint32_t f = cube.first_face; f < cube.end_face; ++f) {
        const std::uint32_t word = cage.face(f);
        const CageTetrahedron& t = kCageTetrahedra[word >> 2 & 7];
        const int face = static_cast<int>(word & 3);
        std::array<dvec3, 4> x;
        for (int c = 0; c < 4; ++c)
          x[static_cast<std::size_t>(c)] = dvec3(nodes_[cage.node(word >> 5, t.corners[c])]) - o;
        // Its corners so that they turn left as seen from outside, at rest.
        const bool even = (t.axes[1] + 3 - t.axes[0]) % 3 == 1;
        std::array<dvec3, 3> p{x[face == 0 ? 1 : 0], x[face < 2 ? 2 : 1], x[face == 3 ? 2 : 3]};
        if (even == (face % 2 == 1)) std::swap(p[1], p[2]);
        const double u = dot(r, cross(p[2], p[1])), v = dot(r, cross(p[0], p[2])),
                     w = dot(r, cross(p[1], p[0]));
        if (!(u >= 0 && v >= 0 && w >= 0) || u + v + w == 0) continue;
        const double s = (u * dot(p[0], r) + v * dot(p[1], r) + w * dot(p[2], r)) / (u + v + w);
        if (s >= 0 && s <= s_max) all.push_back({s, word});
      }
    }
  }
  std::sort(all.begin(), all.end(), [](const Start& a, const Start& b) { return a.s < b.s; });
  return all;
}

}  // namespace kelp::reference
