// SPDX-License-Identifier: MIT
// Cages against brute force: dense labels by flood fill, voxels that touch by trying all, nodes by following
// whoever touches.
#include "kelp/fields/cages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include <glm/common.hpp>

#include "kelp/fields/fields.h"
#include "kelp/formats/brick.h"
#include "support/naive_cages.h"
#include "volumes.h"

namespace kelp::test {
namespace {

using CellName = std::pair<int, int>;  // cube, piece

struct TrueCage {
  int side = 0, level = 0;
  glm::ivec3 grid{0}, size{0};
  std::vector<std::uint16_t> cuts;                   // of each voxel, or none
  std::vector<int> piece;                            // of each voxel; -1: empty
  std::map<int, int> pieces;                         // of each cube with solid
  std::set<std::pair<CellName, CellName>> touching;  // both ways
  std::map<CellName, std::set<CellName>> holds;      // finer cells
  std::set<int> full, inside;
  std::vector<CellName> cells;  // in Morton order
  std::map<CellName, std::uint32_t> numbers;
  std::vector<std::uint32_t> follows;  // one a node
  RawCage raw;

  int cubeAt(const glm::ivec3& at) const { return at.x + grid.x * (at.y + grid.y * at.z); }
  glm::ivec3 placeOf(int cube) const {
    return {cube % grid.x, cube / grid.x % grid.y, cube / grid.x / grid.y};
  }
  bool areCut(const glm::ivec3& a, const glm::ivec3& b) const {
    const glm::ivec3 by = b - a;
    if (by.z < 0 || (by.z == 0 && (by.y < 0 || (by.y == 0 && by.x < 0)))) return areCut(b, a);
    const int bit = by.z > 0 ? 8 + by.x + 3 * by.y : by.y > 0 ? 2 + by.x : 0;
    return !cuts.empty() && (cuts[static_cast<std::size_t>(a.x + size.x * (a.y + size.y * a.z))] >> bit & 1);
  }
  bool hasCube(const glm::ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < grid.x && at.y < grid.y && at.z < grid.z;
  }
};

template <class Visit>
void forEachAround(const glm::ivec3& at, const Visit& visit) {
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (x != 0 || y != 0 || z != 0) visit(at + glm::ivec3(x, y, z));
}

bool isSolid(const fields::Occupancy& solid, const glm::ivec3& v) {
  return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < solid.size.x && v.y < solid.size.y && v.z < solid.size.z &&
         solid.solid[solid.index(v)] != 0;
}

// Pieces of the cubes; those of a coarser cage in the order of their first finer cells.
void fillPieces(const fields::Occupancy& solid, const TrueCage* finer, TrueCage& cage) {
  cage.piece.assign(solid.solid.size(), -1);
  std::map<int, std::vector<std::pair<std::vector<int>, std::vector<std::size_t>>>> found;
  for (std::size_t i = 0; i < solid.solid.size(); ++i) {
    if (!solid.solid[i] || cage.piece[i] >= 0) continue;
    const int cube = cage.cubeAt(voxelAt(i, solid.size) / cage.side);
    std::vector<std::size_t> flood{i};
    std::vector<int> first{static_cast<int>(i)};
    cage.piece[i] = 0;
    for (std::size_t n = 0; n < flood.size(); ++n) {
      const glm::ivec3 v = voxelAt(flood[n], solid.size);
      if (finer) {
        const glm::ivec3 at = v / finer->side;
        const std::vector<int> its{at.z, at.y, at.x, finer->piece[flood[n]]};
        if (n == 0 || its < first) first = its;
      }
      forEachAround(v, [&](const glm::ivec3& to) {
        if (!isSolid(solid, to) || cage.cubeAt(to / cage.side) != cube) return;
        if (cage.piece[solid.index(to)] >= 0 || cage.areCut(v, to)) return;
        cage.piece[solid.index(to)] = 0;
        flood.push_back(solid.index(to));
      });
    }
    found[cube].emplace_back(first, flood);
  }
  for (auto& [cube, floods] : found) {
    std::sort(floods.begin(), floods.end());
    cage.pieces[cube] = static_cast<int>(floods.size());
    for (std::size_t p = 0; p < floods.size(); ++p)
      for (const std::size_t i : floods[p].second) cage.piece[i] = static_cast<int>(p);
  }
  for (std::size_t i = 0; finer && i < solid.solid.size(); ++i) {
    const glm::ivec3 v = voxelAt(i, solid.size);
    if (solid.solid[i])
      cage.holds[{cage.cubeAt(v / cage.side), cage.piece[i]}].insert(
          {finer->cubeAt(v / finer->side), finer->piece[i]});
  }
}

void findTouching(const fields::Occupancy& solid, const TrueCage* finer, TrueCage& cage) {
  std::map<int, int> voxels;
  for (std::size_t i = 0; i < solid.solid.size(); ++i) {
    if (!solid.solid[i]) continue;
    const glm::ivec3 v = voxelAt(i, solid.size);
    const int cube = cage.cubeAt(v / cage.side);
    ++voxels[cube];
    forEachAround(v, [&](const glm::ivec3& to) {
      if (!isSolid(solid, to) || cage.cubeAt(to / cage.side) == cube) return;
      if (cage.areCut(v, to)) return;
      cage.touching.insert(
          {{cube, cage.piece[i]}, {cage.cubeAt(to / cage.side), cage.piece[solid.index(to)]}});
    });
  }
  for (const auto& [cube, count] : voxels) {
    bool full = count == cage.side * cage.side * cage.side && cage.pieces[cube] == 1;
    if (finer)
      for (const CellName& cell : cage.holds[{cube, 0}]) full = full && finer->full.count(cell.first) != 0;
    if (!full) continue;
    cage.full.insert(cube);
    bool wrapped = true;
    forEachAround(cage.placeOf(cube), [&](const glm::ivec3& to) {
      const auto other = cage.hasCube(to) ? cage.pieces.find(cage.cubeAt(to)) : cage.pieces.end();
      if (other == cage.pieces.end()) return void(wrapped = false);
      for (int p = 0; p < other->second; ++p)
        wrapped = wrapped && cage.touching.count({{cube, 0}, {other->first, p}});
    });
    if (wrapped) cage.inside.insert(cube);
  }
}

void writeMasks(const fields::Occupancy& solid, TrueCage& cage) {
  const int side = cage.side >> cage.level;
  for (const CellName& cell : cage.cells) {
    if (cage.pieces.at(cell.first) == 1) continue;
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(side * side * side / 8));
    const glm::ivec3 low = cage.side * cage.placeOf(cell.first);
    for (std::size_t i = 0; i < solid.solid.size(); ++i) {
      const glm::ivec3 v = voxelAt(i, solid.size);
      if (cage.piece[i] != cell.second || cage.cubeAt(v / cage.side) != cell.first) continue;
      const glm::ivec3 at = (v - low) / (1 << cage.level);
      const int bit = at.x + side * (at.y + side * at.z);
      mask[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(1 << bit % 8);
    }
    cage.raw.masks.insert(cage.raw.masks.end(), mask.begin(), mask.end());
  }
}

// The finer cell that a node with these corners follows, and true if one of these cells holds it.
std::pair<std::uint32_t, bool> followOf(const TrueCage& cage, const TrueCage& finer, const glm::ivec3& point,
                                        const std::vector<CellName>& corners) {
  std::pair<int, std::uint32_t> best{INT32_MAX, 0};
  const auto consider = [&](const CellName& cell) {
    const auto number = finer.numbers.find(cell);
    if (number == finer.numbers.end()) return;  // inside
    const glm::ivec3 low = finer.side * finer.placeOf(cell.first);
    const glm::ivec3 gap = point * cage.side - glm::clamp(point * cage.side, low, low + finer.side);
    best = std::min(best, {gap.x * gap.x + gap.y * gap.y + gap.z * gap.z, number->second});
  };
  for (const CellName& corner : corners)
    for (const CellName& cell : cage.holds.at(corner)) consider(cell);
  const bool held = best.first != INT32_MAX;
  if (!held)
    for (const auto& [cell, number] : finer.numbers) consider(cell);
  return {best.second, held};
}

void findNodes(const TrueCage* finer, TrueCage& cage) {
  const glm::ivec3 points = cage.grid + 1;
  for (int p = 0; p < points.x * points.y * points.z; ++p) {
    const glm::ivec3 point(p % points.x, p / points.x % points.y, p / points.x / points.y);
    std::vector<CellName> all;  // that have a corner here, inside or not
    std::vector<std::pair<std::uint64_t, CellName>> corners;
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 at = point - glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      const auto found = cage.hasCube(at) ? cage.pieces.find(cage.cubeAt(at)) : cage.pieces.end();
      for (int piece = 0; found != cage.pieces.end() && piece < found->second; ++piece) {
        all.emplace_back(found->first, piece);
        if (!cage.inside.count(found->first)) corners.push_back({mortonCode(at), all.back()});
      }
    }
    std::sort(corners.begin(), corners.end());
    std::map<CellName, int> node;
    std::vector<std::uint8_t> numbers;
    int nodes = 0;
    std::vector<std::pair<std::uint32_t, bool>> follows;
    for (const auto& [code, cell] : corners) {
      if (!node.count(cell)) {
        std::vector<CellName> joined{cell};
        node[cell] = nodes;
        for (std::size_t n = 0; n < joined.size(); ++n) {
          for (const CellName& other : all) {
            if (node.count(other) || !cage.touching.count({joined[n], other})) continue;
            node[other] = nodes;
            joined.push_back(other);
          }
        }
        ++nodes;
        if (finer) {
          std::erase_if(joined, [&](const CellName& one) { return cage.inside.count(one.first) != 0; });
          follows.push_back(followOf(cage, *finer, point, joined));
        }
      }
      numbers.push_back(static_cast<std::uint8_t>(node[cell]));
    }
    std::set<int> sharing;  // a cube with another node
    for (const auto& a : corners)
      for (const auto& b : corners)
        if (a.second.first == b.second.first && node[a.second] != node[b.second])
          sharing.insert(node[a.second]);
    for (int n = 0; n < static_cast<int>(follows.size()); ++n) {
      const auto [follow, held] = follows[static_cast<std::size_t>(n)];
      cage.follows.push_back(follow);
      if (sharing.count(n) || !held) cage.raw.follows.push_back(follow);
    }
    if (nodes < 2) continue;
    cage.raw.split_points.push_back(static_cast<std::uint32_t>(p));
    cage.raw.splits.insert(cage.raw.splits.end(), numbers.begin(), numbers.end());
  }
}

TrueCage trueCage(const fields::Occupancy& solid, const std::vector<std::uint16_t>& cuts, int cell, int level,
                  const TrueCage* finer) {
  TrueCage cage;
  cage.cuts = cuts;
  cage.level = level;
  cage.side = cageSide(cell, cage.level);
  cage.size = solid.size;
  cage.grid = cageGrid(solid.size, cage.side);
  fillPieces(solid, finer, cage);
  findTouching(solid, finer, cage);
  const int cubes = cage.grid.x * cage.grid.y * cage.grid.z;
  std::vector<std::pair<std::uint64_t, int>> order;
  for (int c = 0; c < cubes; ++c) {
    cage.raw.blocks.push_back(cage.inside.count(c)   ? kInsideBlock
                              : cage.pieces.count(c) ? static_cast<std::uint8_t>(cage.pieces[c])
                                                     : std::uint8_t{0});
    if (cage.pieces.count(c) && !cage.inside.count(c)) order.emplace_back(mortonCode(cage.placeOf(c)), c);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [code, c] : order)
    for (int p = 0; p < cage.pieces[c]; ++p) {
      cage.numbers[{c, p}] = static_cast<std::uint32_t>(cage.cells.size());
      cage.cells.emplace_back(c, p);
    }
  writeMasks(solid, cage);
  findNodes(finer, cage);
  return cage;
}

int levelsOf(const glm::ivec3& size) {
  int levels = 1;
  while (std::max({size.x, size.y, size.z}) > kBrickSide << (levels - 1)) ++levels;
  return levels;
}

struct InMemory {
  InMemory(const fields::Occupancy& solid, int levels, int cell, const std::vector<std::uint16_t>& cuts = {})
      : raw(fields::buildCages(fields::SolidBits(solid, 1), levels, cell, cuts)), memory(raw.size()) {
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const Result<Cage> made = makeCage(raw[i].source(), solid.size, levels, cell, static_cast<int>(i),
                                         i > 0 ? &cages[i - 1] : nullptr, 1u << 30, memory[i]);
      EXPECT_TRUE(made) << made.error().detail;
      if (!made) return;
      cages.push_back(*made);
    }
  }

