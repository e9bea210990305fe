// SPDX-License-Identifier: MIT
// MagicaVoxel files that are damaged, or were made to do harm.
#include <gtest/gtest.h>

#include "import_scratch.h"
#include "support/all_tests.h"
#include "vox_truth.h"

namespace kelp::bake::test {
namespace {

// A little of everything.
std::string sampler() {
  VoxMaker maker(200);
  maker.chunk("META", VoxMaker::dictionary({{"_anim_range", "0 9"}}));
  maker.box({3, 2, 2});
  maker.model({2, 2, 2}, {{0, 1, 1, 7}});
  maker.transform(0, 1, {{}});
  maker.group(1, {2, 4});
  maker.transform(2, 3, {{{"_f", "0"}, {"_r", "17"}, {"_t", "5 0 -3"}}, {{"_f", "5"}, {"_t", "1 1 1"}}},
                  {{"_name", "a"}, {"_loop", "1"}}, 1);
  maker.shape(3, {{0, {{"_f", "0"}}}, {1, {{"_f", "4"}}}});
  maker.transform(4, 5, {{{"_t", "0 4 0"}}}, {{"_hidden", "0"}}, 0);
  maker.shape(5, {{1, {}}});
  maker.layer(0, {{"_name", "l"}});
  maker.layer(1, {{"_hidden", "0"}});
  maker.material(7, {{"_type", "_metal"}, {"_metal", "0.5"}, {"_rough", "0.2"}});
  maker.chunk("rOBJ", VoxMaker::dictionary({{"_type", "_inf"}}));
  return maker.bytes();
}

// True if it was refused. Checks that the code and the message are those of a damaged file.
bool refusedWell(const std::filesystem::path& path, const std::string& what) {
  Settings settings;
  settings.max_memory = std::uint64_t{256} << 20;
  try {
    importFile(path, settings);
  } catch (const ToolError& error) {
    EXPECT_TRUE(error.exit == Exit::kInvalid || error.exit == Exit::kUnsupported ||
                error.exit == Exit::kRuntime)
        << what << ": " << error.what();
    EXPECT_TRUE(contains(error.what(), "; ")) << error.what();
    return true;
  }
  return false;
}

TEST(HostileVox, EveryTruncation) {
  const Scratch scratch;
  const std::string whole = sampler();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    SCOPED_TRACE(length);
    refusal(scratch.write("model.vox", whole.substr(0, length)), Exit::kInvalid);
  }
  // Cut, and the outer sizes made to fit: whatever is left must be whole.
  for (std::size_t length = 20; length < whole.size(); length += 3) {
    std::string cut = whole.substr(0, length);
    cut.replace(16, 4, VoxMaker::integer(static_cast<std::int64_t>(length) - 20));
    refusedWell(scratch.write("model.vox", cut), std::to_string(length));
  }
}

TEST(HostileVox, EveryByte) {
  const Scratch scratch;
  const std::string whole = sampler();
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const int value : {whole[at] ^ 1 << at % 8, whole[at] ^ 0x80, 0x7f, 0xff}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(value);
      refused += refusedWell(scratch.write("model.vox", changed),
                             "byte " + std::to_string(at) + " as " + std::to_string(value & 255));
    }
  EXPECT_GT(refused, whole.size());
}

TEST(HostileVox, Signatures) {
  const Scratch scratch;
  std::string whole = sampler();
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", ""), Exit::kInvalid), "is empty"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", "Xraw" + whole.substr(4)), Exit::kInvalid), "signature"));
  EXPECT_TRUE(contains(
      refusal(scratch.write("model.vox", whole.substr(0, 4) + VoxMaker::integer(151) + whole.substr(8)),
              Exit::kUnsupported),
      "version 151"));
  EXPECT_TRUE(contains(
      refusal(scratch.write("model.vox", whole.substr(0, 8) + "PACK" + whole.substr(12)), Exit::kInvalid),
      "MAIN"));
  EXPECT_TRUE(anyContains(importFile(scratch.write("model.vox", whole + "more"), {}).notices,
                          "4 bytes after the end"));
}

