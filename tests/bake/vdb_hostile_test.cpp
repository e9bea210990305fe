// SPDX-License-Identifier: MIT
// Files that were cut, changed or made up: refused as invalid or read as what they now say, in bounded time
// and memory.
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include "bake_program.h"
#include "import_scratch.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

VdbSpec small(const std::string& type, const std::string& grid_class) {
  VdbSpec spec;
  spec.name = type;
  spec.type = type;
  spec.grid_class = grid_class;
  spec.background = glm::dvec3(grid_class == "level set" ? 2 : 0);
  spec.low = glm::ivec3(-7);
  spec.high = glm::ivec3(7);
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p)) - 4;
    if (d >= 2) return std::nullopt;
    return glm::dvec3(grid_class == "level set" ? d : 2 - d);
  };
  return spec;
}

// With must_refuse: as damaged, or as too large.
void importHostile(const std::filesystem::path& path, bool must_refuse, const char* max_memory = "1G") {
  const Baked baked = bakeHostile(path, std::string("--max-memory ") + max_memory);
  if (must_refuse) {
    EXPECT_TRUE(baked.exit == 3 || baked.exit == 4) << baked.exit << baked.text;
    EXPECT_FALSE(contains(baked.text, "crashed")) << baked.text;
  }
}

std::vector<std::string> samples(const Scratch& scratch) {
  std::vector<std::string> files;
  const auto path = scratch.folder() / "good.vdb";
  for (const VdbCodec codec : {VdbCodec::kNone, VdbCodec::kZip, VdbCodec::kBlosc})
    for (const bool stream : {false, true}) {
      VdbSpec color = small("vec3s", "");
      color.name = "Cd";
      writeVdb(path, {small("float", "level set"), color}, codec, true, stream);
      files.push_back(contentOf(path));
    }
  for (const char* type : {"double", "int32", "bool", "mask"}) {
    VdbSpec spec = small(type, "");
    spec.half = true;
    writeVdb(path, {spec}, VdbCodec::kBlosc, false);
    files.push_back(contentOf(path));
  }
  return files;
}

TEST(VdbHostile, EveryCutIsRefused) {
  const Scratch scratch;
  const std::size_t cuts = kelp::test::allTests() ? 60 : 3;
  for (const std::string& good : samples(scratch)) {
    for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / cuts)
      importHostile(scratch.write("cut.vdb", good.substr(0, size)), true);
    importHostile(scratch.write("cut.vdb", good.substr(0, good.size() - 1)), true);
  }
  KELP_ASSET(path, "vdb/gaffer_arnold_sphere.vdb");
  const std::string real = contentOf(path);
  for (std::size_t size = 0; size < real.size(); size += 1 + real.size() / cuts)
    importHostile(scratch.write("cut.vdb", real.substr(0, size)), true);
}

TEST(VdbHostile, FlippedBitsDoNoHarm) {
  const Scratch scratch;
  std::mt19937 random(20);
  std::vector<std::string> files = samples(scratch);
  for (int i = 0; i < (kelp::test::allTests() ? 1000 : kelp::test::kSanitized ? 25 : 50); ++i) {
    std::string bad = files[static_cast<std::size_t>(i) % files.size()];
    // Headers and counts are few among so many values: half of the flips go to the first bytes.
    const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(bad.size(), 1200) : bad.size();
    for (int flips = 1 + i % 3; flips > 0; --flips)
      bad[random() % reach] ^= static_cast<char>(1u << random() % 8);
    importHostile(scratch.write("flipped.vdb", bad), false, "200M");
  }
}