  std::vector<RawCage> raw;
  std::vector<Cage> cages;
  std::vector<CageMemory> memory;
};

void expectTrue(const NamedVolume& volume, const std::vector<std::uint16_t>& cuts) {
  const glm::ivec3& size = volume.occupancy.size;
  for (const int cell : {2, 4, 8, 16}) {
    const int levels = levelsOf(size);
    const InMemory cages(volume.occupancy, levels, cell, cuts);
    ASSERT_EQ(static_cast<int>(cages.cages.size()), levels);
    std::vector<TrueCage> truth;
    for (int i = 0; i < levels; ++i) {
      SCOPED_TRACE(volume.name + ", cells of " + std::to_string(cell) + ", cage " + std::to_string(i));
      truth.push_back(trueCage(volume.occupancy, cuts, cell, i, i > 0 ? &truth.back() : nullptr));
      const RawCage &made = cages.raw[static_cast<std::size_t>(i)], &expected = truth.back().raw;
      ASSERT_EQ(made.blocks, expected.blocks);
      ASSERT_EQ(made.masks, expected.masks);
      ASSERT_EQ(made.split_points, expected.split_points);
      ASSERT_EQ(made.splits, expected.splits);
      ASSERT_EQ(made.follows, expected.follows);
      const Cage& cage = cages.cages[static_cast<std::size_t>(i)];
      ASSERT_EQ(followWords(cage), followWords(truth.back().follows, cage,
                                               cages.cages[static_cast<std::size_t>(std::max(i - 1, 0))]));
    }
  }
}

