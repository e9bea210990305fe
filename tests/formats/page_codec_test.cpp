// SPDX-License-Identifier: MIT
// The codec of pages of solid levels: what is written comes back, and damaged bytes harm nobody.
#include "page_codec.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "coding_libraries.h"
#include "page_worlds.h"
#include "range_coder.h"
#include "support/all_tests.h"

namespace kelp {
namespace {

using page_test::allPages;
using page_test::ballWorld;
using page_test::flatLook;
using page_test::Look;
using page_test::makeWorld;
using page_test::noiseLook;
using page_test::smoothLook;
using page_test::TestPage;
using page_test::World;

std::vector<std::byte> encoded(const TestPage& page, Effort effort = Effort::kFast) {
  Buffer<std::byte> workspace;
  Buffer<std::byte> out;
  const Result<void> done =
      encodeSolidPage(page.shape(), page.codes, page.attributes, effort, workspace, out);
  EXPECT_TRUE(done) << (done ? "" : done.error().detail);
  return {out.begin(), out.end()};
}

struct Decoded {
  Result<void> result;
  std::vector<std::uint8_t> codes;
  std::vector<std::uint32_t> attributes;
};
// stored: copied to memory of its own, so that a sanitizer sees every step beyond it.
Decoded decoded(const TestPage& page, std::span<const std::byte> stored, Buffer<std::byte>& workspace) {
  const std::vector<std::byte> alone(stored.begin(), stored.end());
  std::vector<BrickShape> shapes(page.codes.size() / kBrickVoxels);
  Decoded out{{}, {}, std::vector<std::uint32_t>(page.attributes.size(), 1)};
  out.result = decodeSolidPage(page.shape(), alone, workspace, shapes, out.attributes);
  for (const BrickShape& shape : shapes) {
    for (std::size_t i = 0; i < kBrickVoxels; ++i) {
      const auto isSet = [&](const BrickBits& bits) { return (bits.slices[i / 64] >> (i % 64) & 1) != 0; };
      out.codes.push_back(isSet(shape.surface) ? kSurfaceCode : isSet(shape.solid) ? kInnerCode : 0);
    }
  }
  return out;
}

void expectRoundTrip(const TestPage& page, Effort effort) {
  Buffer<std::byte> workspace;
  const std::vector<std::byte> stored = encoded(page, effort);
  const Decoded back = decoded(page, stored, workspace);
  ASSERT_TRUE(back.result) << back.result.error().detail;
  EXPECT_EQ(back.codes, page.codes);
  EXPECT_EQ(back.attributes, page.attributes);
}

struct Case {
  const char* name;
  World world;
  std::uint32_t palette;
  Look look;
};

std::vector<Case> cases() {
  std::mt19937 random(7);
  std::vector<Case> cases;
  cases.push_back({"flat", ballWorld(40), 1, flatLook(1)});
  cases.push_back({"smooth", ballWorld(45), 5, smoothLook(5)});
  cases.push_back({"noise", ballWorld(33), 256, noiseLook(256)});
  cases.push_back({"full", makeWorld({27, 16, 24}, [](const glm::ivec3&) { return true; }), 3, flatLook(3)});
  cases.push_back({"one voxel",
                   makeWorld({70, 9, 1}, [](const glm::ivec3& v) { return v.x == 69 && v.y == 8; }), 256,
                   noiseLook(256)});
  cases.push_back({"dust", makeWorld({31, 40, 35}, [&](const glm::ivec3&) { return random() % 50 == 0; }), 2,
                   noiseLook(2)});
  cases.push_back({"rubble", makeWorld({64, 64, 64}, [&](const glm::ivec3&) { return random() % 2 == 0; }), 1,
                   flatLook(1)});
  cases.push_back({"sponge", makeWorld({64, 64, 64}, [&](const glm::ivec3&) { return random() % 60 != 0; }),
                   9, smoothLook(9)});
  cases.push_back({"sheet",
                   makeWorld({90, 90, 20}, [](const glm::ivec3& v) { return (v.x + 2 * v.y) / 15 == v.z; }),
                   2, flatLook(2)});
  return cases;
}

TEST(PageCodec, WhatIsWrittenComesBack) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    for (const TestPage& page : allPages(c.world, c.palette, c.look)) expectRoundTrip(page, Effort::kFast);
    for (const TestPage& page : allPages(c.world, c.palette, c.look, 3)) expectRoundTrip(page, Effort::kFast);
  }
}

TEST(PageCodec, MoreEffortIsNeverLonger) {
  std::size_t fast = 0, best = 0;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    for (const TestPage& page : allPages(c.world, c.palette, c.look)) {
      const std::size_t bytes = encoded(page).size(), least = encoded(page, Effort::kBest).size();
      EXPECT_LE(least, bytes);
      fast += bytes;
      best += least;
      expectRoundTrip(page, Effort::kBest);
    }
  }
  EXPECT_LT(best, fast);
}

