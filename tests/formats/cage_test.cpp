// SPDX-License-Identifier: MIT
// Cages that makeCage() makes, against cells, faces and nodes that are compared each with each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <random>
#include <set>

#include "tiny_cage_pack.h"

namespace kelp {
namespace {

using test::IsSolid;
using test::NaiveCage;

constexpr std::uint64_t kAnyMemory = std::uint64_t{1} << 40;

struct MadeCage {
  CageMemory memory;
  Cage cage;
};

// Nodes of the corners of a naive cage's cells: by the numbers in its source.
std::vector<std::array<std::uint32_t, 8>> cornersOf(const NaiveCage& naive) {
  std::map<std::uint32_t, std::vector<std::pair<std::size_t, int>>> points;
  for (std::size_t i = 0; i < naive.cells.size(); ++i) {
    for (int c = 0; c < 8; ++c) {
      const glm::ivec3 p = naive.cells[i].cube + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
      points[static_cast<std::uint32_t>(p.x + (naive.grid.x + 1) * (p.y + (naive.grid.y + 1) * p.z))]
          .emplace_back(i, c);
    }
  }
  std::vector<std::array<std::uint32_t, 8>> out(naive.cells.size());
  std::uint32_t first = 0;
  std::size_t next = 0;
  for (const auto& [point, corners] : points) {
    const bool split =
        std::binary_search(naive.raw.split_points.begin(), naive.raw.split_points.end(), point);
    std::uint32_t most = 0;
    for (const auto& [cell, corner] : corners) {
      const std::uint32_t number = split ? naive.raw.splits[next++] : 0;
      out[cell][static_cast<std::size_t>(corner)] = first + number;
      most = std::max(most, number);
    }
    first += most + 1;
  }
  EXPECT_EQ(first, naive.nodes.size());
  return out;
}

using Quad = std::array<std::uint32_t, 4>;

// Face 0 .. 5 of a cell by its nodes, sorted.
Quad quadOf(const std::array<std::uint32_t, 8>& corners, int face) {
  std::vector<std::uint32_t> nodes;
  for (int c = 0; c < 8; ++c)
    if ((c >> face / 2 & 1) == face % 2) nodes.push_back(corners[static_cast<std::size_t>(c)]);
  Quad quad{nodes[0], nodes[1], nodes[2], nodes[3]};
  std::sort(quad.begin(), quad.end());
  return quad;
}

// The face of the cell in which three corners of it lie, or -1.
int faceOf(const std::set<int>& corners) {
  for (int face = 0; face < 6; ++face)
    if (std::all_of(corners.begin(), corners.end(), [&](int c) { return (c >> face / 2 & 1) == face % 2; }))
      return face;
  return -1;
}

void expectMasks(const NaiveCage& naive, const Cage& cage, std::uint32_t i) {
  const auto blocks = naive.raw.blocks;
  const glm::ivec3 cube = naive.cells[i].cube;
  const bool alone =
      blocks[static_cast<std::size_t>(cube.x + naive.grid.x * (cube.y + naive.grid.y * cube.z))] == 1;
  std::uint32_t at = cage.cell(i)[1];
  ASSERT_EQ(at == 0, alone);
  for (int level = cage.level; level <= cage.last_level && !alone; ++level) {
    const int side = cage.side >> level;
    std::set<int> bits;
    for (const glm::ivec3& voxel : naive.cells[i].voxels) {
      const glm::ivec3 in = (voxel - cube * cage.side) / (1 << level);
      bits.insert(in.x + side * (in.y + side * in.z));
    }
    for (int bit = 0; bit < side * side * side; ++bit) {
      const std::uint32_t word = cage.words[at + static_cast<std::uint32_t>(bit / 32)];
      ASSERT_EQ(word >> bit % 32 & 1, bits.count(bit)) << "level " << level << " bit " << bit;
    }
    at += static_cast<std::uint32_t>((side * side * side + 31) / 32);
  }
}

// Compares a cage with what follows from the naive one.
void expectCage(const NaiveCage& naive, const Cage& cage) {
  ASSERT_EQ(cage.side, naive.side);
  ASSERT_EQ(cage.grid, naive.grid);
  ASSERT_EQ(cage.cells(), naive.cells.size());
  ASSERT_EQ(cage.nodes(), naive.nodes.size());
  ASSERT_EQ(cage.places.size(), naive.nodes.size());
  EXPECT_EQ(cage.words[3], static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(naive.side)) |
                                                      cage.level << 8 | cage.last_level << 16));
  for (std::uint32_t i = 0; i < cage.nodes(); ++i) EXPECT_EQ(cage.rest(i), naive.nodes[i].point * naive.side);