TEST(Cages, AreThoseOfBruteForce) {
  for (const NamedVolume& volume : cageVolumes()) {
    expectTrue(volume, {});
    if (HasFatalFailure()) return;
  }
}

// Neighbors of different labels do not touch.
std::vector<std::uint16_t> cutsBetween(const glm::ivec3& size,
                                       const std::function<int(const glm::ivec3&)>& label) {
  std::vector<std::uint16_t> cuts(emptyVolume(size).solid.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const glm::ivec3 at = voxelAt(i, size);
    for (int code = 14; code < 27; ++code) {
      const glm::ivec3 by(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
      if (label(at) != label(at + by)) cuts[i] |= fields::cutBit(by);
    }
  }
  return cuts;
}

// No cut at all; slanted slabs; a ball in a rest; stripes thinner than cells; a plane cut half way; noise.
TEST(Cages, WithCutsAreThoseOfBruteForce) {
  const auto cutsOf = [](const glm::ivec3& size, std::size_t pattern) {
    if (pattern == 5) {
      std::vector<std::uint16_t> cuts(emptyVolume(size).solid.size());
      std::mt19937 random(9);
      for (std::uint16_t& cut : cuts)
        for (int bit = 0; bit < 13; ++bit)
          if (random() % 8 == 0) cut |= static_cast<std::uint16_t>(1 << bit);
      return cuts;
    }
    return cutsBetween(size, [&](const glm::ivec3& v) {
      return pattern == 1   ? (v.x + 2 * v.y + 3 * v.z + 100) / 37 % 3
             : pattern == 2 ? static_cast<int>(glm::dot(glm::vec3(v - 11), glm::vec3(v - 11)) < 60)
             : pattern == 3 ? (v.y + 3) % 3
             : pattern == 4 ? static_cast<int>(v.x > 9 && v.y < 10)
                            : 7;
    });
  };
  const std::vector<NamedVolume> volumes = cageVolumes();
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    SCOPED_TRACE("cuts " + std::to_string(i % 5));
    expectTrue(volumes[i], cutsOf(volumes[i].occupancy.size, i % 5));
    if (HasFatalFailure()) return;
  }
  const glm::ivec3 size(19, 18, 17);
  for (std::size_t pattern = 0; pattern < 6; ++pattern) {
    SCOPED_TRACE("cuts " + std::to_string(pattern));
    expectTrue({"full", volumeWhere(size, [](const glm::ivec3&) { return true; })}, cutsOf(size, pattern));
    if (HasFatalFailure()) return;
  }
}

