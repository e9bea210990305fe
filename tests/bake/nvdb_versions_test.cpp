// SPDX-License-Identifier: MIT
// NanoVDB's files of other versions than the library's that the tests are built with: the same grids, in each
// form, with the checksums of each.
#include <cmath>
#include <cstring>

#include <blosc.h>
#include <zlib.h>

#include "bake_program.h"
#include "import_scratch.h"
#include "nvdb_peer.h"
#include "same_part.h"
#include "support/all_tests.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

VdbSpec ball(const std::string& name, const std::string& grid_class, double radius) {
  VdbSpec spec;
  spec.name = name;
  spec.grid_class = grid_class;
  spec.background = glm::dvec3(grid_class == "level set" ? 3 : 0);
  spec.low = glm::ivec3(-static_cast<int>(radius) - 3);
  spec.high = -spec.low;
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p)) - radius;
    if (grid_class == "level set") return d < 3 ? std::optional(glm::dvec3(d)) : std::nullopt;
    return d < 0 ? std::optional(glm::dvec3(-d)) : std::nullopt;
  };
  return spec;
}

std::size_t solidVoxels(const SourceModel& model) {
  std::size_t count = 0;
  for (const std::uint8_t solid : model.parts.at(0).grid->solid) count += solid != 0;
  return count;
}

constexpr std::uint32_t version(std::uint32_t major, std::uint32_t minor, std::uint32_t patch = 0) {
  return major << 21 | minor << 10 | patch;
}

template <class T>
T at(const std::string& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof(value));
  return value;
}
template <class T>
void put(std::string& bytes, std::size_t place, T value) {
  std::memcpy(bytes.data() + place, &value, sizeof(value));
}

std::uint32_t crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// A file of segments without compression, as the library writes it, taken apart.
struct Segment {
  std::string head;  // with what it says of the grids
  std::vector<std::string> grids;
};
std::vector<Segment> segmentsOf(const std::string& file) {
  std::vector<Segment> segments;
  for (std::size_t place = 0; place < file.size();) {
    Segment& segment = segments.emplace_back();
    const std::size_t begin = place;
    std::vector<std::size_t> sizes;
    const auto count = at<std::uint16_t>(file, place + 12);
    place += 16;
    for (int i = 0; i < count; ++i) {
      sizes.push_back(at<std::uint64_t>(file, place));
      place += 176 + at<std::uint32_t>(file, place + 136);
    }
    segment.head = file.substr(begin, place - begin);
    for (const std::size_t size : sizes) {
      segment.grids.push_back(file.substr(place, size));
      place += size;
    }
  }
  return segments;
}

// How a version sums what follows a grid's head.
enum class Tail { kNone, kNodes64, kNodes32, kPieces };

std::uint32_t tailOf(const std::string& rest, Tail tail, const std::vector<std::size_t>& node_sizes) {
  std::string sums;
  std::size_t place = 0;
  const auto sum = [&](std::size_t size) {
    const std::uint64_t one = crc(rest.substr(place, size));
    sums.append(reinterpret_cast<const char*>(&one), tail == Tail::kNodes64 ? 8 : 4);
    place += size;
  };
  if (tail == Tail::kNone) return ~std::uint32_t{0};
  if (tail == Tail::kPieces)
    for (std::size_t left = rest.size() / 4096; left > 0; --left) sum(left == 1 ? rest.size() - place : 4096);
  else
    for (const std::size_t size : node_sizes) sum(size);
  return crc(sums);
}

struct Habit {
  std::uint32_t version;
  std::string grid_magic;
  bool head_has_root;
  Tail tail;
};

// Of floats; nothing follows the nodes.
std::string rewritten(std::string grid, const Habit& habit) {
  constexpr std::size_t kTree = 672, kLeaf = 2144, kLower = 33856, kUpper = 270400;
  const std::size_t first = kTree + at<std::uint64_t>(grid, kTree + 16);
  std::vector<std::size_t> nodes;
  for (const auto& [count_at, size] : {std::pair(40, kUpper), {36, kLower}, {32, kLeaf}})
    nodes.insert(nodes.end(), at<std::uint32_t>(grid, kTree + count_at), size);
  grid.replace(0, 8, habit.grid_magic);
  put(grid, 16, habit.version);
  if (habit.version == version(32, 6)) grid.replace(664, 8, "NanoVDB1");
  const std::size_t mid = habit.head_has_root ? first : kTree + 64;
  put(grid, 8, crc(grid.substr(16, mid - 16)));
  put(grid, 12, tailOf(grid.substr(mid), habit.tail, nodes));
  return grid;
}

