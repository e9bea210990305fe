// SPDX-License-Identifier: MIT
// Cages of small solids, made in the plainest way: every cube looks at every voxel, every cell at every
// other.
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "kelp/formats/raw_pack.h"

namespace kelp::test {

using IsSolid = std::function<bool(const glm::ivec3&)>;  // level-0 voxels, of any place

class NaiveCage {
 public:
  struct Cell {
    glm::ivec3 cube;
    std::vector<glm::ivec3> voxels;  // of level 0
  };
  struct Node {
    glm::ivec3 point;
    std::vector<std::size_t> cells;  // whose corner it is
  };

  int side = 0, level = 0;
  glm::ivec3 grid{0};
  std::vector<Cell> cells;  // in the order of the format
  std::vector<Node> nodes;
  std::vector<std::uint32_t> follows;  // one a node
  RawCage raw;

  NaiveCage(const glm::ivec3& size, int cell, int of_level, const IsSolid& solid)
      : side(cageSide(cell, of_level)), level(of_level), grid(cageGrid(size, side)) {
    raw.blocks.resize(static_cast<std::size_t>(grid.x * grid.y * grid.z));
    std::vector<glm::ivec3> cubes;
    for (int i = 0; i < grid.x * grid.y * grid.z; ++i)
      cubes.emplace_back(i % grid.x, i / grid.x % grid.y, i / grid.x / grid.y);
    for (const glm::ivec3& cube : cubes) raw.blocks[at(cube)] = isInside(cube, solid) ? kInsideBlock : 0;
    std::sort(cubes.begin(), cubes.end(),
              [](const glm::ivec3& a, const glm::ivec3& b) { return mortonCode(a) < mortonCode(b); });
    for (const glm::ivec3& cube : cubes)
      if (raw.blocks[at(cube)] == 0) addCells(cube, solid);
    nameNodes();
  }

  // Nodes that share a cube with another at their point, and those without a finer cell in the cubes of their
  // cells, follow the nearest of all finer cells.
  void follow(const NaiveCage& finer) {
    for (const Node& node : nodes) {
      const auto has = [&](std::size_t cell) {
        return std::find(node.cells.begin(), node.cells.end(), cell) != node.cells.end();
      };
      const auto isAround = [&](const glm::ivec3& cube) {
        return std::any_of(node.cells.begin(), node.cells.end(),
                           [&](std::size_t cell) { return cells[cell].cube == cube; });
      };
      bool told = true;
      for (std::size_t cell = 0; cell < cells.size(); ++cell)
        told = told && (has(cell) || !isAround(cells[cell].cube));
      const auto around = nearestOf(finer, node.point, isAround);
      told = told && around != finer.cells.size();
      const auto one = told ? around : nearestOf(finer, node.point, [](const glm::ivec3&) { return true; });
      follows.push_back(static_cast<std::uint32_t>(one));
      if (!told) raw.follows.push_back(follows.back());
    }
  }

 private:
  // The finer cell that is nearest to a point, of those whose cube of this cage will do.
  std::size_t nearestOf(const NaiveCage& finer, const glm::ivec3& point,
                        const std::function<bool(const glm::ivec3&)>& will_do) const {
    std::size_t nearest = finer.cells.size();
    int least = 1 << 30;
    for (std::size_t i = 0; i < finer.cells.size(); ++i) {
      const glm::ivec3 low = finer.cells[i].cube * finer.side;
      const glm::ivec3 off = point * side - glm::clamp(point * side, low, low + finer.side);
      const int distance = off.x * off.x + off.y * off.y + off.z * off.z;
      if (distance >= least || !will_do(low / side)) continue;
      least = distance;
      nearest = i;
    }
    return nearest;
  }

  std::size_t at(const glm::ivec3& cube) const {
    return static_cast<std::size_t>(cube.x + grid.x * (cube.y + grid.y * cube.z));
  }