// The cells that hold a voxel of a level.
std::vector<std::uint32_t> holding(const Cage& cage, const std::vector<std::vector<std::uint32_t>>& cells_of,
                                   const glm::ivec3& voxel, int level) {
  std::vector<std::uint32_t> found;
  const int side = cage.side >> level;
  const glm::ivec3 at = voxel / side, in = voxel - side * at;
  for (const std::uint32_t c :
       cells_of[static_cast<std::size_t>(at.x + cage.grid.x * (at.y + cage.grid.y * at.z))]) {
    if (cage.cell(c)[1] == 0) return {c};
    const auto bit = static_cast<std::uint32_t>(in.x + side * (in.y + side * in.z));
    if (cage.words[cage.maskAt(c, level) + bit / 32] >> bit % 32 & 1) found.push_back(c);
  }
  return found;
}

void expectVoxelsHeld(const InMemory& made, int level, const fields::Occupancy& solid) {
  const auto number = static_cast<std::size_t>(level);
  const Cage& cage = made.cages[number];
  const auto indexOf = [&](const glm::ivec3& at) {
    return static_cast<std::size_t>(at.x + cage.grid.x * (at.y + cage.grid.y * at.z));
  };
  std::vector<std::vector<std::uint32_t>> cells_of(made.raw[number].blocks.size());
  for (std::uint32_t c = 0; c < cage.cells(); ++c) cells_of[indexOf(cage.place(c))].push_back(c);
  const int side = cage.side >> level;
  for (std::size_t i = 0; i < solid.solid.size(); ++i) {
    if (!solid.solid[i]) continue;
    const glm::ivec3 v = voxelAt(i, solid.size), at = v / side;
    const std::vector<std::uint32_t> cells = holding(cage, cells_of, v, level);
    if (cells.empty()) {
      ASSERT_EQ(made.raw[number].blocks[indexOf(at)], kInsideBlock);
      continue;
    }
    if (level > 0) continue;
    ASSERT_EQ(cells.size(), 1u);
    forEachAround(v, [&](const glm::ivec3& to) {
      if (!isSolid(solid, to) || to / side == at) return;
      const std::vector<std::uint32_t> other = holding(cage, cells_of, to, 0);
      for (int corner = 0; corner < 8 && !other.empty(); ++corner) {
        const glm::ivec3 in = at + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2) - to / side;
        if (std::min({in.x, in.y, in.z}) < 0 || std::max({in.x, in.y, in.z}) > 1) continue;
        ASSERT_EQ(cage.node(cells[0], corner), cage.node(other[0], in.x + 2 * in.y + 4 * in.z));
      }
    });
  }
}

