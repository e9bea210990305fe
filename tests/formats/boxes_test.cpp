// SPDX-License-Identifier: MIT
// The empty boxes that the reader makes: they hold nothing solid, and are the best of what a page knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "kelp/formats/empty_boxes.h"
#include "kelp/formats/level.h"
#include "support/random_pack.h"

namespace kelp {
namespace {

// Solid voxels, dense.
struct Solid {
  explicit Solid(const glm::ivec3& of) : size(of), voxels(static_cast<std::size_t>(of.x * of.y * of.z)) {}
  bool at(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z &&
           voxels[index(v)] != 0;
  }
  std::size_t index(const glm::ivec3& v) const {
    return static_cast<std::size_t>(v.x + size.x * (v.y + size.y * v.z));
  }
  template <class F>
  void each(F&& f) const {
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x) f(v);
  }
  glm::ivec3 size;
  std::vector<std::uint8_t> voxels;
};

std::uint32_t rawCell(const RawLevel& level, const glm::ivec3& size, const glm::ivec3& brick) {
  const glm::ivec3 grid = brickGrid(size);
  return level.cells[static_cast<std::size_t>(brick.x + grid.x * (brick.y + grid.y * brick.z))];
}

Solid solidOf(const RawLevel& level, const glm::ivec3& size) {
  Solid out(size);
  out.each([&](const glm::ivec3& v) {
    const std::uint32_t cell = rawCell(level, size, v / 8);
    out.voxels[out.index(v)] =
        cell == kCellInside ||
        (isStoredCell(cell) &&
         isSolidCode(level.codes[(cell & kCellSlotMask) * 512 + static_cast<std::size_t>(codeIndex(v))]));
  });
  return out;
}

bool isClear(const Solid& solid, const glm::ivec3& v, const glm::ivec3& reach) {
  glm::ivec3 d;
  for (d.z = -reach.z; d.z <= reach.z; ++d.z)
    for (d.y = -reach.y; d.y <= reach.y; ++d.y)
      for (d.x = -reach.x; d.x <= reach.x; ++d.x)
        if (solid.at(v + d)) return false;
  return true;
}

// The best box: the longest shortest reach, then the longest middle one, then the longest longest one.
std::uint8_t bestCode(const Solid& solid, const glm::ivec3& v) {
  const auto sorted = [](int code) {
    std::array<int, 3> k{code & 3, code >> 2 & 3, code >> 4};
    std::sort(k.begin(), k.end());
    return k;
  };
  int best = 0;
  for (int code = 1; code < 64; ++code)
    if (sorted(code) > sorted(best) && isClear(solid, v, codeReach(static_cast<std::uint8_t>(code))))
      best = code;
  return static_cast<std::uint8_t>(best);
}

// The voxels of the level that a page knows: its own bricks, the coarser level for those of other pages; and
// which bricks are empty or inside.
Solid knownTo(const LevelGrid& grid, std::uint32_t page, const Solid& truth, const Solid* coarser) {
  Solid known(8 * brickGrid(truth.size));  // to the voxels that fill the last bricks
  known.each([&](const glm::ivec3& v) {
    const glm::ivec3 b = v / 8;
    const std::uint32_t cell =
        grid.cells[static_cast<std::size_t>(b.x + grid.grid.x * (b.y + grid.grid.y * b.z))];
    const bool other = (cell & kCellSolid) && !grid.isInside(cell) && cellPage(cell) != page;
    known.voxels[known.index(v)] = other ? (coarser ? coarser->at(v / 2) : true) : truth.at(v);
  });
  return known;
}

TEST(Boxes, AreTheBestThatAPageKnows) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    test::RandomPack random(seed, {1, 8, 1, 0});
    RawPack raw = random.make();
    RawPart& part = raw.parts[0];
    part.size = {61, 45, 70};
    part.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
    part.bend = Bend::kShear;
    part.roll = 0;
    part.levels = random.makeLevels(part.size, 3, raw.palette.size(), 0.6f);
    const std::vector<std::byte> bytes = test::writeToMemory(raw);
    MemorySource memory(bytes);
    const Result<Pack> pack = Pack::open(memory.source());
    ASSERT_TRUE(pack);
    std::size_t less = 0, boxes = 0;
    for (int level = 2; level >= 0; --level) {
      const RawLevel& written = part.levels[static_cast<std::size_t>(level)];
      const Solid truth = solidOf(written, levelSize(part.size, level));
      const Solid above = level == 2 ? truth
                                     : solidOf(part.levels[static_cast<std::size_t>(level) + 1],
                                               levelSize(part.size, level + 1));
      const Result<LevelReader> reader = LevelReader::open(*pack, 0, level);
      ASSERT_TRUE(reader);
      PageData data;
      for (std::uint32_t page = 0; page < reader->grid().pages.size(); ++page) {
        ASSERT_TRUE(reader->readPage(page, data));
        const Solid known = knownTo(reader->grid(), page, truth, level == 2 ? nullptr : &above);
        for (std::uint32_t i = 0; i < data.info.count * 512; i += 5) {
          const std::uint8_t code = data.codes(i / 512)[i % 512];
          const auto at = static_cast<int>(i % 512);
          const glm::ivec3 v = 8 * reader->grid().place(data.info.first_slot + i / 512) +
                               glm::ivec3(at & 7, at >> 3 & 7, at >> 6);
          ASSERT_EQ(isSolidCode(code), truth.at(v));
          if (isSolidCode(code)) continue;
          ASSERT_TRUE(isClear(truth, v, codeReach(code)));
          ASSERT_EQ(int{code}, int{bestCode(known, v)}) << v.x << " " << v.y << " " << v.z;
          less += code != bestCode(truth, v);
          ++boxes;
        }
      }
      EXPECT_TRUE(level > 0 || reader->grid().pages.size() > 1);
    }
    EXPECT_GT(less, 0u) << "some boxes end at the page";
    EXPECT_LT(less, boxes / 4);
  }
}

