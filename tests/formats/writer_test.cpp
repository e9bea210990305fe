// SPDX-License-Identifier: MIT
// Input that the writer refuses, and sinks that fail.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "kelp/formats/raw_pack.h"
#include "support/random_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

struct CountingSink {
  std::size_t calls = 0, bytes = 0, refuse_at = std::numeric_limits<std::size_t>::max();

  Sink sink() {
    Sink result;
    result.user = this;
    result.write = [](void* user, std::span<const std::byte> more) -> Result<void> {
      CountingSink& self = *static_cast<CountingSink*>(user);
      if (self.calls++ == self.refuse_at) return Error{ErrorCode::kIo, "full"};
      self.bytes += more.size();
      return {};
    };
    return result;
  }
};

// A mistake, made in the tiny pack.
struct Mistake {
  const char* name;
  void (*make)(RawPack& pack);
};

const Mistake kMistakes[] = {
    {"no parts", [](RawPack& p) { p.parts.clear(); }},
    {"no palette", [](RawPack& p) { p.palette.clear(); }},
    {"257 materials", [](RawPack& p) { p.palette.resize(257); }},
    {"color above 1", [](RawPack& p) { p.palette[0].base_color.x = 1.5f; }},
    {"info not UTF-8", [](RawPack& p) { p.info_json = "\xff"; }},
    {"name with newline", [](RawPack& p) { p.parts[0].name = "a\nb"; }},
    {"name of 256 bytes", [](RawPack& p) { p.parts[0].name = std::string(256, 'x'); }},
    {"clip name of 256 bytes", [](RawPack& p) { p.clips[0].name = std::string(256, 'x'); }},
    {"parent later", [](RawPack& p) { p.parts[0].parent = 1; }},
    {"no levels at all",
     [](RawPack& p) {
       for (RawPart& part : p.parts) part.levels.clear();
     }},
    {"17 levels", [](RawPack& p) { p.parts[1].levels.resize(17, p.parts[1].levels[0]); }},
    {"257 levels", [](RawPack& p) { p.parts[1].levels.resize(257, p.parts[1].levels[0]); }},
    {"size 0", [](RawPack& p) { p.parts[1].size.y = 0; }},
    {"size too large", [](RawPack& p) { p.parts[1].size.y = 32769; }},
    {"flat transform", [](RawPack& p) { p.parts[0].to_object[1] = glm::vec3(0); }},
    {"one knot", [](RawPack& p) { p.parts[0].knots.resize(1); }},
    {"65 knots", [](RawPack& p) { p.parts[0].knots.resize(65); }},
    {"spline turns back", [](RawPack& p) { p.parts[0].knots[1].position.y = 40; }},
    {"clip without duration", [](RawPack& p) { p.clips[0].duration = 0; }},
    {"wave of no knot", [](RawPack& p) { p.clips[0].waves[0].knot = 3; }},
    {"track without keys", [](RawPack& p) { p.clips[0].tracks[0].keys.clear(); }},
    {"keys out of order",
     [](RawPack& p) { std::swap(p.clips[0].tracks[0].keys[0], p.clips[0].tracks[0].keys[1]); }},
    {"a cell too few", [](RawPack& p) { p.parts[0].levels[0].cells.pop_back(); }},
    {"slot twice", [](RawPack& p) { p.parts[0].levels[0].cells[2] = kCellSolid; }},
    {"no brick",
     [](RawPack& p) {
       p.parts[1].levels[0] = {};
       p.parts[1].levels[0].cells = {256};
     }},
    {"a code too few", [](RawPack& p) { p.parts[0].levels[0].codes.pop_back(); }},
    {"a brick of codes too many", [](RawPack& p) { p.parts[0].levels[0].codes.resize(3 * 512); }},
    {"reserved code", [](RawPack& p) { p.parts[0].levels[0].codes[9] = 200; }},
    {"wrong rank", [](RawPack& p) { p.parts[0].levels[0].codes[0] = 66; }},
    {"attribute missing", [](RawPack& p) { p.parts[0].levels[0].attributes.pop_back(); }},
    {"attribute too many", [](RawPack& p) { p.parts[0].levels[0].attributes.push_back(0); }},
    {"palette index", [](RawPack& p) { p.parts[0].levels[0].attributes[0] = makeAttribute(2, 0); }},
    {"brick without surface",
     [](RawPack& p) {
       p.parts[1].levels[0].codes.assign(512, 0);
       p.parts[1].levels[0].attributes.clear();
     }},
    {"solid below an empty voxel",
     [](RawPack& p) {
       p.parts[0].levels[1].codes[9] = 0;
       p.parts[0].levels[1].attributes.erase(p.parts[0].levels[1].attributes.begin() + 3);
     }},
    {"surface below an inner voxel",
     [](RawPack& p) {
       p.parts[0].levels[1].codes[64 + 9] = kInnerCode;
       p.parts[0].levels[1].attributes.erase(p.parts[0].levels[1].attributes.begin() + 7);
     }},
    {"nothing below a solid voxel",
     [](RawPack& p) {
       p.parts[0].levels[1].codes[512 + 217] = kSurfaceCode + 1;
       p.parts[0].levels[1].attributes.push_back(0);
     }},
    {"a brick below an empty one", [](RawPack& p) { p.parts[0].levels[1] = p.parts[1].levels[0]; }},
    {"inside beyond the level", [](RawPack& p) { p.parts[0].levels[1].cells[1] = kCellInside; }},
    {"solid beyond x", [](RawPack& p) { p.parts[1].levels[0].codes[2] = kInnerCode; }},
    {"solid beyond y", [](RawPack& p) { p.parts[1].levels[0].codes[8] = kInnerCode; }},
    {"solid beyond z", [](RawPack& p) { p.parts[1].levels[0].codes[64] = kInnerCode; }},
};

TEST(Writer, RefusesEveryMistakeBeforeItWritesAByte) {
  for (const Mistake& mistake : kMistakes) {
    SCOPED_TRACE(mistake.name);
    RawPack pack = test::makeTinyPack();
    mistake.make(pack);
    CountingSink counter;
    const Result<void> written = writePack(pack, counter.sink());
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kMisuse) << written.error().detail;
    EXPECT_STRNE(written.error().detail, "");
    EXPECT_EQ(counter.calls, 0u);
  }
}

TEST(Writer, RefusesAMissingSinkAndNoThreads) {
  CountingSink counter;
  EXPECT_EQ(writePack(test::makeTinyPack(), Sink{}).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(writePack(test::makeTinyPack(), counter.sink(), 0).error().code, ErrorCode::kMisuse);
}

TEST(Writer, StopsWhereTheSinkStops) {
  CountingSink all;
  ASSERT_TRUE(writePack(test::makeTinyPack(), all.sink()));
  for (std::size_t n = 0; n < all.calls; ++n) {
    CountingSink counter;
    counter.refuse_at = n;
    const Result<void> written = writePack(test::makeTinyPack(), counter.sink());
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kIo);
    EXPECT_EQ(written.error().offset, counter.bytes);
    EXPECT_EQ(counter.calls, n + 1);
  }
}

TEST(Writer, LeavesOutWhatIsEmpty) {
  RawPack pack = test::makeTinyPack();
  pack.info_json.clear();
  pack.clips.clear();
  EXPECT_FALSE(test::writeToMemory(pack).empty());
}

}  // namespace
}  // namespace kelp