TEST(HostileVox, CountsBeyondTheFile) {
  const Scratch scratch;
  const auto made = [&](const std::string& id, const std::string& content) {
    VoxMaker maker;
    maker.box({2, 2, 2});
    if (id == "XYZI")
      maker.chunk("SIZE", VoxMaker::integer(200) + VoxMaker::integer(200) + VoxMaker::integer(200));
    maker.chunk(id, content);
    return scratch.write("model.vox", maker.bytes());
  };
  EXPECT_TRUE(contains(refusal(made("XYZI", VoxMaker::integer(std::int64_t{1} << 31)), Exit::kInvalid),
                       "claims 2147483648 voxels"));
  EXPECT_TRUE(contains(refusal(made("XYZI", VoxMaker::integer(0x20000000)), Exit::kInvalid),
                       "claims 536870912 voxels"));
  for (const char* id : {"nTRN", "nGRP", "nSHP", "LAYR", "MATL"})
    EXPECT_TRUE(
        contains(refusal(made(id, VoxMaker::integer(0) + VoxMaker::integer(0x7fffffff)), Exit::kInvalid),
                 "claims 2147483647 attributes"))
        << id;
  EXPECT_TRUE(
      contains(refusal(made("nGRP", VoxMaker::integer(0) + VoxMaker::dictionary({}) + VoxMaker::integer(-1)),
                       Exit::kInvalid),
               "claims 4294967295 children"));
  EXPECT_TRUE(contains(refusal(made("RGBA", std::string(1023, 'x')), Exit::kInvalid), "RGBA chunk at byte"));
  EXPECT_TRUE(contains(refusal(made("IMAP", ""), Exit::kInvalid), "IMAP chunk at byte"));
}

TEST(HostileVox, Sizes) {
  const Scratch scratch;
  const auto sized = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    VoxMaker maker;
    maker.chunk("SIZE", VoxMaker::integer(x) + VoxMaker::integer(y) + VoxMaker::integer(z));
    maker.chunk("XYZI", VoxMaker::integer(1) + std::string("\3\1\1\1", 4));
    return scratch.write("model.vox", maker.bytes());
  };
  EXPECT_EQ(importFile(sized(256, 256, 256), {}).parts.size(), 1u);
  EXPECT_TRUE(contains(refusal(sized(3, 9, 9), Exit::kInvalid), "a voxel outside its model"));
  EXPECT_TRUE(contains(refusal(sized(257, 9, 9), Exit::kInvalid), "a side of 257 voxels"));
  EXPECT_TRUE(contains(refusal(sized(9, 0x7fffffff, 9), Exit::kInvalid), "a side of 2147483647"));
  EXPECT_TRUE(contains(refusal(sized(9, 9, -1), Exit::kInvalid), "a side of -1"));
  refusal(sized(9, 9, 0), Exit::kInvalid);

  VoxMaker alone, twice, bare;
  alone.chunk("XYZI", VoxMaker::integer(0));
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", alone.bytes()), Exit::kInvalid), "no SIZE"));
  twice.chunk("SIZE", VoxMaker::integer(1) + VoxMaker::integer(1) + VoxMaker::integer(1));
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", twice.bytes()), Exit::kInvalid), "SIZE without voxels"));
  twice.chunk("SIZE", VoxMaker::integer(1) + VoxMaker::integer(1) + VoxMaker::integer(1));
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", twice.bytes()), Exit::kInvalid), "without voxels between"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", bare.bytes()), Exit::kUnsupported), "has no model"));
  bare.model({4, 4, 4}, {{1, 1, 1, 0}});
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", bare.bytes()), Exit::kUnsupported), "has no voxel"));
}

TEST(HostileVox, ScenesThatAreNone) {
  const Scratch scratch;
  const auto scene = [&](const auto& make) {
    VoxMaker maker;
    maker.box({2, 2, 2});
    make(maker);
    return scratch.write("model.vox", maker.bytes());
  };
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) { m.transform(0, 0, {{}}); }), Exit::kInvalid),
                       "node 0: is below itself"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) {
                                 m.transform(0, 1, {{}});
                                 m.group(1, {2, 3});
                                 m.transform(2, 4, {{}});
                                 m.shape(4, {{0, {}}});
                                 m.transform(3, 1, {{}});
                               }),
                               Exit::kInvalid),
                       "node 1: is below itself"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) { m.transform(0, 77, {{}}); }), Exit::kInvalid),
                       "node 77: is named but does not exist"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) { m.transform(5, 6, {{}}); }), Exit::kInvalid),
                       "node 0: is named but does not exist"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) {
                                 m.transform(0, 1, {{}});
                                 m.shape(1, {{1, {}}});
                               }),
                               Exit::kInvalid),
                       "shows model 1 of 1"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) {
                                 m.transform(0, 1, {{}});
                                 m.shape(1, {{-1, {}}});
                               }),
                               Exit::kInvalid),
                       "shows model -1"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) {
                                 m.transform(0, 1, {{}});
                                 m.shape(1, {{0, {}}});
                                 m.shape(1, {{0, {}}});
                               }),
                               Exit::kInvalid),
                       "second node 1"));
  EXPECT_TRUE(
      contains(refusal(scene([](VoxMaker& m) { m.transform(0, 1, {}); }), Exit::kInvalid), "has no frame"));
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) { m.shape(0, {}); }), Exit::kInvalid), "has no model"));
  for (const char* turn : {"0", "3", "5", "12", "128", "-1", "x", "1e9", "99999999999999999999"})
    EXPECT_TRUE(contains(refusal(scene([&](VoxMaker& m) {
                                   m.scene({{0, {{"_r", turn}}}});
                                 }),
                                 Exit::kInvalid),
                         "_r that makes no sense"))
        << turn;
  for (const char* shift : {"", "1 2", "1 2 x", "1 2 99999999999", "1 2 -2147483648", "nan 0 0"})
    EXPECT_TRUE(contains(refusal(scene([&](VoxMaker& m) {
                                   m.scene({{0, {{"_t", shift}}}});
                                 }),
                                 Exit::kInvalid),
                         "_t that makes no sense"))
        << shift;
  EXPECT_TRUE(contains(refusal(scene([](VoxMaker& m) {
                                 m.scene({{0, {{"_f", "-1"}}}});
                               }),
                               Exit::kInvalid),
                       "_f that makes no sense"));
}

