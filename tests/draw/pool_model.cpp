// SPDX-License-Identifier: MIT
#include "pool_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "kelp/formats/fog.h"
#include "kelp/formats/page.h"
#include "kelp/streaming/page_access.h"

namespace kelp::test {
namespace {

constexpr std::uint32_t kStored = 0x80000000u;

std::uint32_t pageOf(std::uint32_t cell) { return cell >> 7 & 0x1ffffu; }

}  // namespace

Held& Held::operator+=(const Held& more) {
  grids += more.grids, pages += more.pages, cages += more.cages, missing_pages += more.missing_pages;
  return *this;
}

std::vector<PlacedPart> placedParts(const draw::DrawData& data) {
  std::vector<PlacedPart> parts;
  for (const draw::Call& call : data.calls) {
    for (std::uint32_t i = call.first; i < call.first + call.count; ++i) {
      const auto number = static_cast<std::size_t>(data.uniforms.first_instance) + i;
      const auto at = static_cast<std::size_t>(data.records[number / 4][static_cast<int>(number % 4)]);
      const glm::uvec4 volume = data.records[at + 11], tags = data.records[at + 12];
      PlacedPart part;
      part.instance = static_cast<int>(tags.y);
      part.part = static_cast<int>(tags.z);
      part.palette = tags.x;
      part.tables = data.records[at + 10].w;
      part.levels = static_cast<int>(volume.w >> 16 & 255);
      part.distances = static_cast<int>(volume.w >> 24);
      for (int axis = 0; axis < 3; ++axis)
        part.size[axis] = static_cast<int>(std::bit_cast<float>(volume[axis]));
      parts.push_back(part);
    }
  }
  return parts;
}

std::uint32_t PoolModel::word(std::uint64_t at) const {
  if (at >= pool_.size()) {
    ADD_FAILURE() << "word " << at << " is outside of the pool";
    return 0;
  }
  return pool_[static_cast<std::size_t>(at)];
}

// Of the cage there: kelp/formats/cage.h.
std::uint64_t PoolModel::cageWords(std::uint64_t at) const {
  const std::uint32_t cells = word(at), levels = word(at + 3);
  std::uint64_t words = kCageHeader + std::uint64_t{kCageCellWords} * cells + word(at + 2);
  for (std::uint32_t i = 0; i < cells; ++i) {
    if (word(at + kCageHeader + kCageCellWords * i + 1) == 0) continue;
    words += cageMaskWords(1 << (levels & 255), static_cast<int>(levels >> 8 & 255),
                           static_cast<int>(levels >> 16) + 1);
  }
  return words;
}

void PoolModel::copy(std::span<const draw::Copy> copies) {
  for (const draw::Copy& copy : copies) {
    ASSERT_LE(copy.offset / 4 + copy.words.size(), pool_.size());
    ASSERT_LE(copy.frame, frame_);
    for (std::size_t i = 0; i < copy.words.size(); ++i) {
      const auto at = static_cast<std::size_t>(copy.offset / 4 + i);
      ASSERT_LE(last_read_[at], copy.frame) << "word " << at << " of a copy of " << copy.words.size();
      early_ += copy.frame < frame_;
      pool_[at] = copy.words[i];
    }
  }
}

// Calls visit(first word, count) for what a level's tables lead to. fog_words: of a brick; 0: no fog.
template <class Visit>
void PoolModel::visitLevel(const PlacedPart& part, int level, bool distances, std::uint32_t fog_words,
                           Visit&& visit) const {
  const std::uint64_t table =
      part.tables + 4 * static_cast<std::uint64_t>(distances ? part.levels + level : level);
  visit(table, 4);
  const std::uint32_t cells = word(table), pages = word(table + 1), grid = word(table + 2),
                      cage = word(table + 3);
  if (grid == 0) return;
  if (cage != 0) visit(cage, cageWords(cage));
  const glm::ivec3 bricks(grid & 1023, grid >> 10 & 1023, 0);
  const PartKind kind = fog_words > 0 ? PartKind::kFog : PartKind::kSolid;
  const glm::ivec3 expected = brickGrid(latticeSize(kind, levelSize(part.size, level)));
  ASSERT_EQ(bricks.x + 1, expected.x);
  ASSERT_EQ(bricks.y + 1, expected.y);
  const auto count = static_cast<std::uint64_t>(expected.x * expected.y * expected.z);
  visit(cells, count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint32_t cell = word(cells + i);
    if (cell < kStored) continue;
    visit(std::uint64_t{pages} + pageOf(cell), 1);
    const std::uint64_t page = word(std::uint64_t{pages} + pageOf(cell));
    if (page == 0) continue;
    const std::uint32_t size = distances ? kCodeWords : fog_words > 0 ? fog_words : kBrickWords;
    const std::uint64_t brick = page + size * (cell & 127u);
    visit(brick, size);
    if (distances || fog_words > 0) continue;
    for (int voxel = 0; voxel < kBrickVoxels; ++voxel) {
      const std::uint32_t code =
          word(brick + 4 + static_cast<std::uint64_t>(voxel / 4)) >> 8 * (voxel % 4) & 255;
      if (code < 64 || code > 127) continue;
      const int slice = voxel / 64;
      const std::uint32_t offset =
          word(brick + static_cast<std::uint64_t>(slice / 2)) >> 16 * (slice % 2) & 0xffff;
      visit(brick + offset + (code - 64), 1);
    }
  }
}

void PoolModel::drawn(const std::vector<PlacedPart>& parts, std::uint64_t frame, bool fog,
                      std::size_t palette_entries) {
  ASSERT_GT(frame, frame_);
  frame_ = frame;
  const auto mark = [&](std::uint64_t first, std::uint64_t count) {
    ASSERT_LE(first + count, last_read_.size());
    std::fill_n(last_read_.begin() + static_cast<std::ptrdiff_t>(first), count, frame);
  };
  for (const PlacedPart& part : parts) {
    if (part.palette < kStored) mark(part.palette, 9 * palette_entries);
    std::uint32_t fog_words = 0;
    if (fog) {
      const std::uint64_t block = part.tables + 4 * static_cast<std::uint64_t>(part.levels);
      const std::uint32_t colors = word(block + 5);
      mark(block, 6 + static_cast<std::uint64_t>(part.levels) + 3 * colors);
      fog_words = kFogChannelWords * (colors > 0 ? 2 : 1);
    }
    for (int level = 0; level < part.levels; ++level) visitLevel(part, level, false, fog_words, mark);
    for (int level = 0; level < part.distances; ++level) visitLevel(part, level, true, 0, mark);
  }
}

Held PoolModel::expectContent(const PlacedPart& part, const runtime::Asset& whole) const {
  Held held;
  for (int i = 0; i < part.levels + part.distances; ++i) {
    const runtime::LevelId id{part.part, i < part.levels ? i : i - part.levels, i >= part.levels};
    const runtime::Level* const level = runtime::PageAccess::level(whole, id);
    const std::uint64_t table = part.tables + 4 * static_cast<std::uint64_t>(i);
    const std::uint32_t cells = word(table), pages = word(table + 1), grid = word(table + 2),
                        cage = word(table + 3);
    if (grid == 0) {
      EXPECT_EQ(cage, 0u);
      EXPECT_EQ(cells, 0u);
      EXPECT_EQ(pages, 0u);
      continue;
    }
    ++held.grids;
    const auto differs = [this](std::uint64_t at, std::span<const std::uint32_t> words) {
      int wrong = 0;
      for (const std::uint32_t expected : words) wrong += word(at++) != expected;
      return wrong;
    };
    EXPECT_EQ(differs(cells, level->cells), 0) << "cells of level " << id.level;
    int missing = 0;
    for (std::uint32_t page = 0; page < level->pages.size(); ++page) {
      const std::uint32_t at = word(std::uint64_t{pages} + page);
      ++(at == 0 ? missing : held.pages);
      if (at == 0) continue;
      const runtime::PinnedPage content = runtime::PageAccess::pin(whole, id, page, 1);
      EXPECT_TRUE(content);
      EXPECT_EQ(differs(at, content.words()), 0) << "page " << page << " of level " << id.level;
    }
    if (std::any_of(level->cells.begin(), level->cells.end(), [&](std::uint32_t cell) {
          return cell >= kStored && pageOf(cell) == level->pages.size();
        })) {
      const std::uint32_t solid = word(pages + level->pages.size());
      EXPECT_EQ(differs(solid, kSolidBrick), 0);
    }
    EXPECT_EQ(grid >= kStored, missing == 0) << "level " << id.level;
    const Part& packed = whole.pack().parts()[static_cast<std::size_t>(part.part)];
    const Cage* const behind =
        id.distances || packed.cages.empty() ? nullptr : &packed.cages[static_cast<std::size_t>(id.level)];
    EXPECT_EQ(cage != 0, behind != nullptr) << "level " << id.level;
    if (cage != 0 && behind) {
      EXPECT_EQ(differs(cage, behind->words), 0) << "cage of level " << id.level;
      ++held.cages;
    }
    held.missing_pages += missing;
  }
  return held;
}

}  // namespace kelp::test
