// SPDX-License-Identifier: MIT
// Every small fault of a pack of a few kilobytes: all 255 other values of every byte, every length, every two
// chunks of the index exchanged, and every byte of what the chunks hold changed under checksums that are
// right. Each is refused, or reads as the same content, or, under right checksums, as other content that
// keeps the rules; in memory that PackLimits and the file's size bound.
#include <gtest/gtest.h>

#include <span>

#include "kelp/formats/pack.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "pack_surgeon.h"
#include "support/all_tests.h"
#include "support/random_pack.h"
#include "support/short_memory.h"
#include "tiny_fog_pack.h"

namespace kelp {
namespace {

using test::Bytes;
using test::PackSurgeon;

// Solid parts with several levels and clips, and one of fog with heat.
const RawPack& specimen() {
  static const RawPack pack = [] {
    RawPack raw = test::RandomPack(11, {2, 17, 2, 2}).make();
    raw.palette.resize(16);
    for (RawPart& part : raw.parts)
      for (RawLevel& level : part.levels)
        for (std::uint32_t& attribute : level.attributes) attribute &= ~std::uint32_t{0xf0};
    raw.parts.push_back(test::makeTinyFogPack().parts.back());
    raw.parts.back().parent = -1;
    return raw;
  }();
  return pack;
}
const Bytes& specimenBytes() {
  static const Bytes bytes = test::writeToMemory(specimen());
  return bytes;
}

// Little more than the specimen needs.
constexpr PackLimits kLimits{16 << 10, 64, 8, 16 << 10};

enum class Outcome { kRefused, kSame, kOther };
Outcome tryPack(const Bytes& bytes) {
  MemorySource memory(bytes);
  test::ShortMemory counter;
  Outcome outcome = Outcome::kRefused;
  {
    const Result<Pack> pack = Pack::open(memory.source(), kLimits, counter.allocator());
    if (pack) {
      const test::Comparison all = test::compare(*pack, specimen(), counter.allocator());
      if (all.status) outcome = all.equal ? Outcome::kSame : Outcome::kOther;
    }
  }
  EXPECT_EQ(counter.live, 0u);
  EXPECT_LE(counter.peak_bytes, test::mostMemory(kLimits, bytes.size()));
  return outcome;
}

// The number of errors, in memory that is bounded, too.
std::uint64_t errorsOf(const Bytes& bytes) {
  MemorySource memory(bytes);
  test::ShortMemory counter;
  const std::uint64_t errors = verify(memory.source(), kLimits, nullptr, nullptr, counter.allocator());
  EXPECT_EQ(counter.live, 0u);
  EXPECT_LE(counter.peak_bytes, test::mostMemory(kLimits, bytes.size()));
  return errors;
}

TEST(Exhaustive, TheSpecimenIsSoundAndLargeEnough) {
  EXPECT_GE(specimenBytes().size(), 4096u);
  EXPECT_EQ(tryPack(specimenBytes()), Outcome::kSame);
  EXPECT_EQ(tryPack(PackSurgeon(specimenBytes()).build()), Outcome::kSame);
}

// In eight shares, for machines with several cores.
class ExhaustiveBytes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Eighth, ExhaustiveBytes, testing::Range(0, 8));

TEST_P(ExhaustiveBytes, AnyOtherValueIsRefusedOrHarmless) {
  Bytes bytes = specimenBytes();
  // Without KELP_ALL_TESTS some of the values, others at each byte.
  const unsigned step = test::kSanitized ? 64 : test::allTests() ? 1 : 16;
  std::size_t tried = 0, harmless = 0;
  for (std::size_t at = static_cast<std::size_t>(GetParam()); at < bytes.size(); at += 8) {
    const std::byte right = bytes[at];
    for (unsigned value = static_cast<unsigned>(at / 8) % step; value < 256; value += step) {
      if (static_cast<std::byte>(value) == right) continue;
      bytes[at] = static_cast<std::byte>(value);
      const Outcome outcome = tryPack(bytes);
      ++tried;
      ASSERT_NE(outcome, Outcome::kOther) << "byte " << at << " = " << value;
      harmless += outcome == Outcome::kSame ? 1 : 0;
      // The reader looks at no padding between chunks; verify does.
      if (outcome == Outcome::kSame && value % 51 == 0) {
        ASSERT_GT(errorsOf(bytes), 0u) << "byte " << at << " = " << value;
      }
    }
    bytes[at] = right;
  }
  if (step == 1) {
    EXPECT_EQ(tried, (bytes.size() + 7 - static_cast<std::size_t>(GetParam())) / 8 * 255);
  }
  EXPECT_LT(harmless, 255 * 64 * PackSurgeon(bytes).chunks.size() / 8);
}

TEST(Exhaustive, EveryLengthIsRefused) {
  const Bytes& bytes = specimenBytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Outcome outcome = tryPack(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    ASSERT_EQ(outcome, Outcome::kRefused) << size;
  }
}

// As they are, which the index's checksum gives away; under a new checksum; and the chunks themselves in that
// order.
TEST(Exhaustive, EveryTwoIndexEntriesExchanged) {
  const Bytes& bytes = specimenBytes();
  const PackSurgeon sound(bytes);
  const std::size_t count = sound.chunks.size();
  std::size_t other = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      Bytes changed = bytes;
      std::swap_ranges(changed.begin() + static_cast<std::ptrdiff_t>(64 + 48 * i),
                       changed.begin() + static_cast<std::ptrdiff_t>(64 + 48 * (i + 1)),
                       changed.begin() + static_cast<std::ptrdiff_t>(64 + 48 * j));
      EXPECT_EQ(tryPack(changed), Outcome::kRefused) << i << " and " << j;
      test::set(changed, 56, std::uint64_t{0});
      test::set(changed, 56, static_cast<std::uint64_t>(XXH3_64bits(changed.data(), 64 + 48 * count)));
      EXPECT_EQ(tryPack(changed), Outcome::kRefused) << i << " and " << j << ", stamped";
      PackSurgeon moved = sound;
      std::swap(moved.chunks[i], moved.chunks[j]);
      const Outcome outcome = tryPack(moved.build());
      other += outcome == Outcome::kRefused ? 0 : 1;
    }
  }
  EXPECT_LE(other, count);
}

// Changes that checksums cannot find: each byte of a chunk's content, with up to three other values.
TEST(Exhaustive, EveryByteBehindTheChecksums) {
  constexpr unsigned kChanges[] = {0xffu, 0x01u, 0x80u};
  const PackSurgeon sound(specimenBytes());
  std::size_t refused = 0, other = 0;
  for (std::size_t c = 0; c < sound.chunks.size(); ++c) {
    for (std::size_t at = 0; at < sound.chunks[c].content.size(); at += test::kSanitized ? 2 : 1) {
      for (const unsigned change : std::span(kChanges).first(test::shareOf(3))) {
        PackSurgeon surgeon = sound;
        surgeon.chunks[c].content[at] ^= static_cast<std::byte>(change);
        const Bytes bytes = surgeon.build();
        const Outcome outcome = tryPack(bytes);
        const std::uint64_t errors = errorsOf(bytes);
        ASSERT_TRUE(outcome != Outcome::kRefused || errors > 0) << "chunk " << c << ", byte " << at;
        (outcome == Outcome::kRefused ? refused : other) += 1;
      }
    }
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(other, 500u);
  std::printf("  %zu refused, %zu other content\n", refused, other);
}

}  // namespace
}  // namespace kelp