TEST(PageCodec, LargestPages) {
  std::mt19937 random(3);
  const World full = makeWorld({64, 64, 64}, [&](const glm::ivec3&) { return random() % 27 != 0; });
  std::size_t most_bricks = 0, most_attributes = 0;
  for (const std::vector<TestPage>& pages :
       {allPages(full, 256, noiseLook(256)),
        allPages(makeWorld({512, 8, 24},
                           [](const glm::ivec3& v) { return v.x % 8 == 7 && v.y == 0 && v.z % 8 == 1; }),
                 1, flatLook(1))}) {
    for (const TestPage& page : pages) {
      most_bricks = std::max(most_bricks, page.bricks.size());
      most_attributes = std::max(most_attributes, page.attributes.size());
      expectRoundTrip(page, Effort::kFast);
      EXPECT_LE(encoded(page).size(), 65536u);
    }
  }
  EXPECT_EQ(most_bricks, std::size_t{127});
  EXPECT_GT(most_attributes, std::size_t{9000});
}

TEST(PageCodec, CoarserNormalsCostLess) {
  const Look smooth = smoothLook(1);
  const auto bytes = [&](std::uint32_t kept) {
    std::size_t sum = 0, voxels = 0;
    const Look rounded = [&](const glm::ivec3& v) { return (smooth(v) & kept) | (0x00700700u & ~kept); };
    for (const TestPage& page : allPages(ballWorld(48), 1, rounded)) {
      expectRoundTrip(page, Effort::kFast);
      sum += encoded(page).size();
      voxels += page.attributes.size();
    }
    return static_cast<double>(sum) * 8 / static_cast<double>(voxels);
  };
  EXPECT_LT(bytes(~0x00700700u), bytes(~0u) - 5.5);
}

// Every shorter page, and one with a byte more, is refused; every changed byte gives an error or voxels.
TEST(PageCodec, DamagedBytes) {
  Buffer<std::byte> workspace;
  std::size_t refused = 0, changes = 0;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const std::vector<TestPage> pages = allPages(c.world, c.palette, c.look, 4);
    for (std::size_t i = 0; i < pages.size(); i += 1 + pages.size() / 4) {
      const std::vector<std::byte> stored = encoded(pages[i]);
      const std::size_t step = 1 + stored.size() / (test::kSanitized ? 100 : 300);
      for (std::size_t bytes = 0; bytes < stored.size(); bytes += step)
        EXPECT_FALSE(decoded(pages[i], std::span(stored).first(bytes), workspace).result) << bytes;
      std::vector<std::byte> more = stored;
      more.push_back(std::byte{0});
      EXPECT_FALSE(decoded(pages[i], more, workspace).result);
      more.push_back(std::byte{0});
      EXPECT_FALSE(decoded(pages[i], more, workspace).result);
      std::mt19937 random(static_cast<std::uint32_t>(i));
      for (std::size_t at = 0; at < stored.size(); at += step) {
        std::vector<std::byte> changed = stored;
        changed[at] ^= static_cast<std::byte>(1 + random() % 255);
        const Decoded back = decoded(pages[i], changed, workspace);
        refused += !back.result;
        ++changes;
        if (!back.result)
          EXPECT_EQ(back.result.error().code, ErrorCode::kCorrupt);
        else
          EXPECT_TRUE(back.codes != pages[i].codes || back.attributes != pages[i].attributes);
      }
    }
  }
  EXPECT_GT(changes, std::size_t{2000});
  EXPECT_GT(refused * 2, changes);
}

TEST(PageCodec, RandomBytes) {
  Buffer<std::byte> workspace;
  std::mt19937 random(11);
  const std::vector<TestPage> pages = allPages(ballWorld(40), 6, flatLook(6));
  for (int round = 0; round < test::shareOf(2000); ++round) {
    TestPage page = pages[random() % pages.size()];
    std::vector<std::byte> bytes(random() % 3000);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    if (bytes.size() > 3) {
      bytes[0] &= std::byte{0xf7};
      bytes[2] = std::byte{0};  // so that the size of the plain bits is possible
    }
    for (CoarseBlock& block : page.above) {
      block.solid = random() | std::uint64_t{random()} << 32;
      block.surface = random() | std::uint64_t{random()} << 32;  // and not only of solid ones
    }
    EXPECT_FALSE(decoded(page, bytes, workspace).result);
  }
}

