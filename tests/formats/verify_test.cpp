// SPDX-License-Identifier: MIT
#include "kelp/formats/verify.h"
#include "kelp/formats/level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <tuple>

#include "pack_surgeon.h"
#include "support/all_tests.h"
#include "support/random_pack.h"
#include "support/short_memory.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

using test::Bytes;
using test::PackSurgeon;
using test::set;

// The issues, which are the same on any number of threads.
std::vector<Issue> issuesOf(const Bytes& bytes, const PackLimits& limits = {}) {
  std::vector<Issue> issues, on_one;
  MemorySource memory(bytes);
  const auto keep = [](void* user, const Issue& issue) {
    static_cast<std::vector<Issue>*>(user)->push_back(issue);
  };
  const std::uint64_t errors = verify(memory.source(), limits, keep, &issues, {}, 3);
  EXPECT_EQ(verify(memory.source(), limits, keep, &on_one), errors);
  const auto told = [](const Issue& i) {
    return std::make_tuple(i.id, i.severity, i.error.code, std::string(i.error.detail), i.error.offset,
                           i.part, i.level, i.page, i.knot);
  };
  EXPECT_TRUE(std::equal(issues.begin(), issues.end(), on_one.begin(), on_one.end(),
                         [&](const Issue& a, const Issue& b) { return told(a) == told(b); }));
  const auto is_error = [](const Issue& issue) { return issue.severity == Severity::kError; };
  EXPECT_EQ(errors, static_cast<std::uint64_t>(std::count_if(issues.begin(), issues.end(), is_error)));
  for (const Issue& issue : issues) EXPECT_STRNE(toString(issue.id), "Unknown issue.");
  return issues;
}

std::vector<IssueId> idsOf(const std::vector<Issue>& issues) {
  std::vector<IssueId> ids;
  for (const Issue& issue : issues) ids.push_back(issue.id);
  return ids;
}

using Ids = std::vector<IssueId>;

PackSurgeon tiny() { return PackSurgeon(test::writeToMemory(test::makeTinyPack())); }

TEST(Verify, SoundPacksHaveNoIssues) {
  EXPECT_EQ(idsOf(issuesOf(tiny().build())), Ids{});
  for (std::uint32_t seed = 0; seed < 10; ++seed)
    EXPECT_EQ(idsOf(issuesOf(test::writeToMemory(test::makeRandomPack(seed)))), Ids{});
}

TEST(Verify, AnUnreadableHeaderIsOneIssue) {
  EXPECT_EQ(idsOf(issuesOf({})), Ids{IssueId::kUnreadable});
  Bytes bytes = tiny().build();
  bytes.pop_back();
  EXPECT_EQ(idsOf(issuesOf(bytes)), Ids{IssueId::kUnreadable});
  PackSurgeon surgeon = tiny();
  surgeon.chunks.pop_back();
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kUnreadable});
}

TEST(Verify, UnknownChunksAreWarnings) {
  PackSurgeon surgeon = tiny();
  PackSurgeon::Chunk chunk;
  chunk.fourcc = PackSurgeon::fourcc("XTRA");
  chunk.content.resize(100000, std::byte{5});
  surgeon.chunks.insert(surgeon.chunks.begin() + 2, chunk);
  Bytes bytes = surgeon.build();
  const std::vector<Issue> issues = issuesOf(bytes);
  ASSERT_EQ(idsOf(issues), Ids{IssueId::kUnknownChunk});
  EXPECT_EQ(issues[0].severity, Severity::kWarning);
  // Its bytes are checked all the same.
  bytes[static_cast<std::size_t>(issues[0].error.offset) + 77777] ^= std::byte{1};
  EXPECT_EQ(idsOf(issuesOf(bytes)), (Ids{IssueId::kChunkChecksum, IssueId::kUnknownChunk}));
}

TEST(Verify, EveryChangedByteIsFound) {
  const Bytes bytes = tiny().build();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    Bytes changed = bytes;
    changed[at] ^= std::byte{0x10};
    ASSERT_FALSE(issuesOf(changed).empty()) << at;
  }
}