TEST(Boxes, OfCellsHoldNoSolidBrick) {
  test::RandomPack random(7, {1, 8, 1, 0});
  const glm::ivec3 size(210, 150, 190);
  const RawLevel raw = random.makeLevel(size, 1, 0.02f);
  std::vector<std::uint32_t> cells = raw.cells;
  const glm::ivec3 grid = brickGrid(size);
  for (std::uint32_t& cell : cells) cell |= cell & kCellSolid ? 0 : 0x123456;  // is overwritten
  ASSERT_TRUE(growBoxes(cells, grid));
  Solid bricks(grid);
  bricks.each([&](const glm::ivec3& b) { bricks.voxels[bricks.index(b)] = cells[bricks.index(b)] >> 31; });
  bricks.each([&](const glm::ivec3& b) {
    const std::uint32_t cell = cells[bricks.index(b)];
    if (bricks.at(b)) {
      EXPECT_EQ(cell, raw.cells[bricks.index(b)]);
      return;
    }
    EXPECT_EQ(cellClearance(cell), cellClearance(raw.cells[bricks.index(b)]));
    glm::ivec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = b[axis] - cellReach(cell, 2 * axis);
      high[axis] = b[axis] + cellReach(cell, 2 * axis + 1);
    }
    const auto anySolid = [&](const glm::ivec3& from, const glm::ivec3& to) {
      glm::ivec3 v;
      for (v.z = from.z; v.z <= to.z; ++v.z)
        for (v.y = from.y; v.y <= to.y; ++v.y)
          for (v.x = from.x; v.x <= to.x; ++v.x)
            if (bricks.at(v)) return true;
      return false;
    };
    ASSERT_FALSE(anySolid(low, high));
    // No side can move on.
    for (int side = 0; side < 6; ++side) {
      if (cellReach(cell, side) == kCellMaxReach) continue;
      glm::ivec3 from = low, to = high;
      from[side / 2] = to[side / 2] = side % 2 == 0 ? low[side / 2] - 1 : high[side / 2] + 1;
      ASSERT_TRUE(anySolid(from, to));
    }
  });
}

}  // namespace
}  // namespace kelp