struct PageMistake {
  const char* name;
  void (*make)(TestPage& page);
};
const PageMistake kPageMistakes[] = {
    {"no bricks", [](TestPage& p) { p.bricks.clear(); }},
    {"129 bricks", [](TestPage& p) { p.bricks.resize(129, p.bricks[0]); }},
    {"bricks out of order", [](TestPage& p) { std::swap(p.bricks[0], p.bricks[1]); }},
    {"a brick twice", [](TestPage& p) { p.bricks[1] = p.bricks[0]; }},
    {"a brick beyond the level", [](TestPage& p) { p.bricks.back().x += 100; }},
    {"a negative brick", [](TestPage& p) { p.bricks[0].x = -1; }},
    {"one block too few", [](TestPage& p) { p.above.pop_back(); }},
    {"no palette", [](TestPage& p) { p.palette = 0; }},
    {"a palette of 257", [](TestPage& p) { p.palette = 257; }},
    {"a level of size 0", [](TestPage& p) { p.size.y = 0; }},
    {"a level too large", [](TestPage& p) { p.size.y = 40000; }},
    {"codes missing", [](TestPage& p) { p.codes.pop_back(); }},
    {"an attribute too few", [](TestPage& p) { p.attributes.pop_back(); }},
    {"too many attributes", [](TestPage& p) { p.attributes.resize(kMaxPageAttributes + 1); }},
};
const PageMistake kContentMistakes[] = {
    {"an index beyond the palette", [](TestPage& p) { p.attributes[5] |= 0xff; }},
    {"a reserved code", [](TestPage& p) { p.codes[7] = 65; }},
    {"a box",
     [](TestPage& p) { p.codes[std::find(p.codes.begin(), p.codes.end(), 0) - p.codes.begin()] = 1; }},
    {"nothing above a solid voxel", [](TestPage& p) { p.above[0].solid = p.above[0].surface = 0; }},
    {"a voxel above nothing", [](TestPage& p) { p.above[0].solid = p.above[0].surface = ~std::uint64_t{0}; }},
    {"no surface above a surface voxel", [](TestPage& p) { p.above[0].surface = 0; }},
    {"an inner voxel beside an empty one",
     [](TestPage& p) {
       *std::find(p.codes.begin(), p.codes.end(), 64) = 128;
       p.attributes.pop_back();
     }},
    {"a brick without surface",
     [](TestPage& p) {
       const auto end = p.codes.begin() + 512;
       const std::ptrdiff_t surface = std::count(p.codes.begin(), end, 64);
       std::replace(p.codes.begin(), end, 64, 0);
       p.attributes.erase(p.attributes.begin(), p.attributes.begin() + surface);
     }},
};

// 48 ones are not below the range. After as many decisions as make the range less than what is beyond it,
// that is lost, and these bytes end as others may.
TEST(PageCodec, ACodeBeyondTheRangeIsRefused) {
  std::vector<std::byte> coded(12, std::byte{0xff});
  const std::array<unsigned, 4> last = {0x00, 0x01, 0x2a, 0xcb};
  for (std::size_t i = 0; i < last.size(); ++i) coded[8 + i] = static_cast<std::byte>(last[i]);
  coding::Decoder decoder(coded, {}, 4);
  coding::Bit model;
  for (int i = 0; i < 176684; ++i) ASSERT_FALSE(decoder.bit(model));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(decoder.bit(model));
  EXPECT_FALSE(decoder.isAtEnd());
}

TEST(PageCodec, MistakesAreRefused) {
  const TestPage right = allPages(ballWorld(40), 6, flatLook(6))[0];
  const std::vector<std::byte> stored = encoded(right);
  Buffer<std::byte> workspace;
  Buffer<std::byte> out;
  const auto isRefused = [&](const TestPage& page) {
    const Result<void> done =
        encodeSolidPage(page.shape(), page.codes, page.attributes, Effort::kFast, workspace, out);
    return !done && done.error().code == ErrorCode::kMisuse;
  };
  for (const PageMistake& mistake : kPageMistakes) {
    SCOPED_TRACE(mistake.name);
    TestPage page = right;
    mistake.make(page);
    EXPECT_TRUE(isRefused(page));
    EXPECT_FALSE(decoded(page, stored, workspace).result);
  }
  for (const PageMistake& mistake : kContentMistakes) {
    SCOPED_TRACE(mistake.name);
    TestPage page = right;
    mistake.make(page);
    EXPECT_TRUE(isRefused(page));
  }
}

TEST(PageCodec, IndexBeyondThePalette) {
  Buffer<std::byte> workspace;
  TestPage page = allPages(ballWorld(40), 256, noiseLook(256))[0];
  const std::vector<std::byte> stored = encoded(page);
  page.palette = 200;  // which the bytes do not depend on, unless it is 1
  const Decoded back = decoded(page, stored, workspace);
  ASSERT_FALSE(back.result);
  EXPECT_STREQ(back.result.error().detail, "a palette index is beyond the palette");
}

// The format must not drift: these bytes are what SPEC.md says.
TEST(PageCodec, KnownBytes) {
  std::vector<std::byte> all;
  std::size_t pages = 0;
  const std::array<Look, 3> looks = {flatLook(1), smoothLook(7), noiseLook(256)};
  const std::array<std::uint32_t, 3> palettes = {1, 7, 256};
  for (std::size_t i = 0; i < looks.size(); ++i)
    for (const TestPage& page : allPages(ballWorld(40), palettes[i], looks[i])) {
      const std::vector<std::byte> stored = encoded(page, Effort::kBest);
      all.insert(all.end(), stored.begin(), stored.end());
      ++pages;
    }
  EXPECT_EQ(pages, std::size_t{12});
  EXPECT_EQ(all.size(), std::size_t{41118});
  EXPECT_EQ(checksum(all), 17515027253959665763u);
}

}  // namespace
}  // namespace kelp