  // All of the 27 cubes are full.
  bool isInside(const glm::ivec3& cube, const IsSolid& solid) const {
    for (int x = -side; x < 2 * side; ++x)
      for (int y = -side; y < 2 * side; ++y)
        for (int z = -side; z < 2 * side; ++z)
          if (!solid(cube * side + glm::ivec3(x, y, z))) return false;
    return true;
  }

  static bool touch(const glm::ivec3& a, const glm::ivec3& b) {
    const glm::ivec3 off = glm::abs(a - b);
    return std::max({off.x, off.y, off.z}) <= 1;
  }

  void addCells(const glm::ivec3& cube, const IsSolid& solid) {
    const auto count_of = static_cast<std::size_t>(side * side * side);
    const auto voxelOf = [&](std::size_t i) {
      const int v = static_cast<int>(i);
      return cube * side + glm::ivec3(v % side, v / side % side, v / side / side);
    };
    std::vector<bool> left(count_of);
    for (std::size_t i = 0; i < count_of; ++i) left[i] = solid(voxelOf(i));
    const std::size_t first = cells.size();
    for (std::size_t start = 0; start < count_of; ++start) {
      if (!left[start]) continue;
      left[start] = false;
      std::vector<glm::ivec3> piece = {voxelOf(start)};
      for (std::size_t i = 0; i < piece.size(); ++i) {
        for (int j = 0; j < 27; ++j) {
          const glm::ivec3 in = piece[i] + glm::ivec3(j % 3, j / 3 % 3, j / 9) - 1 - cube * side;
          if (in != glm::clamp(in, glm::ivec3(0), glm::ivec3(side - 1))) continue;
          const auto at = static_cast<std::size_t>(in.x + side * (in.y + side * in.z));
          if (!left[at]) continue;
          left[at] = false;
          piece.push_back(voxelOf(at));
        }
      }
      cells.push_back({cube, piece});
    }
    const std::size_t count = cells.size() - first;
    raw.blocks[at(cube)] = static_cast<std::uint8_t>(count);
    if (count < 2) return;
    const int finest = side >> level;
    for (std::size_t i = first; i < cells.size(); ++i) {
      std::vector<std::uint8_t> mask(static_cast<std::size_t>(finest * finest * finest / 8));
      for (const glm::ivec3& voxel : cells[i].voxels) {
        const glm::ivec3 in = (voxel - cube * side) / (1 << level);
        const int bit = in.x + finest * (in.y + finest * in.z);
        mask[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(1 << bit % 8);
      }
      raw.masks.insert(raw.masks.end(), mask.begin(), mask.end());
    }
  }

  bool touch(const Cell& a, const Cell& b) const {
    if (!touch(a.cube, b.cube) || a.cube == b.cube) return false;
    const auto beside = [this](const Cell& cell, const glm::ivec3& cube) {
      std::vector<glm::ivec3> out;
      for (const glm::ivec3& v : cell.voxels)
        if (v == glm::clamp(v, cube * side - 1, cube * side + side)) out.push_back(v);
      return out;
    };
    const std::vector<glm::ivec3> of_a = beside(a, b.cube), of_b = beside(b, a.cube);
    for (const glm::ivec3& v : of_a)
      for (const glm::ivec3& w : of_b)
        if (touch(v, w)) return true;
    return false;
  }

  void nameNodes() {
    struct Corner {
      glm::ivec3 point;
      std::size_t cell;
    };
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (int c = 0; c < 8; ++c)
        corners.push_back({cells[i].cube + glm::ivec3(c & 1, c >> 1 & 1, c >> 2), i});
    const auto index = [&](const glm::ivec3& p) { return p.x + (grid.x + 1) * (p.y + (grid.y + 1) * p.z); };
    std::stable_sort(corners.begin(), corners.end(),
                     [&](const Corner& a, const Corner& b) { return index(a.point) < index(b.point); });
    for (std::size_t first = 0, end = 0; first < corners.size(); first = end) {
      while (end < corners.size() && corners[end].point == corners[first].point) ++end;
      // Corners of cells that touch get the least number of the two, until nothing changes.
      std::vector<std::size_t> root(end - first);
      std::iota(root.begin(), root.end(), std::size_t{0});
      for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t a = 0; a < root.size(); ++a) {
          for (std::size_t b = 0; b < root.size(); ++b) {
            if (root[a] >= root[b] || !touch(cells[corners[first + a].cell], cells[corners[first + b].cell]))
              continue;
            root[b] = root[a];
            changed = true;
          }
        }
      }
      std::vector<std::size_t> seen;
      std::vector<std::uint8_t> numbers;
      for (const std::size_t r : root) {
        const auto found = std::find(seen.begin(), seen.end(), r);
        numbers.push_back(static_cast<std::uint8_t>(found - seen.begin()));
        if (found == seen.end()) seen.push_back(r);
      }
      const std::size_t first_node = nodes.size();
      nodes.insert(nodes.end(), seen.size(), Node{corners[first].point, {}});
      for (std::size_t i = 0; i < numbers.size(); ++i)
        nodes[first_node + numbers[i]].cells.push_back(corners[first + i].cell);
      if (seen.size() < 2) continue;
      raw.split_points.push_back(static_cast<std::uint32_t>(index(corners[first].point)));
      raw.splits.insert(raw.splits.end(), numbers.begin(), numbers.end());
    }
  }
};