enum class Codec : std::uint16_t { kNone, kZip, kBlosc };

std::string packed(const std::string& grid, Codec codec) {
  if (codec == Codec::kNone) return grid;
  std::string out(8 + compressBound(grid.size()) + BLOSC_MAX_OVERHEAD, '\0');
  uLongf size = compressBound(grid.size());
  if (codec == Codec::kZip)
    compress2(reinterpret_cast<Bytef*>(out.data() + 8), &size, reinterpret_cast<const Bytef*>(grid.data()),
              grid.size(), 6);
  else
    size = static_cast<uLongf>(blosc_compress_ctx(5, 1, 4, grid.size(), grid.data(), out.data() + 8,
                                                  out.size() - 8, BLOSC_LZ4_COMPNAME, 0, 1));
  put(out, 0, std::uint64_t{size});
  return out.substr(0, 8 + size);
}

// The library's file as one of another version.
std::string fileOf(const std::string& library, const Habit& habit, const std::string& magic,
                   Codec codec = Codec::kNone) {
  std::string out;
  for (Segment& segment : segmentsOf(library)) {
    segment.head.replace(0, 8, magic);
    put(segment.head, 8, habit.version);
    put(segment.head, 14, codec);
    std::string data;
    std::size_t place = 16;
    for (const std::string& grid : segment.grids) {
      const std::string bytes = packed(rewritten(grid, habit), codec);
      put(segment.head, place + 8, std::uint64_t{bytes.size()});
      place += 176 + at<std::uint32_t>(segment.head, place + 136);
      data += bytes;
    }
    out += segment.head + data;
  }
  return out;
}

// The grids alone, one behind the other.
std::string rawOf(const std::string& library, const Habit& habit) {
  std::string out;
  for (const Segment& segment : segmentsOf(library))
    for (const std::string& grid : segment.grids) out += rewritten(grid, habit);
  return out;
}

const Habit kNewest{version(32, 9, 2), "NanoVDB1", false, Tail::kNone};

std::string libraryFile(const Scratch& scratch, const std::vector<VdbSpec>& grids) {
  const auto vdb = scratch.folder() / "peer.vdb", nvdb = scratch.folder() / "peer.nvdb";
  writeVdb(vdb, grids);
  writeNvdb(nvdb, vdb, "", NvdbCodec::kNone, NvdbSum::kNone);
  return contentOf(nvdb);
}

// As it was reported: what current OpenVDB makes of a level set.
TEST(NvdbVersions, ABallOfToday) {
  const Scratch scratch;
  const auto path = scratch.write(
      "ball.nvdb", fileOf(libraryFile(scratch, {ball("sphere", "level set", 4)}), kNewest, "NanoVDB2"));
  const SourceModel model = importFile(path, {});
  EXPECT_EQ(solidVoxels(model), 257u);  // whole numbers within a ball of radius 4
  EXPECT_EQ(model.parts[0].grid->size, glm::ivec3(9));
  EXPECT_EQ(model.format, "NanoVDB");
}

TEST(NvdbVersions, EveryVersionFormAndCodec) {
  const Scratch scratch;
  const std::string library =
      libraryFile(scratch, {ball("density", "fog volume", 9.3), ball("temperature", "", 7.1)});
  const auto vdb = scratch.folder() / "peer.vdb";
  const Habit habits[] = {
      {version(32, 3, 3), "NanoVDB0", true, Tail::kNodes64},
      {version(32, 4, 2), "NanoVDB0", true, Tail::kNodes32},
      {version(32, 4, 2), "NanoVDB0", true, Tail::kNone},
      {version(32, 6), "NanoVDB0", true, Tail::kPieces},
      {version(32, 6), "NanoVDB0", true, Tail::kNodes32},
      {version(32, 7), "NanoVDB1", false, Tail::kPieces},
      {version(32, 8), "NanoVDB1", false, Tail::kNone},
      {version(32, 9, 2), "NanoVDB1", false, Tail::kPieces},
  };
  constexpr bool sanitized = kelp::test::kSanitized;
  for (const Habit& habit : habits) {
    SCOPED_TRACE(std::to_string(habit.version >> 10 & 2047) + " " +
                 std::to_string(static_cast<int>(habit.tail)));
    const bool is_old = habit.grid_magic == "NanoVDB0";
    const Codec codecs[] = {Codec::kNone, Codec::kZip, Codec::kBlosc};
    const auto number = static_cast<std::size_t>(&habit - habits);
    for (const Codec codec : std::span(codecs).subspan(sanitized ? number % 3 : 0, sanitized ? 1 : 3))
      expectSame(scratch.write("other.nvdb", fileOf(library, habit, is_old ? "NanoVDB0" : "NanoVDB2", codec)),
                 vdb);
    if (habit.version >= version(32, 6)) expectSame(scratch.write("raw.nvdb", rawOf(library, habit)), vdb);
  }
}