TEST(Cages, HoldEachVoxelOfEachLevelAndShareNodesWhereVoxelsTouch) {
  for (const NamedVolume& volume : cageVolumes()) {
    const int levels = levelsOf(volume.occupancy.size);
    for (const int cell : {2, 4, 8, 16}) {
      const InMemory made(volume.occupancy, levels, cell);
      if (HasFailure()) FAIL() << volume.name;
      fields::Occupancy solid = volume.occupancy;
      for (int level = 0; level < levels; ++level) {
        SCOPED_TRACE(volume.name + ", cells of " + std::to_string(cell) + ", level " + std::to_string(level));
        if (level > 0) solid = fields::coarser(solid);
        expectVoxelsHeld(made, level, solid);
        if (HasFailure()) return;
      }
    }
  }
}

TEST(Cages, OfMorePiecesAndNodesThanCanBeNumberedJoinTheLast) {
  const InMemory made(
      volumeWhere({32, 32, 32}, [](const glm::ivec3& v) { return v.x % 2 + v.y % 2 + v.z % 2 == 0; }), 2, 16);
  ASSERT_EQ(made.raw.size(), 2u);
  EXPECT_EQ(made.raw[0].blocks, std::vector<std::uint8_t>(8, 254));
  EXPECT_EQ(*std::max_element(made.raw[0].splits.begin(), made.raw[0].splits.end()), 255);
  EXPECT_EQ(made.raw[1].blocks, std::vector<std::uint8_t>(1, 254));
}

TEST(Cages, OfALevelAreThoseOfItsVoxels) {
  const fields::Occupancy volume = cageVolumes()[0].occupancy;
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t i : fields::surfaceVoxels(volume, 1)) surface.push_back({i, 0});
  const std::vector<RawCage> some = fields::buildCages(fields::buildLevel(volume, surface, 1), volume.size, 3,
                                                       4),
                             same = fields::buildCages(fields::SolidBits(volume, 1), 3, 4);
  ASSERT_EQ(some.size(), same.size());
  EXPECT_EQ(some[0].blocks, same[0].blocks);
  EXPECT_EQ(some[0].masks, same[0].masks);
  EXPECT_EQ(some[1].follows, same[1].follows);
}

TEST(Cages, RefuseWhatFormatsDoNotKnow) {
  const fields::SolidBits empty(glm::ivec3(8)),
      full(volumeWhere({513, 2, 2}, [](const glm::ivec3&) { return true; }), 1);
  EXPECT_THROW(fields::buildCages(empty, 1, 8), std::invalid_argument);
  EXPECT_THROW(fields::buildCages(full, 1, 3), std::invalid_argument);
  EXPECT_THROW(fields::buildCages(full, 1, 2), std::invalid_argument);
  EXPECT_EQ(fields::buildCages(full, 1, 4).size(), 1u);
  const std::vector<std::uint16_t> few(7);
  EXPECT_THROW(fields::buildCages(full, 1, 4, few), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test