// Cage::follows, of nodes that follow these cells of the next finer cage.
inline std::vector<std::uint32_t> followWords(const std::vector<std::uint32_t>& cells, const Cage& cage,
                                              const Cage& finer) {
  std::vector<std::uint32_t> words;
  for (std::uint32_t node = 0; node < cells.size(); ++node) {
    std::uint32_t word = kFollowsAll | cells[node];
    for (int corner = 0; corner < 8; ++corner)
      if (finer.rest(finer.node(cells[node], corner)) == cage.rest(node))
        word = finer.node(cells[node], corner);
    words.push_back(word);
  }
  return words;
}
inline std::vector<std::uint32_t> followWords(const Cage& cage) {
  return {cage.follows.begin(), cage.follows.end()};
}

// Gives a part of that many levels its cages. Its size and levels are set.
inline void addNaiveCages(RawPart& part, int cell, const IsSolid& solid) {
  part.cell = cell;
  std::vector<NaiveCage> cages;
  for (int i = 0; i < static_cast<int>(part.levels.size()); ++i) {
    cages.emplace_back(part.size, cell, i, solid);
    if (i > 0) cages[static_cast<std::size_t>(i)].follow(cages[static_cast<std::size_t>(i) - 1]);
    part.cages.push_back(cages.back().raw);
  }
}

// The influences of a coarser cage's nodes: those of the finer node that is the nearest of the followed
// cell's.
inline std::vector<Influences> coarserInfluences(const Cage& cage, const Cage& finer,
                                                 const std::vector<Influences>& of_finer) {
  std::vector<Influences> influences;
  for (std::uint32_t node = 0; node < cage.nodes() && !of_finer.empty(); ++node) {
    std::uint32_t nearest = cage.follows[node];
    if (nearest & kFollowsAll) {
      const std::uint32_t cell = nearest & ~kFollowsAll;
      const auto far = [&](int corner) {
        const glm::ivec3 off = finer.rest(finer.node(cell, corner)) - cage.rest(node);
        return std::int64_t{off.x} * off.x + std::int64_t{off.y} * off.y + std::int64_t{off.z} * off.z;
      };
      int best = 0;
      for (int corner = 1; corner < 8; ++corner)
        if (far(corner) < far(best)) best = corner;
      nearest = finer.node(cell, best);
    }
    influences.push_back(of_finer[nearest]);
  }
  return influences;
}