// NanoVDB's own fog has the background of the level set that it was made of.
TEST(NvdbVersions, FogEndsWhereItsVoxelsEnd) {
  const Scratch scratch;
  std::string library = libraryFile(scratch, {ball("cloud", "fog volume", 6.4)});
  const std::size_t grid = segmentsOf(library).at(0).head.size(),
                    root = grid + 672 + at<std::uint64_t>(library, grid + 672 + 24);
  put(library, root + 28, 3.0f);
  const auto path = scratch.write("cloud.nvdb", fileOf(library, kNewest, "NanoVDB2"));
  expectSame(path, scratch.folder() / "peer.vdb");
  EXPECT_TRUE(anyContains(importFile(path, {}).notices, "background of 3"));
}

TEST(NvdbVersions, WrongSumsAreRefused) {
  const Scratch scratch;
  const std::string library = libraryFile(scratch, {ball("smoke", "fog volume", 9.3)});
  for (const Habit& habit : {Habit{version(32, 4), "NanoVDB0", true, Tail::kNodes64},
                             {version(32, 6), "NanoVDB0", true, Tail::kPieces},
                             {version(32, 9), "NanoVDB1", false, Tail::kPieces}}) {
    std::string good = fileOf(library, habit, "NanoVDB2");
    importFile(scratch.write("good.nvdb", good), {});
    // A voxel of the last leaf, and the name.
    for (const std::size_t place : {good.size() - 100, good.find("smoke", 200)}) {
      std::string bad = good;
      bad[place] ^= 4;
      EXPECT_TRUE(contains(refusal(scratch.write("bad.nvdb", bad), Exit::kInvalid), "wrong checksum"));
    }
    // The rule of another version.
    Habit wrong = habit;
    wrong.head_has_root = !habit.head_has_root;
    refusal(scratch.write("bad.nvdb", fileOf(library, wrong, "NanoVDB2")), Exit::kInvalid);
  }
}

TEST(NvdbVersions, WhatIsNewerIsNotDamaged) {
  const Scratch scratch;
  const std::string library = libraryFile(scratch, {ball("smoke", "fog volume", 5)});
  const auto said = [&](const std::string& bytes) {
    return refusal(scratch.write("a.nvdb", bytes), Exit::kUnsupported);
  };
  Habit newer = kNewest;
  for (const auto& [number, name] :
       {std::pair(version(32, 10), "32.10"), {version(32, 99), "32.99"}, {version(33, 0, 1), "33.0"}}) {
    newer.version = number;
    for (const std::string& bytes : {fileOf(library, newer, "NanoVDB2"), rawOf(library, newer)})
      EXPECT_TRUE(contains(said(bytes), std::string("version ") + name + "; up to 32.9 is read")) << name;
    // The grid alone says so; packed, it does so only where it is unpacked.
    std::string inner = fileOf(library, newer, "NanoVDB2", Codec::kZip);
    put(inner, 8, version(32, 7));
    EXPECT_TRUE(contains(said(inner), name));
  }
  newer.version = version(31, 2);
  EXPECT_TRUE(contains(said(fileOf(library, newer, "NanoVDB0")), "31.2; 32.0 to 32.9"));
  EXPECT_TRUE(contains(said(fileOf(library, kNewest, "NanoVDB3")), "'NanoVDB3'"));
  // A grid of another kind than the segment has.
  std::string bytes = fileOf(library, kNewest, "NanoVDB2");
  bytes.replace(bytes.size() - at<std::uint64_t>(bytes, 16), 8, "NanoVDB2");
  refusal(scratch.write("a.nvdb", bytes), Exit::kInvalid);
}