TEST(VdbHostile, CountsThatTheFileDoesNotHoldAllocateNothing) {
  const Scratch scratch;
  std::string bytes;
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  const auto text = [&](const std::string& s) {
    put(static_cast<std::uint32_t>(s.size()));
    bytes += s;
  };
  put(std::int64_t{0x56444220});
  put(std::uint32_t{224});
  put(std::uint32_t{10});
  put(std::uint32_t{0});
  put(std::uint8_t{0});
  bytes += "01234567-89ab-cdef-0123-456789abcdef";
  const std::string header = bytes;
  put(std::uint32_t{0xffffffffu});  // metadata
  importHostile(scratch.write("a.vdb", bytes), true);
  bytes = header;
  put(std::uint32_t{1});
  put(std::uint32_t{0xfffffff0u});  // a name of 4 GiB
  importHostile(scratch.write("a.vdb", bytes), true);
  bytes = header;
  put(std::uint32_t{0});
  put(std::int32_t{0x7fffffff});  // grids
  importHostile(scratch.write("a.vdb", bytes), true);
  bytes = header;
  put(std::uint32_t{0});
  put(std::int32_t{1});
  text("a");
  text("Tree_float_5_4_3");
  text("");
  for (int i = 0; i < 3; ++i) put(std::int64_t{0});
  put(std::uint32_t{6});  // blosc and masks
  put(std::uint32_t{0});
  text("TranslationMap");
  for (int i = 0; i < 3; ++i) put(0.0);
  put(std::int32_t{1});
  put(1.0f);
  const std::string tree = bytes;
  put(std::uint32_t{0xffffffffu});  // tiles
  put(std::uint32_t{0xffffffffu});  // children
  importHostile(scratch.write("a.vdb", bytes), true);
  bytes = tree;
  put(std::uint32_t{0});
  put(std::uint32_t{1});
  for (int i = 0; i < 3; ++i) put(std::int32_t{0});
  bytes += std::string(8192, '\xff');  // every cell a child, of which there is none
  put(std::int8_t{6});
  put(std::int64_t{0x7ffffffffffffff0});
  importHostile(scratch.write("a.vdb", bytes), true);
  // A block of blosc that claims to be longer than it is.
  bytes.resize(bytes.size() - 8);
  put(std::int64_t{16});
  put(std::uint32_t{0x00001202u | 4u << 24});
  put(std::uint32_t{131072});
  put(std::uint32_t{131072});
  put(std::uint32_t{0x7fffffffu});
  bytes += std::string(4096, '\0');
  importHostile(scratch.write("a.vdb", bytes), true);
  // A node beside its place, or too far away.
  for (const int at : {1, 1 << 30}) {
    bytes = tree;
    put(std::uint32_t{1});
    put(std::uint32_t{0});
    for (int j = 0; j < 3; ++j) put(std::int32_t{at});
    put(-1.0f);
    put(std::uint8_t{1});
    importHostile(scratch.write("a.vdb", bytes), true);
  }
  // Solid from here to there: 60,000 of the largest tiles.
  bytes = tree;
  put(std::uint32_t{60000});
  put(std::uint32_t{0});
  for (int i = 0; i < 60000; ++i) {
    for (const int v : {i % 40, i / 40 % 40, i / 1600}) put(std::int32_t{v * 4096});
    put(-1.0f);
    put(std::uint8_t{1});
  }
  importHostile(scratch.write("a.vdb", bytes), false);
}

TEST(VdbHostile, OtherFilesAndVersionsAreNamed) {
  const Scratch scratch;
  EXPECT_TRUE(contains(refusal(scratch.write("a.vdb", ""), Exit::kInvalid), "is empty"));
  EXPECT_TRUE(contains(refusal(scratch.write("a.vdb", "NanoVDB0 and so on"), Exit::kInvalid), "signature"));
  const auto path = scratch.folder() / "b.vdb";
  writeVdb(path, {small("float", "level set")});
  std::string bytes = contentOf(path);
  bytes[8] = static_cast<char>(0xff);
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.vdb", bytes), Exit::kUnsupported), "version 255 of the format"));
  bytes[8] = 100;
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.vdb", bytes), Exit::kUnsupported), "version 100 of the format"));
}

