// SPDX-License-Identifier: MIT
// One file for each kind of content. While the format is not released they are renewed when it changes; from
// then on every version's files stay readable.
#include <gtest/gtest.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "kelp/formats/pack.h"
#include "kelp/formats/verify.h"
#include "pack_compare.h"
#include "support/random_pack.h"
#include "tiny_cage_pack.h"
#include "tiny_distance_pack.h"
#include "tiny_fog_pack.h"
#include "tiny_pack.h"

namespace kelp {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(KELP_SOURCE_DIR) / "tests/formats/golden";

std::vector<std::byte> readFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  const std::vector<char> chars{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> bytes(chars.size());
  std::memcpy(bytes.data(), chars.data(), chars.size());
  return bytes;
}

// A file, and what was written into it.
struct Golden {
  const char* name;
  RawPack (*make)();
};

const Golden kGoldens[] = {{"solid.kelp", test::makeTinyPack},
                           {"fog.kelp", test::makeTinyFogPack},
                           {"distance.kelp", test::makeTinyDistancePack},
                           {"empty.kelp", test::makeTinyEmptyPack},
                           {"joints.kelp", test::makeTinyJointPack},
                           {"cage.kelp", test::makeTinyCagePack},
                           {"morphs.kelp", test::makeTinyMorphPack}};

TEST(Golden, ReadsAsItWasWritten) {
  for (const Golden& golden : kGoldens) {
    SCOPED_TRACE(golden.name);
    Result<FileSource> file = FileSource::open((kFolder / golden.name).string().c_str());
    ASSERT_TRUE(file);
    Result<Pack> pack = Pack::open(file->source());
    ASSERT_TRUE(pack) << pack.error().detail;
    const test::Comparison result = test::compare(*pack, golden.make());
    ASSERT_TRUE(result.status);
    EXPECT_TRUE(result.equal);
    EXPECT_EQ(pack->minorVersion(),
              golden.make == test::makeTinyCagePack || golden.make == test::makeTinyMorphPack ? 3
              : golden.make == test::makeTinyJointPack                                        ? 2
              : golden.make == test::makeTinyEmptyPack                                        ? 1
                                                                                              : 0);
    EXPECT_EQ(verify(file->source(), {}, nullptr, nullptr), 0u);
  }
}

TEST(Golden, TheWriterStillWritesTheSameBytes) {
  // Another version of zstd may compress otherwise; it must then still decode to the same, which the test
  // above shows.
  if (ZSTD_versionNumber() != 10504) GTEST_SKIP() << "the golden files were compressed by zstd 1.5.4";
  for (const Golden& golden : kGoldens)
    EXPECT_EQ(test::writeToMemory(golden.make()), readFile(kFolder / golden.name)) << golden.name;
}

}  // namespace
}  // namespace kelp