  const auto corners = cornersOf(naive);
  std::map<Quad, std::vector<std::uint32_t>> sharing;
  for (std::uint32_t i = 0; i < cage.cells(); ++i)
    for (int face = 0; face < 6; ++face) sharing[quadOf(corners[i], face)].push_back(i);
  std::vector<std::uint32_t> boundary;
  for (std::uint32_t i = 0; i < cage.cells(); ++i) {
    ASSERT_EQ(cage.place(i), naive.cells[i].cube);
    for (int c = 0; c < 8; ++c) ASSERT_EQ(cage.node(i, c), corners[i][static_cast<std::size_t>(c)]);
    std::array<std::uint32_t, 6> beyond{};
    for (int face = 0; face < 6; ++face) {
      glm::ivec3 next = naive.cells[i].cube;
      next[face / 2] += face % 2 ? 1 : -1;
      const auto index = static_cast<std::size_t>(next.x + naive.grid.x * (next.y + naive.grid.y * next.z));
      const bool inside = glm::all(glm::greaterThanEqual(next, glm::ivec3(0))) &&
                          glm::all(glm::lessThan(next, naive.grid)) &&
                          naive.raw.blocks[index] == kInsideBlock;
      const std::vector<std::uint32_t>& cells = sharing[quadOf(corners[i], face)];
      std::uint32_t expected = inside ? kCageInside : kCageOutside;
      if (!inside && cells.size() == 2) expected = cells[0] == i ? cells[1] : cells[0];
      beyond[static_cast<std::size_t>(face)] = expected;
      ASSERT_EQ(cage.beyond(i, face), expected) << "cell " << i << " face " << face;
    }
    for (std::uint32_t t = 0; t < 6; ++t) {
      for (std::uint32_t f = 0; f < 4; ++f) {
        std::set<int> three;
        for (std::uint32_t c = 0; c < 4; ++c)
          if (c != f) three.insert(kCageTetrahedra[t].corners[c]);
        const int face = faceOf(three);
        if (face >= 0 && beyond[static_cast<std::size_t>(face)] == kCageOutside)
          boundary.push_back(i << 5 | t << 2 | f);
      }
    }
    expectMasks(naive, cage, i);
  }
  ASSERT_EQ(cage.faces(), boundary.size());
  for (std::uint32_t i = 0; i < cage.faces(); ++i) EXPECT_EQ(cage.face(i), boundary[i]);
}

// Makes the cages of a solid, naive ones and others, and compares them.
void expectCages(const glm::ivec3& size, int levels, int cell, const IsSolid& solid) {
  std::vector<NaiveCage> naive;
  std::vector<MadeCage> made(static_cast<std::size_t>(levels));
  for (int i = 0; i < levels; ++i) {
    const auto at = static_cast<std::size_t>(i);
    naive.emplace_back(size, cell, i, solid);
    if (i > 0) naive[at].follow(naive[at - 1]);
    const CageSource source = naive[at].raw.source();
    const Result<Cage> cage = makeCage(source, size, levels, cell, i, i > 0 ? &made[at - 1].cage : nullptr,
                                       kAnyMemory, made[at].memory);
    ASSERT_TRUE(cage) << cage.error().detail;
    made[at].cage = *cage;
    expectCage(naive[at], *cage);
    EXPECT_EQ(test::followWords(*cage),
              test::followWords(naive[at].follows, *cage, i > 0 ? made[at - 1].cage : *cage));
    for (std::uint32_t node = 0; i > 0 && node < cage->nodes(); ++node) {
      const Cage& finer = made[at - 1].cage;
      const CageFollow follow = cageFollows(*cage, node, finer);
      glm::vec3 place(0);
      float sum = 0;
      for (int k = 0; k < follow.count; ++k) {
        place += follow.weights[k] * glm::vec3(finer.rest(follow.nodes[k]));
        sum += follow.weights[k];
      }
      EXPECT_NEAR(sum, 1, 1e-4f);
      EXPECT_LT(glm::length(place - glm::vec3(cage->rest(node))), 1e-2f);
    }
  }
}

TEST(Cage, TheSidesOfCells) {
  for (const auto& [cell, level, side] : {std::array{2, 0, 2},
                                          {2, 1, 8},
                                          {2, 2, 16},
                                          {4, 1, 8},
                                          {8, 1, 16},
                                          {8, 2, 32},
                                          {16, 0, 16},
                                          {16, 6, 1024}})
    EXPECT_EQ(cageSide(cell, level), side);
}