TEST(Verify, StainedPaddingIsFoundWhereItIs) {
  RawPack pack = test::makeTinyPack();
  pack.clips.clear();  // one chunk fewer, so that the index does not end at a multiple of 64
  Bytes bytes = test::writeToMemory(pack);
  const PackSurgeon surgeon(bytes);
  const std::size_t end_of_index = 64 + 48 * surgeon.chunks.size();
  ASSERT_NE(end_of_index % 64, 0u);
  bytes[end_of_index] = std::byte{1};
  const std::vector<Issue> issues = issuesOf(bytes);
  ASSERT_EQ(idsOf(issues), Ids{IssueId::kPaddingNotZero});
  EXPECT_EQ(issues[0].error.offset, end_of_index);
}

TEST(Verify, TablesThatContradictThemselvesAreNamed) {
  PackSurgeon surgeon = tiny();
  set(surgeon.content("MATL"), 4, 7.0f);
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kMetadata});
  surgeon = tiny();
  set(surgeon.content("RIGS"), 56 + 20, -20.0f);
  const std::vector<Issue> turns = issuesOf(surgeon.build());
  ASSERT_EQ(idsOf(turns), Ids{IssueId::kNotMonotone});
  EXPECT_EQ(turns[0].part, 0);
  EXPECT_EQ(turns[0].knot, 0);
  surgeon = tiny();
  set(surgeon.content("RIGS"), 140 + 28 + 20, -1.0f);  // the swept part's last tangent points back
  const std::vector<Issue> folds = issuesOf(surgeon.build());
  ASSERT_EQ(idsOf(folds), Ids{IssueId::kFolds});
  EXPECT_EQ(folds[0].error.code, ErrorCode::kCorrupt);
  EXPECT_EQ(folds[0].part, 1);
  EXPECT_EQ(folds[0].knot, 0);
  surgeon = tiny();
  set(surgeon.content("PART"), 132, std::int32_t{1});
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kMetadata});
  surgeon = tiny();
  set(surgeon.content("CLIP"), 24, -1.0f);
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kMetadata});
  surgeon = tiny();
  set(surgeon.content("SOCK"), 16, -1.0f);
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kMetadata});
  surgeon = tiny();
  set(surgeon.content("PART"), 17, std::uint8_t{1});  // one level fewer than there are chunks
  EXPECT_EQ(idsOf(issuesOf(surgeon.build())), Ids{IssueId::kUnreadable});
}

TEST(Verify, GridsAndPagesAreNamedWithTheirPlace) {
  PackSurgeon surgeon = tiny();
  surgeon.content("GRID")[0] = std::byte{200};
  std::vector<Issue> issues = issuesOf(surgeon.build());
  // The finer level cannot be read without the coarser one.
  ASSERT_EQ(idsOf(issues), (Ids{IssueId::kGrid, IssueId::kPage}));
  EXPECT_EQ(issues[0].part, 0);
  EXPECT_EQ(issues[0].level, 1);
  EXPECT_EQ(issues[1].level, 0);

  surgeon = tiny();
  surgeon.editPage([](Bytes& page) { page.push_back(std::byte{1}); });
  issues = issuesOf(surgeon.build());
  ASSERT_EQ(idsOf(issues), (Ids{IssueId::kPage, IssueId::kPage}));
  EXPECT_EQ(issues[0].part, 0);
  EXPECT_EQ(issues[0].level, 1);
  EXPECT_EQ(issues[0].page, 0);
  EXPECT_NE(issues[0].error.offset, Error::kNoOffset);
  EXPECT_EQ(issues[1].level, 0);
  EXPECT_EQ(issues[1].page, 0);
}

TEST(Verify, EverythingIsReportedInFileOrder) {
  PackSurgeon surgeon = tiny();
  set(surgeon.content("INFO"), 0, '\xff');
  set(surgeon.content("MATL"), 4, 7.0f);
  set(surgeon.content("RIGS"), 56 + 20, -20.0f);
  Bytes bytes = surgeon.build();
  bytes.back() ^= std::byte{1};  // in the last page
  const std::vector<Issue> issues = issuesOf(bytes);
  EXPECT_EQ(idsOf(issues), (Ids{IssueId::kMetadata, IssueId::kMetadata, IssueId::kNotMonotone,
                                IssueId::kChunkChecksum}));  // pages cannot be judged without the palette
  EXPECT_TRUE(std::is_sorted(issues.begin(), issues.end(),
                             [](const Issue& a, const Issue& b) { return a.error.offset < b.error.offset; }));
}

