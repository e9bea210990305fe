// SPDX-License-Identifier: MIT
// A .nvdb that NanoVDB's own library made is the same part as the .vdb that it was made of.
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include <zlib.h>

#include "bake_program.h"
#include "import_scratch.h"
#include "nvdb_peer.h"
#include "same_part.h"
#include "support/all_tests.h"
#include "support/assets.h"
#include "vdb_peer.h"

namespace kelp::bake::test {
namespace {

VdbSpec ball(const std::string& type, const std::string& grid_class) {
  VdbSpec spec;
  spec.name = type;
  spec.type = type;
  spec.grid_class = grid_class;
  spec.background = glm::dvec3(grid_class == "level set" ? 3 : 0);
  spec.to_world = glm::dmat4(0.25);
  spec.to_world[3] = glm::dvec4(1, -2, 3, 1);
  spec.low = glm::ivec3(-13);
  spec.high = glm::ivec3(13);
  spec.value = [=](const glm::ivec3& p) -> std::optional<glm::dvec3> {
    const double d = glm::length(glm::dvec3(p) * glm::dvec3(1, 1.3, 1.1)) - 9;
    if (d >= 3) return std::nullopt;
    if (type == "vec3s") return glm::abs(glm::dvec3(p)) / 13.0;
    if (type == "bool" || type == "mask") return d <= 0 ? std::optional(glm::dvec3(1)) : std::nullopt;
    return glm::dvec3(grid_class == "level set" ? d : 3 - d);
  };
  if (type != "vec3s") spec.tiles = {{{-24, 0, 8}, 1, glm::dvec3(grid_class == "level set" ? -3 : 1), true}};
  return spec;
}

TEST(Nvdb, EveryTypeAndCodecIsTheSamePart) {
  const Scratch scratch;
  const auto vdb = scratch.folder() / "a.vdb", nvdb = scratch.folder() / "a.nvdb";
  int made = 0;
  for (const char* type : {"float", "double", "int32", "int64", "bool", "mask"})
    for (const char* grid_class : {"level set", "fog volume"})
      for (const NvdbCodec codec : {NvdbCodec::kNone, NvdbCodec::kZip, NvdbCodec::kBlosc}) {
        if (!kelp::test::allTests() && made++ % 2 != 0) continue;
        const bool is_real = std::string(type) == "float" || std::string(type) == "double";
        // NanoVDB makes none
        if (!is_real && std::string(grid_class) == "level set") continue;
        SCOPED_TRACE(std::string(type) + " " + grid_class);
        VdbSpec color = ball("vec3s", "");
        color.name = "Cd";
        writeVdb(vdb, {ball(type, grid_class), color});
        writeNvdb(nvdb, vdb, "", codec);
        expectSame(nvdb, vdb);
      }
}

TEST(Nvdb, CodesAreWhatNanoVdbReadsInThem) {
  const Scratch scratch;
  const auto vdb = scratch.folder() / "a.vdb", nvdb = scratch.folder() / "b.nvdb",
             back = scratch.folder() / "b.vdb";
  for (const char* as : {"fp4", "fp8", "fp16", "fpn"})
    for (const char* grid_class : {"level set", "fog volume"}) {
      SCOPED_TRACE(std::string(as) + " " + grid_class);
      writeVdb(vdb, {ball("float", grid_class)});
      writeNvdb(nvdb, vdb, as, NvdbCodec::kBlosc, NvdbSum::kAll, back);
      expectSame(nvdb, back);
    }
}

TEST(Nvdb, TheAssetsAreTheSamePart) {
  const Scratch scratch;
  const auto nvdb = scratch.folder() / "real.nvdb";
  for (const char* name : {"vdb/gaffer_smoke.vdb", "vdb/openusd_densityAndHeat.vdb"}) {
    KELP_ASSET(path, name);
    writeNvdb(nvdb, path);
    expectSame(nvdb, path);
  }
}

TEST(Nvdb, HostileFilesAreRefused) {
  const Scratch scratch;
  const auto vdb = scratch.folder() / "a.vdb", nvdb = scratch.folder() / "a.nvdb";
  std::mt19937 random(7);
  const std::size_t cuts = kelp::test::allTests() ? 30 : 5;
  const int flips = kelp::test::allTests() ? 80 : 15;
  for (const NvdbSum sum : {NvdbSum::kNone, NvdbSum::kHead, NvdbSum::kAll})
    for (const NvdbCodec codec : {NvdbCodec::kBlosc, NvdbCodec::kZip, NvdbCodec::kNone}) {
      // Without KELP_ALL_TESTS each with one other.
      if (!kelp::test::allTests() && static_cast<int>(sum) + static_cast<int>(codec) != 2) continue;
      writeVdb(vdb, {ball("float", "level set")});
      writeNvdb(nvdb, vdb, sum == NvdbSum::kHead ? "fpn" : "", codec, sum);
      const std::string good = contentOf(nvdb);
      for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / cuts)
        refusal(scratch.write("cut.nvdb", good.substr(0, size)), Exit::kInvalid);
      for (int i = 0; i < flips; ++i) {
        std::string bad = good;
        // Where the places are: the file's head, the grid's, the tree's and the root's.
        const std::size_t reach = i % 4 == 0 ? bad.size() : std::min<std::size_t>(bad.size(), 1200);
        const std::size_t at = random() % reach;
        bad[at] ^= static_cast<char>(1u << random() % 8);
        const Baked baked = bakeHostile(scratch.write("flipped.nvdb", bad), "--max-memory 200M");
        // Between the file's head and the nodes, and of packed grids everywhere.
        if (sum == NvdbSum::kAll && codec == NvdbCodec::kNone && at > 300 && at < 900) {
          EXPECT_NE(baked.exit, 0) << at;
        }
      }
    }
  EXPECT_TRUE(contains(refusal(scratch.write("a.nvdb", ""), Exit::kInvalid), "is empty"));
  EXPECT_TRUE(
      contains(refusal(scratch.write("a.nvdb", "a text, and no volume"), Exit::kInvalid), "signature"));
  EXPECT_TRUE(contains(
      refusal(scratch.write("a.nvdb", std::string("NanoVDB2") + std::string(100, '\0')), Exit::kUnsupported),
      "version"));
}

// A grid without a voxel, `size` bytes of which nearly all are zeros.
std::string emptyNanoGrid(std::size_t size) {
  std::string bytes(size, '\0');
  const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof(value)); };
  put(0, std::uint64_t{0x304244566f6e614e});
  put(8, ~std::uint64_t{0});  // no checksum
  put(32, static_cast<std::uint64_t>(size));
  put(636, std::uint32_t{1});        // float
  put(672 + 24, std::uint64_t{64});  // the root, after the tree's head
  return bytes;
}