TEST(Cage, ABlockIsOneCell) {
  const NaiveCage naive({8, 8, 8}, 8, 0, [](const glm::ivec3& v) {
    return test::isInBox(v, {1, 2, 3}, {8, 8, 8});
  });
  MadeCage made;
  const Result<Cage> cage =
      makeCage(naive.raw.source(), {8, 8, 8}, 2, 8, 0, nullptr, kAnyMemory, made.memory);
  ASSERT_TRUE(cage);
  EXPECT_EQ(cage->cells(), 1u);
  EXPECT_EQ(cage->nodes(), 8u);
  EXPECT_EQ(cage->faces(), 12u);
  EXPECT_EQ(cage->last_level, 1);
  EXPECT_EQ(cage->cell(0)[1], 0u);
  expectCage(naive, *cage);
}

TEST(Cage, WhatDoesNotTouchIsApart) {
  const IsSolid plates = [](const glm::ivec3& v) {
    return test::isInBox(v, {0, 0, 0}, {8, 8, 8}) && v.x % 4 == 1;
  };
  const NaiveCage naive({8, 8, 8}, 8, 0, plates);
  EXPECT_EQ(naive.cells.size(), 2u);
  EXPECT_EQ(naive.nodes.size(), 16u);
  expectCages({8, 8, 8}, 2, 8, plates);
  expectCages({8, 8, 8}, 1, 2, plates);
}

TEST(Cage, AFullCubeAmongFullOnesIsInside) {
  const NaiveCage naive({10, 10, 10}, 2, 0, test::isBlock);
  EXPECT_EQ(naive.cells.size(), 125u - 27);
  expectCages({10, 10, 10}, 1, 2, test::isBlock);
  expectCages({12, 12, 12}, 2, 4, [](const glm::ivec3& v) {
    return test::isInBox(v, {0, 0, 0}, {12, 12, 12});
  });
}

TEST(Cage, TheTeethOfACombArePieces) {
  for (const int cell : {2, 4, 8, 16}) expectCages({22, 13, 3}, 4, cell, test::isComb);
}

TEST(Cage, RandomSolids) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const glm::ivec3 size(9 + random() % 8, 9 + random() % 8, 9 + random() % 8);
    const std::uint32_t share = 1 + random() % 9;
    std::vector<bool> solid(static_cast<std::size_t>(size.x * size.y * size.z));
    for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = random() % 10 < share;
    solid[0] = true;
    SCOPED_TRACE(seed);
    expectCages(size, 1 + static_cast<int>(seed % 3), 2 << (seed % 4), [&](const glm::ivec3& v) {
      return test::isInBox(v, {0, 0, 0}, size) &&
             solid[static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z))];
    });
  }
}

// Three cells of two cubes have one face in common: it is boundary for all of them.
TEST(Cage, AFaceOfThreeCellsIsBoundary) {
  RawCage raw;
  raw.blocks = {2, 1};
  raw.masks = {0x01, 0x80};
  MadeCage made;
  const Result<Cage> cage = makeCage(raw.source(), {4, 2, 2}, 1, 2, 0, nullptr, kAnyMemory, made.memory);
  ASSERT_TRUE(cage) << cage.error().detail;
  EXPECT_EQ(cage->nodes(), 12u);
  EXPECT_EQ(cage->faces(), 36u);
  for (std::uint32_t i = 0; i < 3; ++i)
    for (int face = 0; face < 6; ++face) EXPECT_EQ(cage->beyond(i, face), kCageOutside);
}

TEST(Cage, LimitsAreKept) {
  const NaiveCage naive({10, 10, 10}, 2, 0, test::isBlock);
  MadeCage made;
  const auto makeIn = [&](std::uint64_t bytes) {
    return makeCage(naive.raw.source(), {10, 10, 10}, 1, 2, 0, nullptr, bytes, made.memory);
  };
  const Result<Cage> any = makeIn(kAnyMemory);
  ASSERT_TRUE(any);
  const std::uint64_t needed =
      any->bytes() + std::uint64_t{72 + 48} * any->cells();  // tables, a copy of the cells
  EXPECT_TRUE(makeIn(needed));
  for (const std::uint64_t bytes : {needed - 1, std::uint64_t{1000}, std::uint64_t{0}}) {
    const Result<Cage> cage = makeIn(bytes);
    ASSERT_FALSE(cage);
    EXPECT_EQ(cage.error().code, ErrorCode::kLimit);
  }
  const Result<Cage> large =
      makeCage(naive.raw.source(), {514, 10, 10}, 1, 2, 0, nullptr, kAnyMemory, made.memory);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kCorrupt);
}