// Many parts take no more memory than one.
TEST(Verify, HoldsOnePartAtATime) {
  std::size_t peaks[2];
  for (const int parts : {1, 24}) {
    test::RandomPack random(3, {1, 80, 3, 0, 0});
    RawPack raw = random.make();
    raw.parts.resize(static_cast<std::size_t>(parts), raw.parts[0]);
    const Bytes bytes = test::writeToMemory(raw);
    MemorySource memory(bytes);
    test::ShortMemory counter;
    EXPECT_EQ(verify(memory.source(), {}, nullptr, nullptr, counter.allocator()), 0u);
    EXPECT_EQ(counter.live, 0u);
    peaks[parts > 1] = counter.peak_bytes;
  }
  EXPECT_LT(peaks[1], peaks[0] + 64 * 1024) << "tables of 24 parts, and the voxels of one";
}

// Nothing coarser is known of the only level, and its pages are beside each other.
TEST(Verify, AcceptsASingleLevelOfSeveralPages) {
  test::RandomPack random(31, {1, 8, 1, 0});
  RawPack raw = random.make();
  raw.parts[0].size = {101, 60, 97};
  raw.parts[0].knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  raw.parts[0].levels = {random.makeLevel(raw.parts[0].size, raw.palette.size(), 0.6f)};
  const Bytes bytes = test::writeToMemory(raw);
  EXPECT_EQ(idsOf(issuesOf(bytes)), Ids{});
  MemorySource memory(bytes);
  EXPECT_GT(Pack::open(memory.source())->readGrid(0, 0)->pages.size(), 1u);
}

// More pages than are read at once, many of them wrong, and finer ones that cannot be read without these.
TEST(Verify, NamesEveryPageThatIsWrongInOrder) {
  test::RandomPack random(32, {1, 8, 1, 0, 0});
  RawPack raw = random.make();
  raw.parts[0].size = {120, 60, 97};
  raw.parts[0].knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  raw.parts[0].levels = random.makeLevels(raw.parts[0].size, 2, raw.palette.size(), 0.9f);
  Bytes bytes = test::writeToMemory(raw);
  MemorySource memory(bytes);
  const Result<Pack> pack = Pack::open(memory.source());
  ASSERT_TRUE(pack);
  const LevelGrid fine = *pack->readGrid(0, 0), coarse = *pack->readGrid(0, 1);
  ASSERT_GT(fine.pages.size(), 20u);
  ASSERT_GT(coarse.pages.size(), 3u);
  const auto damage = [&](const PageInfo& page) {
    bytes[static_cast<std::size_t>(page.offset) + page.stored / 2] ^= std::byte{1};
  };
  for (std::size_t i = 0; i < fine.pages.size(); i += 7) damage(fine.pages[i]);
  damage(coarse.pages[1]);
  std::size_t chunks = 0, last_page = 0, damaged = 0, below = 0;
  for (const Issue& issue : issuesOf(bytes)) {
    if (issue.id == IssueId::kChunkChecksum) {
      ++chunks;
      continue;
    }
    ASSERT_EQ(issue.id, IssueId::kPage);
    const auto page = static_cast<std::size_t>(issue.page);
    if (issue.level == 1) {
      EXPECT_EQ(page, 1u);
      continue;
    }
    EXPECT_TRUE(page > last_page || damaged + below == 0) << "in order, each once";
    last_page = page;
    const bool without =
        issue.error.detail == std::string("a page of the next coarser level over it cannot be read");
    below += without;
    damaged += !without;
    EXPECT_TRUE(without || page % 7 == 0) << page;
  }
  EXPECT_EQ(chunks, 2u);
  EXPECT_GT(damaged, 0u);
  EXPECT_GT(below, 0u);
}

TEST(Verify, LimitsAndUnreadableSourcesAreIssuesToo) {
  PackLimits limits;
  limits.max_side = 10;
  EXPECT_EQ(idsOf(issuesOf(tiny().build(), limits)), Ids{IssueId::kMetadata});
  Source source;
  source.size = 1000;
  source.read = [](void*, std::uint64_t, std::span<std::byte>) { return Read::kFailed; };
  EXPECT_EQ(verify(source, {}, nullptr, nullptr), 1u);
  EXPECT_EQ(verify(Source{}, {}, nullptr, nullptr), 1u);
}

}  // namespace
}  // namespace kelp