// Lets the nodes of a part with cages, the one with the number `own`, follow some of so many parts.
inline void addInfluences(RawPart& part, std::size_t own, std::size_t parts, std::uint32_t seed) {
  CageMemory memory;
  const Cage cage = makeCage(part.cages[0].source(), part.size, static_cast<int>(part.levels.size()),
                             part.cell, 0, nullptr, ~std::uint64_t{0}, memory)
                        .value();
  std::mt19937 random(seed);
  part.influences.assign(cage.nodes(), {});
  for (Influences& node : part.influences) {
    std::set<std::size_t> chosen;
    const std::size_t count = 1 + random() % std::min<std::size_t>(4, parts - 1);
    while (chosen.size() < count)
      if (const std::size_t one = random() % parts; one != own) chosen.insert(one);
    std::uint32_t left = 255, i = 0;
    for (const std::size_t one : chosen) {
      const auto others = static_cast<std::uint32_t>(count) - 1 - i;
      const std::uint32_t weight = others == 0 ? left : 1 + random() % (left - others);
      node.parts[i] = static_cast<std::uint16_t>(one);
      node.weights[i++] = static_cast<std::uint8_t>(weight);
      left -= weight;
    }
  }
}

// The offsets of a coarser cage's nodes, in steps, from those of the finer one's.
inline std::vector<glm::dvec3> coarserOffsets(const Cage& cage, const Cage& finer,
                                              const std::vector<glm::dvec3>& of_finer) {
  std::vector<glm::dvec3> offsets;
  for (std::uint32_t node = 0; node < cage.nodes(); ++node) {
    if (!(cage.follows[node] & kFollowsAll)) {
      offsets.push_back(of_finer[cage.follows[node]]);
      continue;
    }
    const std::uint32_t cell = cage.follows[node] & ~kFollowsAll;
    const glm::dvec3 f =
        glm::dvec3(cage.rest(node) - finer.rest(finer.node(cell, 0))) / static_cast<double>(finer.side);
    glm::dvec3 sum(0);
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 0.125;
      for (int axis = 0; axis < 3; ++axis) weight += (corner >> axis & 1 ? 0.25 : -0.25) * (f[axis] - 0.5);
      sum += weight * of_finer[finer.node(cell, corner)];
    }
    offsets.push_back(sum);
  }
  return offsets;
}

// Lets morph targets move some nodes of a part with cages.
inline void addMorphs(RawPart& part, const std::vector<std::uint32_t>& targets, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (const std::uint32_t target : targets) {
    RawMorph& morph = part.morphs.emplace_back();
    morph.part = target;
    morph.step = 1.0f / static_cast<float>(1 + random() % 100);
    for (std::uint32_t node = 0; node < part.influences.size(); ++node) {
      if (random() % 3 > 0) continue;
      morph.nodes.push_back(node);
      glm::ivec3& offset = morph.offsets.emplace_back();
      for (const int axis : {2, 1, 0}) offset[axis] = static_cast<int>(random() % 601) - 300;
      if (offset == glm::ivec3(0)) offset.x = 1;
    }
  }
}

// The solid voxels of a raw level 0.
inline IsSolid solidOf(const RawPart& part) {
  return [&part](const glm::ivec3& voxel) {
    for (int axis = 0; axis < 3; ++axis)
      if (voxel[axis] < 0 || voxel[axis] >= part.size[axis]) return false;
    const glm::ivec3 grid = brickGrid(part.size), brick = voxel / 8;
    const std::uint32_t cell =
        part.levels[0].cells[static_cast<std::size_t>(brick.x + grid.x * (brick.y + grid.y * brick.z))];
    if (isStoredCell(cell)) {
      const std::size_t at = std::size_t{cell & kCellSlotMask} * kBrickVoxels;
      return part.levels[0].codes[at + static_cast<std::size_t>(codeIndex(voxel))] >= kSurfaceCode;
    }
    return (cell & kCellSolid) != 0;
  };
}

}  // namespace kelp::test