TEST(NvdbVersions, RawGridsThatAreCut) {
  const Scratch scratch;
  const std::string raw = rawOf(libraryFile(scratch, {ball("smoke", "fog volume", 5)}), kNewest);
  for (std::size_t size = 1; size < raw.size(); size += size < 1000 ? 37 : raw.size() / 7)
    refusal(scratch.write("cut.nvdb", raw.substr(0, size)), Exit::kInvalid);
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{735}, ~std::uint64_t{0}}) {
    std::string bytes = raw;
    put(bytes, 32, size);
    refusal(scratch.write("size.nvdb", bytes), Exit::kInvalid);
  }
}

TEST(NvdbVersions, NodesLieWithinTheirGrid) {
  const Scratch scratch;
  const std::string library = libraryFile(scratch, {ball("smoke", "fog volume", 5)});
  const Segment segment = segmentsOf(library).at(0);
  constexpr std::size_t kTree = 672, kMask = 32 + 512, kTable = 32 + 2 * 512 + 32;
  const std::size_t grid_at = segment.head.size(),
                    lower = grid_at + kTree + at<std::uint64_t>(library, grid_at + kTree + 8);
  std::size_t slot = 0;
  while (!(library[lower + kMask + slot / 8] >> slot % 8 & 1)) ++slot;
  const std::size_t child = lower + kTable + 8 * slot;
  const auto size = static_cast<std::int64_t>(segment.grids[0].size());
  for (const std::int64_t offset :
       {size, size - 2144, -size, std::int64_t{16}, std::int64_t{1} << 62, -(std::int64_t{1} << 62)}) {
    std::string bytes = library;
    put(bytes, child, offset);
    const Baked baked = bakeHostile(scratch.write("away.nvdb", bytes), "--max-memory 200M");
    EXPECT_EQ(baked.exit, 3) << offset << baked.text;
  }
  // Every cell leads to the same leaf.
  std::string bytes = library;
  for (std::size_t i = 0; i < 512; ++i) bytes[lower + kMask + i] = '\xff';
  for (std::size_t i = 0; i < 4096; ++i) put(bytes, lower + kTable + 8 * i, at<std::int64_t>(library, child));
  EXPECT_TRUE(contains(refusal(scratch.write("shared.nvdb", bytes), Exit::kInvalid), "room"));
}

// A tile of a type that came with 32.8: 4096 voxels a side of a density of 2.
TEST(NvdbVersions, NumbersOfOneByte) {
  constexpr std::size_t kTree = 672, kRoot = kTree + 64, kTile = kRoot + 64, kSize = kTile + 32;
  std::string bytes(kSize, '\0');
  bytes.replace(0, 8, "NanoVDB1");
  put(bytes, 8, ~std::uint64_t{0});
  put(bytes, 16, version(32, 8));
  put(bytes, 32, std::uint64_t{kSize});
  bytes.replace(40, 4, "gray");
  for (const std::size_t map : {384, 456})
    for (std::size_t i = 0; i < 3; ++i) put(bytes, map + 32 * i, 1.0);
  put(bytes, 632, std::uint32_t{2});
  put(bytes, 636, std::uint32_t{26});
  for (std::size_t level = 0; level < 4; ++level)
    put(bytes, kTree + 8 * level, std::uint64_t{level == 3 ? kRoot - kTree : kSize - kTree});
  put(bytes, kTree + 56, std::uint64_t{1} << 36);
  for (std::size_t i = 3; i < 6; ++i) put(bytes, kRoot + 4 * i, std::int32_t{4095});
  put(bytes, kRoot + 24, std::uint32_t{1});
  put(bytes, kTile + 16, std::uint32_t{1});
  put(bytes, kTile + 20, std::uint8_t{2});
  const Scratch scratch;
  const SourceModel model =
      importFile(scratch.write("gray.nvdb", bytes),
                 with([](Settings& s) { s.resolution = 8, s.resolution_given = true; }));
  ASSERT_TRUE(model.parts[0].fog);
  EXPECT_FLOAT_EQ(model.parts[0].fog->extinction, 2.0f * 4096 / 8);
}

}  // namespace
}  // namespace kelp::bake::test