// Each would be accepted if its own rule were not checked.
TEST(Cage, WrongSourcesAreRefused) {
  const auto refuses = [](const RawCage& raw, const glm::ivec3& size, int cell, const Cage* finer = nullptr) {
    MadeCage made;
    const Result<Cage> cage =
        makeCage(raw.source(), size, finer ? 2 : 1, cell, finer ? 1 : 0, finer, kAnyMemory, made.memory);
    return !cage && cage.error().code == ErrorCode::kCorrupt;
  };
  RawCage block;
  block.blocks.assign(125, 1);
  block.blocks[62] = kInsideBlock;
  EXPECT_FALSE(refuses(block, glm::ivec3(10), 2));
  for (int i = 0; i < 125; ++i) {
    RawCage hole = block;
    hole.blocks[static_cast<std::size_t>(i)] = 0;
    const glm::ivec3 off = glm::abs(glm::ivec3(i % 5, i / 5 % 5, i / 25) - 2);
    EXPECT_EQ(refuses(hole, glm::ivec3(10), 2), i != 62 && std::max({off.x, off.y, off.z}) <= 1) << i;
    RawCage edge = block;
    edge.blocks[static_cast<std::size_t>(i)] = kInsideBlock;
    EXPECT_EQ(refuses(edge, glm::ivec3(10), 2), std::max({off.x, off.y, off.z}) == 2) << i;
  }
  const auto split = [](std::vector<std::uint8_t> numbers) {
    return RawCage{{2}, {1, 128}, {0}, std::move(numbers), {}};
  };
  EXPECT_FALSE(refuses(split({0, 1}), glm::ivec3(2), 2));
  for (const std::vector<std::uint8_t>& numbers :
       {std::vector<std::uint8_t>{0, 0}, {1, 0}, {1, 2}, {0, 2}, {0}, {0, 1, 0}})
    EXPECT_TRUE(refuses(split(numbers), glm::ivec3(2), 2));
  MadeCage finer;
  finer.cage = *makeCage(NaiveCage({8, 8, 8}, 4, 0, test::isBlock).raw.source(), {8, 8, 8}, 2, 4, 0, nullptr,
                         kAnyMemory, finer.memory);
  EXPECT_FALSE(refuses({{1}, {}, {}, {}, {}}, {8, 8, 8}, 4, &finer.cage));
  EXPECT_TRUE(refuses({{1}, {}, {}, {}, {0}}, {8, 8, 8}, 4, &finer.cage));
  const auto coarser = [](std::vector<std::uint32_t> follows) {
    std::vector<std::uint8_t> masks(16, 1);
    return RawCage{{2}, std::move(masks), {5}, {0, 1}, std::move(follows)};
  };
  EXPECT_FALSE(refuses(coarser({7, 0}), {8, 8, 8}, 4, &finer.cage));
  for (const std::vector<std::uint32_t>& follows : {std::vector<std::uint32_t>{}, {7}, {7, 8}, {7, 0, 0}})
    EXPECT_TRUE(refuses(coarser(follows), {8, 8, 8}, 4, &finer.cage));
  RawCage finest = block;
  finest.follows = {0};
  EXPECT_TRUE(refuses(finest, glm::ivec3(10), 2));
}

// A cube of the coarser cage holds no finer cell: the nodes that touch no other are told what they follow.
TEST(Cage, NodesFollowTheNearestCellAround) {
  RawCage raw{std::vector<std::uint8_t>(16), {}, {}, {}, {}};
  raw.blocks[1] = raw.blocks[4] = 1;
  MadeCage finer, coarser;
  finer.cage = *makeCage(raw.source(), {16, 8, 8}, 2, 4, 0, nullptr, kAnyMemory, finer.memory);
  ASSERT_EQ(finer.cage.cells(), 2u);
  ASSERT_EQ(finer.cage.place(0), glm::ivec3(1, 0, 0));
  const RawCage coarse{{1, 1}, {}, {}, {}, {1, 0, 1, 1}};
  const Result<Cage> cage =
      makeCage(coarse.source(), {16, 8, 8}, 2, 4, 1, &finer.cage, kAnyMemory, coarser.memory);
  ASSERT_TRUE(cage) << cage.error().detail;
  // Points by x, then y, then z. The ties go to cell 0.
  EXPECT_EQ(test::followWords(*cage),
            test::followWords({0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 1}, *cage, finer.cage));
}

}  // namespace
}  // namespace kelp
