// SPDX-License-Identifier: MIT
// A file that changes between two reads of it: what is read is refused, or it is one of the files that were
// there, whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "kelp/formats/pack.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "support/random_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

using Bytes = std::vector<std::byte>;

// A source of one size whose bytes `now` chooses for every read, by how many there were before.
class ChangingSource {
 public:
  ChangingSource(std::uint64_t size, std::function<const Bytes&(int read)> now)
      : size_(size), now_(std::move(now)) {}
  Source source() { return {&ChangingSource::read, this, size_}; }
  int reads() const { return reads_; }

 private:
  static Read read(void* user, std::uint64_t offset, std::span<std::byte> out) {
    auto& self = *static_cast<ChangingSource*>(user);
    const Bytes& bytes = self.now_(self.reads_++);
    EXPECT_LE(offset + out.size(), self.size_) << "read beyond the end";
    if (offset + out.size() > bytes.size()) return Read::kFailed;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
    return Read::kDone;
  }

  std::uint64_t size_;
  std::function<const Bytes&(int)> now_;
  int reads_ = 0;
};

// Reads everything there is; whether that went well and is none of `packs`.
bool readsSomethingElse(const Source& source, std::span<const RawPack> packs) {
  const Result<Pack> pack = Pack::open(source);
  if (!pack) return false;
  bool equal = false;
  for (const RawPack& raw : packs) {
    const test::Comparison comparison = test::compare(*pack, raw);
    if (!comparison.status) return false;
    equal = equal || comparison.equal;
  }
  return !equal;
}

// The tiny pack and one of the same shape and size in bytes with another color, another voxel and another
// clip.
std::vector<RawPack> twoPacks() {
  RawPack other = test::makeTinyPack();
  other.palette[0].base_color.x = 0.75f;
  other.parts[0].levels[0].attributes[0] = makeAttribute(1, encodeNormal({1, 0, 0}));
  other.clips[0].duration = 4.5f;
  return {test::makeTinyPack(), other};
}

TEST(ChangingSource, OneFileAfterTheOtherAtEveryRead) {
  const std::vector<RawPack> packs = twoPacks();
  const Bytes first = test::writeToMemory(packs[0]);
  const Bytes second = test::writeToMemory(packs[1]);
  ASSERT_EQ(second.size(), first.size());
  ChangingSource counting(first.size(), [&](int) -> const Bytes& { return first; });
  EXPECT_FALSE(readsSomethingElse(counting.source(), packs));
  ASSERT_GT(counting.reads(), 8);
  for (int change = 0; change <= counting.reads(); ++change) {
    for (const bool turned : {false, true}) {
      const Bytes *const before = turned ? &second : &first, *const after = turned ? &first : &second;
      ChangingSource source(first.size(),
                            [&](int read) -> const Bytes& { return read < change ? *before : *after; });
      EXPECT_FALSE(readsSomethingElse(source.source(), packs)) << "changed before read " << change;
      ChangingSource back(first.size(),
                          [&](int read) -> const Bytes& { return read == change ? *after : *before; });
      EXPECT_FALSE(readsSomethingElse(back.source(), packs)) << "changed for read " << change;
    }
  }
}

TEST(ChangingSource, OneThatGrowsOrShrinksAtEveryRead) {
  const std::vector<RawPack> packs = twoPacks();
  const Bytes whole = test::writeToMemory(packs[0]);
  const Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2));
  for (int change = 0; change < 64; ++change) {
    ChangingSource shrinks(whole.size(),
                           [&](int read) -> const Bytes& { return read < change ? whole : half; });
    EXPECT_FALSE(readsSomethingElse(shrinks.source(), packs)) << change;
    ChangingSource grows(half.size(), [&](int read) -> const Bytes& { return read < change ? half : whole; });
    EXPECT_FALSE(Pack::open(grows.source())) << change;
  }
}

// Bytes that are never twice the same: every read sees some others changed.
TEST(ChangingSource, NoTwoReadsAgree) {
  const std::vector<RawPack> packs = twoPacks();
  const Bytes whole = test::writeToMemory(packs[0]);
  std::mt19937 random(5);
  Bytes changed;
  int refused = 0;
  for (int turn = 0; turn < 2000; ++turn) {
    const int changes = 1 << turn % 8;
    ChangingSource source(whole.size(), [&](int) -> const Bytes& {
      changed = whole;
      for (int i = 0; i < changes; ++i)
        changed[random() % changed.size()] ^= static_cast<std::byte>(1 + random() % 255);
      return changed;
    });
    EXPECT_FALSE(readsSomethingElse(source.source(), packs));
    refused += Pack::open(source.source()) ? 0 : 1;
    verify(
        source.source(), {}, [](void*, const Issue&) {}, nullptr);
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace kelp