// A file with offsets, byte by byte.
class HandMade {
 public:
  explicit HandMade(std::int32_t grids) {
    put(std::int64_t{0x56444220});
    for (const std::uint32_t version : {224u, 10u, 0u}) put(version);
    put(std::uint8_t{1});
    bytes_ += "01234567-89ab-cdef-0123-456789abcdef";
    put(std::uint32_t{0});  // metadata
    put(grids);
  }
  template <class T>
  void put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void text(const std::string& s) {
    put(static_cast<std::uint32_t>(s.size()));
    bytes_ += s;
  }
  void fill(std::size_t size) { bytes_ += std::string(size, '\0'); }
  // It states to be `less` bytes shorter than it is.
  void grid(const std::string& name, const std::string& parent, const std::function<void()>& body,
            std::size_t less = 0) {
    text(name);
    text("Tree_float_5_4_3");
    text(parent);
    const std::size_t places = bytes_.size(), begin = places + 24;
    fill(24);
    body();
    const auto end = static_cast<std::int64_t>(bytes_.size() - less);
    std::int64_t stated[] = {static_cast<std::int64_t>(begin),
                             parent.empty() ? static_cast<std::int64_t>(begin) : 0, end};
    std::memcpy(bytes_.data() + places, stated, sizeof(stated));
  }
  void transform() {
    text("TranslationMap");
    for (int i = 0; i < 3; ++i) put(0.0);
  }
  // One tile of fog.
  void tree(float value) {
    put(std::int32_t{1});
    put(0.0f);
    put(std::uint32_t{1});
    put(std::uint32_t{0});
    for (int i = 0; i < 3; ++i) put(std::int32_t{0});
    put(value);
    put(std::uint8_t{1});
  }
  void wholeGrid(const std::string& name, float value) {
    grid(name, "", [&] {
      put(std::uint32_t{2});
      put(std::uint32_t{0});
      transform();
      tree(value);
    });
  }
  std::size_t size() const { return bytes_.size(); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

TEST(VdbHostile, NoGridReadsTheBytesOfAnother) {
  const Scratch scratch;
  // The description of the grids ends in a text that reaches to a tree behind all of them.
  constexpr std::size_t kGrid = 4 + 1 + 4 + 16 + 4 + 24 + 12;
  HandMade shared(2);
  const std::size_t tail = shared.size() + 2 * kGrid;
  for (const char* name : {"a", "b"}) {
    shared.grid(name, "", [&] {
      shared.put(std::uint32_t{2});
      shared.put(std::uint32_t{1});
      shared.put(static_cast<std::uint32_t>(tail - shared.size() - 4));
    });
  }
  ASSERT_EQ(shared.size(), tail);
  for (int i = 0; i < 2; ++i) shared.text("");  // the rest of the metadata
  shared.transform();
  shared.tree(1);
  const std::string said = refusal(scratch.write("shared.vdb", shared.bytes()), Exit::kInvalid);
  EXPECT_TRUE(contains(said, "grid 'a': goes on beyond byte")) << said;

  // A transform, a tree that goes on.
  for (const std::size_t less : {1, 40, 60}) {
    HandMade beyond(1);
    beyond.grid(
        "a", "",
        [&] {
          beyond.put(std::uint32_t{2});
          beyond.put(std::uint32_t{0});
          beyond.transform();
          beyond.tree(1);
        },
        less);
    const std::string that = refusal(scratch.write("beyond.vdb", beyond.bytes()), Exit::kInvalid);
    EXPECT_TRUE(contains(that, "goes on beyond byte")) << less << ": " << that;
  }

  // Leaves, which are read only when the grid is wanted, of files by OpenVDB itself.
  const auto path = scratch.folder() / "good.vdb";
  for (const VdbCodec codec : {VdbCodec::kNone, VdbCodec::kZip, VdbCodec::kBlosc}) {
    writeVdb(path, {small("float", "level set")}, codec);
    std::string bytes = contentOf(path);
    EXPECT_TRUE(importFile(scratch.write("whole.vdb", bytes), {}).parts[0].grid);
    const std::size_t places = bytes.find("Tree_float_5_4_3") + 16 + 4;
    std::int64_t stated[3];
    std::memcpy(stated, bytes.data() + places, sizeof(stated));
    EXPECT_EQ(stated[2], static_cast<std::int64_t>(bytes.size()))
        << "OpenVDB ends a grid where its bytes end";
    --stated[2];
    std::memcpy(bytes.data() + places, stated, sizeof(stated));
    const std::string that = refusal(scratch.write("beyond.vdb", bytes), Exit::kInvalid);
    EXPECT_TRUE(contains(that, "goes on beyond byte")) << that;
  }
}

TEST(VdbHostile, ATreeIsThatOfTheFirstGridOfItsName) {
  const Scratch scratch;
  HandMade file(4);
  const auto instance = [&](const std::string& name, const std::string& parent) {
    file.grid(name, parent, [&] {
      file.put(std::uint32_t{2});
      file.put(std::uint32_t{0});
      file.transform();
    });
  };
  instance("before", "owner");
  file.wholeGrid("owner", 0.25f);
  file.wholeGrid("owner", 0.5f);
  instance("after", "owner");
  const auto path = scratch.write("instances.vdb", file.bytes());
  for (const char* name : {"before", "after"}) {
    const SourceModel model = importFile(
        path, with([&](Settings& s) { s.grid = name, s.resolution = 8, s.resolution_given = true; }));
    ASSERT_TRUE(model.parts[0].fog) << name;
    EXPECT_FLOAT_EQ(model.parts[0].fog->extinction, 0.25f * 4096 / 8) << name;
  }
  HandMade orphan(2);
  orphan.grid("a", "b", [&] {
    orphan.put(std::uint32_t{2});
    orphan.put(std::uint32_t{0});
    orphan.transform();
  });
  orphan.wholeGrid("c", 1);
  EXPECT_TRUE(contains(refusal(scratch.write("orphan.vdb", orphan.bytes()), Exit::kInvalid),
                       "shares the tree of a grid that is not there"));
}

}  // namespace
}  // namespace kelp::bake::test