TEST(HostileVox, FarPlaces) {
  const Scratch scratch;
  const auto pair = [&](const std::string& shift) {
    VoxMaker maker;
    maker.box({2, 2, 2});
    maker.scene({{0, {}}, {0, {{"_t", shift}}}});
    return scratch.write("model.vox", maker.bytes());
  };
  Settings settings;
  settings.max_memory = std::uint64_t{1} << 30;
  EXPECT_EQ(importFile(pair("0 0 8190"), settings).parts[0].grid->size, (glm::ivec3(2, 8192, 2)));
  EXPECT_TRUE(contains(refusal(pair("0 0 8191"), Exit::kUnsupported, settings), "spans 8193 voxels"));
  EXPECT_TRUE(contains(refusal(pair("4000 4000 4000"), Exit::kRuntime, settings), "GiB of memory"));
  settings.parts = Parts::kNodes;
  EXPECT_EQ(importFile(pair("4000 4000 4000"), settings).parts.size(), 2u);
  // Groups within groups, each a step further.
  VoxMaker maker;
  maker.box({2, 2, 2});
  for (int i = 0; i < 8; ++i) maker.transform(i, i + 1, {{{"_t", "16000000 0 0"}}});
  maker.shape(8, {{0, {}}});
  EXPECT_TRUE(
      contains(refusal(scratch.write("model.vox", maker.bytes()), Exit::kInvalid), "from the origin"));
}

TEST(HostileVox, DeepAndManifold) {
  const Scratch scratch;
  VoxMaker deep;
  deep.box({2, 2, 2});
  constexpr int kDepth = kelp::test::shareOf(200000);
  for (int i = 0; i < kDepth; ++i) deep.transform(i, i + 1, {{}});
  deep.shape(kDepth, {{0, {}}});
  EXPECT_EQ(importFile(scratch.write("model.vox", deep.bytes()), {}).parts.size(), 1u);
  // Every group names the next one twice: 2^40 shapes.
  VoxMaker wide;
  wide.box({2, 2, 2});
  for (int i = 0; i < 40; ++i) wide.group(i, {i + 1, i + 1});
  wide.shape(40, {{0, {}}});
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", wide.bytes()), Exit::kInvalid),
                       "more than 1048576 objects"));
  // A large model many times in one place.
  VoxMaker heavy;
  heavy.filled({64, 64, 64}, 1);
  std::vector<std::pair<int, VoxMaker::Attributes>> places(4097, {0, {}});
  heavy.scene(places);
  EXPECT_TRUE(contains(refusal(scratch.write("model.vox", heavy.bytes()), Exit::kUnsupported),
                       "more than 1073741824 voxels"));
}

// Names that are no text: bytes that are no UTF-8, controls of one byte and of two, and a long one that may
// not be cut within a letter. Found by fuzz_vox.
TEST(HostileVox, NamesThatAreNoText) {
  const std::string sign = "?";
  std::string fish;
  for (int i = 0; i < 27; ++i) fish += "\xe9\xad\x9a";  // 81 bytes
  const std::vector<std::pair<std::string, std::string>> names = {
      {"a\xff\xc0\x80z", "a" + sign + sign + sign + "z"},
      {"\xed\xa0\x80", sign + sign + sign},
      {"b\xc2\x9b\x1b[2J", "b [2J"},
      {"\xf0\x9f\x90\x9f\xf0\x9f", "\xf0\x9f\x90\x9f" + sign + sign},
      {fish, fish.substr(0, 78) + "..."}};
  Settings settings;
  settings.parts = Parts::kNodes;
  for (const auto& [name, shown] : names) {
    VoxMaker maker(200);
    maker.filled({1, 1, 1}, 5);
    maker.transform(0, 1, {{}});
    maker.group(1, {2});
    maker.transform(2, 3, {{}}, {{"_name", name}});
    maker.shape(3, {{0, {}}});
    const Scratch scratch;
    Report report;
    const RawPack pack = bake(scratch.write("model.vox", maker.bytes()), settings, report);
    ASSERT_EQ(pack.parts.size(), 1u);
    EXPECT_EQ(pack.parts[0].name, shown);
    EXPECT_NO_THROW(writePackFile(pack, scratch.folder() / "out.kelp", 1, report));
  }
}

}  // namespace
}  // namespace kelp::bake::test
