// SPDX-License-Identifier: MIT
// Levels of tens of thousands of pages: which page comes next is found without a look at each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "../formats/pack_surgeon.h"
#include "kelp/formats/page.h"
#include "kelp/runtime/asset.h"
#include "kelp/runtime/level.h"
#include "kelp/streaming/page_access.h"
#include "page_codec.h"
#include "support/all_tests.h"
#include "support/test_pack.h"

namespace kelp::runtime {
namespace {

using test::Bytes;

// A page of one brick whose voxels with coordinates of 0 or `step` are surface.
std::vector<std::byte> pageOf(const glm::ivec3& brick, const glm::ivec3& size, int step,
                              std::span<const CoarseBlock> above, Buffer<std::byte>& workspace) {
  std::vector<std::uint8_t> codes(kBrickVoxels, 0);
  for (int i = 0; i < 8; ++i)
    codes[static_cast<std::size_t>(step * codeIndex({i & 1, i >> 1 & 1, i >> 2}))] = kSurfaceCode;
  const std::vector<std::uint32_t> attributes(
      static_cast<std::size_t>(std::count(codes.begin(), codes.end(), kSurfaceCode)), makeAttribute(0, 0));
  Buffer<std::byte> out;
  EXPECT_TRUE(
      encodeSolidPage({{&brick, 1}, above, size, 1}, codes, attributes, Effort::kFast, workspace, out));
  return {out.begin(), out.end()};
}

// Two levels whose bricks have a page of their own each: what no writer makes and every reader must take.
// Level 0 has side^3 bricks of one voxel, level 1 has those above it.
Bytes onePagePerBrick(std::uint32_t side) {
  fields::Occupancy one;
  one.size = {8, 8, 8};
  one.solid.assign(512, 0);
  one.solid[0] = 1;
  RawPack raw = test::packOf(one);
  raw.palette.resize(1);
  raw.parts[0].levels[0].attributes = {makeAttribute(0, 0)};
  test::PackSurgeon pack(test::bytesOf(raw));
  for (std::size_t axis = 0; axis < 3; ++axis) test::set(pack.content("PART"), 8 + 12 + 4 * axis, 8 * side);
  test::set(pack.content("PART"), 8 + 9, std::uint8_t{2});
  const test::PackSurgeon::Chunk grid = pack.chunks[pack.find("GRID")],
                                 bricks = pack.chunks[pack.find("BRCK")];
  pack.chunks.resize(pack.find("GRID"));
  constexpr std::size_t kEntry = 32;  // bytes of the page table
  Buffer<std::byte> workspace;
  for (const std::uint32_t level : {1u, 0u}) {
    const std::uint32_t n = side >> level, count = n * n * n;
    std::vector<glm::ivec3> places(count);
    for (std::uint32_t cell = 0; cell < count; ++cell) places[cell] = voxelAt(glm::ivec3(n), cell);
    std::sort(places.begin(), places.end(),
              [](const glm::ivec3& a, const glm::ivec3& b) { return mortonCode(a) < mortonCode(b); });
    test::PackSurgeon::Chunk all = grid, pages = bricks;
    all.level = pages.level = level;
    all.content.assign(count, std::byte{128});
    all.content.resize((count + 7) / 8 * 8 + kEntry * count);
    pages.content.clear();
    for (std::uint32_t slot = 0; slot < count; ++slot) {
      const CoarseBlock above{1, 1};
      const std::vector<std::byte> page = pageOf(places[slot], glm::ivec3(8 * n), level == 0 ? 0 : 4,
                                                 {&above, level == 0 ? 1u : 0u}, workspace);
      const std::size_t entry = all.content.size() - kEntry * (count - slot);
      test::set(all.content, entry, std::uint64_t{pages.content.size()});
      test::set(all.content, entry + 8, static_cast<std::uint32_t>(page.size()));
      test::set(all.content, entry + 12, level == 0 ? 512u + 4 : 512u + 8 * 4);
      test::set(all.content, entry + 16, std::uint64_t{XXH3_64bits(page.data(), page.size())});
      test::set(all.content, entry + 24, slot);
      test::set(all.content, entry + 28, 1u);
      pages.content.insert(pages.content.end(), page.begin(), page.end());
    }
    pack.chunks.push_back(all);
    pack.chunks.push_back(pages);
  }
  return pack.build();
}

// Remembers where was read.
struct Recorder {
  MemorySource memory;
  std::vector<std::uint64_t> offsets;

  explicit Recorder(const Bytes& bytes) : memory(bytes) {}
  Source source() {
    return {[](void* user, std::uint64_t offset, std::span<std::byte> out) {
              auto& self = *static_cast<Recorder*>(user);
              self.offsets.push_back(offset);
              const Source inner = self.memory.source();
              return inner.read(inner.user, offset, out);
            },
            this, memory.source().size};
  }
};

TEST(ManyPages, ComeInOrder) {
  const Bytes bytes = onePagePerBrick(16);
  Recorder recorder(bytes);
  auto asset = Asset::open(recorder.source());
  ASSERT_TRUE(asset);
  recorder.offsets.clear();
  ASSERT_TRUE((*asset)->loadAll());
  EXPECT_GE(recorder.offsets.size(), 16u * 16 * 16 + 8 * 8 * 8);
  EXPECT_TRUE(std::is_sorted(recorder.offsets.begin(), recorder.offsets.end())) << "packs lie coarse to fine";
}

// Asked for and loaded in turns, at random, against a walk over all pages for each.
TEST(ManyPages, TheMostUrgentComesNext) {
  constexpr std::uint32_t kPatience = 8;  // rounds that a request counts for: beginRequests()
  struct Page {
    float urgency = 0;
    std::uint32_t round = 0;
    bool resident = false;
  };
  const Bytes bytes = onePagePerBrick(test::kSanitized ? 8 : 16);
  Recorder recorder(bytes);
  auto opened = Asset::open(recorder.source());
  ASSERT_TRUE(opened);
  Asset& asset = **opened;
  PageAccess::beginRequests(asset);
  std::uint32_t now = 1;
  PageAccess::request(asset, {0, 0}, 1.0f);
  while (*asset.pump()) {
  }
  const std::span<const PageInfo> infos = asset.level(0, 0)->pages;
  std::vector<Page> pages(infos.size());
  std::mt19937 random(7);
  std::uint32_t loaded = 0;
  while (loaded < pages.size()) {
    const std::uint32_t what = random() % 8;
    if (what == 0) {
      PageAccess::beginRequests(asset);
      ++now;
    } else if (what < 4) {
      const std::uint32_t page = random() % pages.size();
      const float urgency = static_cast<float>(random() % 50);
      EXPECT_EQ(static_cast<bool>(PageAccess::pin(asset, {0, 0}, page, urgency)), pages[page].resident);
      if (pages[page].round != now || pages[page].urgency < urgency)
        pages[page].urgency = urgency, pages[page].round = now;
    } else {
      std::size_t next = pages.size();
      float most = 0;
      for (std::size_t i = 0; i < pages.size(); ++i) {
        if (pages[i].resident || pages[i].round + kPatience <= now || pages[i].urgency <= most) continue;
        most = pages[i].urgency;
        next = i;
      }
      recorder.offsets.clear();
      const Result<bool> more = asset.pump();
      ASSERT_TRUE(more);
      ASSERT_EQ(*more, next < pages.size());
      if (!*more) continue;
      ASSERT_EQ(recorder.offsets, std::vector<std::uint64_t>{infos[next].offset})
          << "page " << next << " at " << most;
      pages[next].resident = true;
      ++loaded;
    }
  }
}

}  // namespace
}  // namespace kelp::runtime