std::string zipped(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(8 + size, '\0');
  EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data() + 8), &size,
                      reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 9),
            Z_OK);
  const std::uint64_t stored = size;
  std::memcpy(packed.data(), &stored, sizeof(stored));
  packed.resize(8 + size);
  return packed;
}

struct StatedGrid {
  std::uint64_t size = 0, stored = 0;  // what is said of it
};
// A segment of zipped grids of float, named a, b and so on; `data` follows what is said of them.
std::string zipSegment(const std::vector<StatedGrid>& grids, const std::string& data) {
  std::string out;
  const auto put = [&](auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  put(std::uint64_t{0x304244566f6e614e});
  put(std::uint32_t{32u << 21});
  put(static_cast<std::uint16_t>(grids.size()));
  put(std::uint16_t{1});
  char name = 'a';
  for (const StatedGrid& grid : grids) {
    const std::size_t meta = out.size();
    put(grid.size);
    put(grid.stored);
    out.resize(meta + 176);
    const std::uint32_t type = 1, fog = 2, name_bytes = 2;
    std::memcpy(out.data() + meta + 32, &type, sizeof(type));
    std::memcpy(out.data() + meta + 36, &fog, sizeof(fog));
    std::memcpy(out.data() + meta + 136, &name_bytes, sizeof(name_bytes));
    out += {name++, '\0'};
  }
  return out + data;
}

TEST(Nvdb, GridsUnpackToNoMoreThanTheirBytesCanHold) {
  const Scratch scratch;
  const auto said = [&](const std::vector<StatedGrid>& grids, const std::string& data) {
    return refusal(scratch.write("a.nvdb", zipSegment(grids, data)), Exit::kInvalid);
  };
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  // 8 bytes that say that none follow.
  EXPECT_TRUE(contains(said({{256 * kMiB, 8}}, std::string(8, '\0')),
                       "grid 'a': says that its 8 bytes unpack to 256.0 MiB, more than they can"));
  EXPECT_TRUE(contains(said({{~std::uint64_t{0}, 8}}, std::string(8, '\0')), "more than they can"));

  // Grids of no bytes, or of too few, before one that has them: they would unpack its.
  const std::string grid = emptyNanoGrid(4096), packed = zipped(grid);
  const std::uint64_t size = grid.size(), stored = packed.size();
  EXPECT_TRUE(
      contains(said({{size, 0}, {size, stored}}, packed), "grid 'a': says that its 0 bytes unpack to"));
  EXPECT_TRUE(contains(said({{size, 8}, {size, stored - 8}}, packed), "grid 'a': goes on beyond byte"));
  // Pieces that end beyond their grid, and more, or less, than was said.
  said({{size, stored - 1}, {size, stored}}, packed + packed);
  said({{size + 1, stored}}, packed);
  said({{size - 1, stored}}, packed);
}

TEST(Nvdb, GridsHaveTheBytesOfTheirHeads) {
  const Scratch scratch;
  for (const std::uint64_t size : {0, 1, 671, 735}) {
    const std::string data = size == 0 ? "" : zipped(emptyNanoGrid(4096).substr(0, size));
    EXPECT_TRUE(
        contains(refusal(scratch.write("a.nvdb", zipSegment({{size, data.size()}}, data)), Exit::kInvalid),
                 "grid 'a': has " + std::to_string(size) + " bytes, fewer than its own head takes; "));
  }
}

TEST(Nvdb, TypesWithoutANameLeaveTheOtherGrids) {
  const Scratch scratch;
  const auto vdb = scratch.folder() / "a.vdb", nvdb = scratch.folder() / "a.nvdb";
  writeVdb(vdb, {ball("float", "level set"), ball("double", "fog volume")});
  writeNvdb(nvdb, vdb);
  std::string bytes = contentOf(nvdb);
  constexpr std::size_t kTypeAt = 16 + 32;  // behind the segment's head, of the first grid
  std::map<std::uint32_t, std::string> types = {
      {19, "Index"},   {20, "OnIndex"}, {23, "PointIndex"},           {24, "vec3u8"},
      {25, "vec3u16"}, {9, "half"},     {1u << 31, "type 2147483648"}};
  for (std::uint32_t type = 27; type <= 40; ++type) types.emplace(type, "type " + std::to_string(type));
  for (const auto& [type, name] : types) {
    std::memcpy(bytes.data() + kTypeAt, &type, sizeof(type));
    const auto path = scratch.write("other.nvdb", bytes);
    EXPECT_EQ(importFile(path, with([](Settings& s) { s.grid = "double"; })).format, "NanoVDB") << type;
    const std::string said = refusal(path, Exit::kUnsupported, with([](Settings& s) { s.grid = "float"; }));
    EXPECT_TRUE(contains(said, "'float' (" + name)) << said;
  }
}

TEST(Nvdb, BloscPiecesStayWithinTheirGrid) {
  const Scratch scratch;
  const auto vdb = scratch.folder() / "a.vdb", nvdb = scratch.folder() / "a.nvdb";
  writeVdb(vdb, {ball("float", "level set")});
  writeNvdb(nvdb, vdb, "", NvdbCodec::kBlosc);
  std::string bytes = contentOf(nvdb);
  std::uint64_t stored = 0;
  std::memcpy(&stored, bytes.data() + 16 + 8, sizeof(stored));
  for (const std::uint64_t less : {stored - 1, std::uint64_t{4096}}) {
    ASSERT_LT(less, stored);
    std::memcpy(bytes.data() + 16 + 8, &less, sizeof(less));
    refusal(scratch.write("less.nvdb", bytes), Exit::kInvalid);
  }
}

}  // namespace
}  // namespace kelp::bake::test
