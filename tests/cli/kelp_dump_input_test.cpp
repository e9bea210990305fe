// SPDX-License-Identifier: MIT
// Every sub-command on bad input: files that are no packs, packs with each small fault, contradictory
// options. And the promises of their output: schemas, help, how little info reads.
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "../formats/pack_surgeon.h"
#include "../formats/tiny_pack.h"
#include "extract_packs.h"
#include "support/all_tests.h"
#include "support/json_schema.h"

namespace kelp {
namespace {

using nlohmann::json;
using test::Bytes;
using test::ProcessResult;

class Input : public testing::Test {
 protected:
  // Every sub-command that reads a pack, on this one. Commands that write, write to standard output.
  std::vector<std::vector<std::string>> commands(const std::string& pack) {
    std::vector<std::vector<std::string>> all = {
        {"info", pack},        {"info", pack, "--count"},    {"info", pack, "--format", "json"},
        {"verify", pack},      {"verify", pack, "--deep"},   {"diff", pack, good_},
        {"diff", good_, pack}, {"rig", pack, "--part", "0"}, {"extract", pack, "--vox", "-"}};
    if (png_) all.push_back({"slice", pack, "-o", "-", "--part", "0"});
    return all;
  }
  // No crash, no output but verify's and of what differs; one line that helps.
  static void expectRefused(const ProcessResult& result, const std::vector<std::string>& command, int exit) {
    const std::string line = command[0] + " " + command[1] + ": " + result.err + result.out.substr(0, 300);
    EXPECT_EQ(result.exit, exit) << line;
    if (command[0] == "verify" && result.err.empty()) {
      EXPECT_NE(result.out.find("error"), std::string::npos) << line;
      return;
    }
    EXPECT_EQ(result.out, "") << line;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << line;
    EXPECT_EQ(result.err.rfind("kelp-dump: ", 0), 0u) << line;
    EXPECT_NE(result.err.find("; "), std::string::npos) << "no advice: " << line;
  }

  test::Scratch folder_;
  const Bytes bytes_ = test::writeToMemory(test::makeTinyPack());
  const std::string good_ = folder_.write("good.kelp", std::span<const std::byte>(bytes_));
  const bool png_ = test::dump({"slice", folder_ / "none.kelp", "-o", "-"}).exit != 5;
};

TEST_F(Input, FilesThatAreNoPacks) {
  const std::string empty = folder_.write("empty.kelp", ""),
                    text = folder_.write(
                        "text.kelp",
                        "This is not a pack, but a text that is long enough to be one, header and all.");
  for (const auto& command : commands(folder_ / "missing.kelp"))
    expectRefused(test::dump(command), command, 2);
  for (const auto& command : commands("-")) expectRefused(test::dump(command), command, 1);
  for (const auto& command : commands(folder_.folder())) expectRefused(test::dump(command), command, 2);
  for (const auto& command : commands(empty)) expectRefused(test::dump(command), command, 3);
  for (const auto& command : commands(text)) expectRefused(test::dump(command), command, 3);
  test::PackSurgeon newer(bytes_);
  newer.major = 2;
  const Bytes bytes = newer.build();
  const std::string later = folder_.write("later.kelp", std::span<const std::byte>(bytes));
  for (const auto& command : commands(later)) expectRefused(test::dump(command), command, 5);
}

// Right checksums around a small lie: what only the structure gives away.
TEST_F(Input, EachSmallFault) {
  using Edit = std::function<void(test::PackSurgeon&)>;
  const auto set = [](Bytes& bytes, std::size_t at, auto value) { test::set(bytes, at, value); };
  const std::vector<std::pair<const char*, Edit>> faults = {
      {"a chunk is missing", [](auto& s) { s.chunks.pop_back(); }},
      {"a chunk is there twice", [](auto& s) { s.chunks.insert(s.chunks.begin() + 2, s.chunks[1]); }},
      {"no parts", [&](auto& s) { set(s.content("PART"), 0, std::uint32_t{0}); }},
      {"a size of 2^31", [&](auto& s) { set(s.content("PART"), 20, std::uint32_t{0x80000000u}); }},
      {"an endless matrix", [&](auto& s) { set(s.content("PART"), 32, 1.0f / 0.0f); }},
      {"too many levels", [&](auto& s) { s.content("PART")[8 + 9] = std::byte{17}; }},
      {"a name that is not UTF-8", [](auto& s) { s.content("PART").back() = std::byte{0xff}; }},
      {"a color above 1", [&](auto& s) { set(s.content("MATL"), 4, 2.0f); }},
      {"65 knots", [&](auto& s) { set(s.content("RIGS"), 8, std::uint32_t{65}); }},
      {"knots that turn back", [&](auto& s) { set(s.content("RIGS"), 8 + 2 * 24 + 28 + 8, -90.0f); }},
      {"a swept part that folds",
       [&](auto& s) {
         set(s.content("RIGS"), 8 + 16, std::uint32_t{1});
         set(s.content("RIGS"), 8 + 2 * 24 + 16, 900.0f);
       }},
      {"a roll of a sheared part", [&](auto& s) { set(s.content("RIGS"), 8 + 20, 1.0f); }},
      {"a clip of no length", [&](auto& s) { set(s.content("CLIP"), 24, 0.0f); }},
      {"a wave of a part that is not there", [&](auto& s) { set(s.content("CLIP"), 36, std::uint32_t{7}); }},
      {"a raw size of 4 GiB", [](auto& s) { s.chunks[s.find("GRID")].raw_lie = std::uint64_t{4} << 30; }},
      {"an offset beyond the end", [](auto& s) { s.chunks.back().offset_lie = 1 << 20; }}};
  for (const auto& [what, edit] : faults) {
    SCOPED_TRACE(what);
    test::PackSurgeon surgeon(bytes_);
    edit(surgeon);
    const Bytes bytes = surgeon.build();
    const std::string bad = folder_.write("bad.kelp", std::span<const std::byte>(bytes));
    for (const auto& command : commands(bad)) expectRefused(test::dump(command), command, 3);
  }
}

// Bytes that flip, and files that end early: an answer in order, whatever it is, and never what a sound pack
// answers where the voxels are damaged.
TEST_F(Input, BytesThatFlip) {
  std::vector<Bytes> damaged;
  for (std::size_t i = 0; i < bytes_.size(); i += std::max<std::size_t>(1, bytes_.size() / 7)) {
    damaged.push_back(bytes_);
    damaged.back()[i] ^= std::byte{0x10};
    damaged.emplace_back(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (const Bytes& bytes : damaged) {
    const std::string bad = folder_.write("bad.kelp", std::span<const std::byte>(bytes));
    for (const auto& command : commands(bad)) {
      const ProcessResult result = test::dump(command);
      EXPECT_TRUE(result.exit == 0 || result.exit == 3 || result.exit == 5)
          << command[0] << " " << result.exit << result.err;
      if (command[0] == "verify") {
        EXPECT_NE(result.exit, 0);
      }
      if (result.exit != 0 && command[0] != "verify") {
        EXPECT_EQ(result.out, "") << command[0];
      }
    }
  }
}

TEST_F(Input, ContradictionsAreUsageErrors) {
  const std::string out = folder_ / "out";
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"inf"},
                                             {"info"},
                                             {"info", good_, good_},
                                             {"info", good_, "--deep"},
                                             {"verify", good_, "--count"},
                                             {"verify", good_, "--format", "xml"},
                                             {"diff", good_},
                                             {"diff", good_, good_, good_},
                                             {"rig", good_, "--format", "json"},
                                             {"rig", good_, "-o", out},
                                             {"rig", good_, "--set", out},  // is gone
                                             {"rig", good_, "--axis", "w"},
                                             {"extract", good_},
                                             {"extract", good_, "--vox", out, "--npy", out},
                                             {"schema", "knitting"},
                                             {"schema", "info", "verify"}}) {
    const ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(Input, EveryCommandExplainsItself) {
  for (const char* command : {"info", "verify", "diff", "rig", "extract", "slice", "schema"}) {
    const ProcessResult help = test::dump({command, "--help"});
    EXPECT_EQ(help.exit, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_NE(help.out.find(std::string("Examples:\n  kelp-dump ") + command), std::string::npos) << help.out;
    EXPECT_NE(help.out.find("Exit codes: 0 ok, 1 usage"), std::string::npos);
    EXPECT_NE(test::dump({"--help"}).out.find(std::string("\n  ") + command), std::string::npos);
  }
}

TEST_F(Input, SchemasAreThoseOfTheSource) {
  const std::string tools = std::string(KELP_SOURCE_DIR) + "/tools/";
  EXPECT_EQ(test::dump({"schema"}).out, test::readWhole(tools + "kelp-dump/kelp-dump.schema.json"));
  EXPECT_EQ(test::dump({"schema", "rig"}).out, test::readWhole(tools + "rig/rig.schema.json"));
  EXPECT_EQ(test::dump({"schema", "bake-report"}).out,
            test::readWhole(tools + "kelp-bake/kelp-bake-report.schema.json"));
  // The schema of a command takes that command's output and no other's.
  const std::vector<std::vector<std::string>> outputs = {
      {"info", good_}, {"verify", good_}, {"diff", good_, good_}};
  for (const auto& schema_of : outputs) {
    const std::string path =
        folder_.write(schema_of[0] + ".schema.json", test::dump({"schema", schema_of[0]}).out);
    const test::JsonSchema schema(path);
    for (auto command : outputs) {
      command.insert(command.end(), {"--format", "json"});
      EXPECT_EQ(schema.check(json::parse(test::dump(command).out)).empty(), command[0] == schema_of[0])
          << schema_of[0] << " " << command[0];
    }
  }
}

// Bytes that this process and the children that it has waited for have read, by read and pread alike; nothing
// where the system does not say.
std::optional<std::uint64_t> bytesRead() {
  std::ifstream io("/proc/self/io");
  std::string key;
  std::uint64_t value = 0;
  while (io >> key >> value)
    if (key == "rchar:") return value;
  return std::nullopt;
}

TEST_F(Input, InfoReadsAtMost64KiBOfALargePack) {
  // 128 x 128 x 128 voxels in 6 levels; the bricks are noise, which makes the file large.
  RawPack pack;
  pack.info_json = R"({"tool": "a test"})";
  pack.palette = test::paletteOf(256);
  RawPart& part = pack.parts.emplace_back();
  part.name = "large";
  part.size = glm::ivec3(128);
  part.knots = test::figureKnots(test::kFigure6[0]);
  part.levels = test::RandomPack(1).makeLevels(part.size, 6, 256, 0.3f);
  const std::string path =
      folder_.write("large.kelp", std::span<const std::byte>(test::writeToMemory(pack, 2)));
  ASSERT_GT(std::filesystem::file_size(path), 1u << 20);

  // Bytes that a program reads without a pack: its libraries.
  const auto readBy = [](const std::vector<std::string>& arguments) {
    const std::optional<std::uint64_t> before = bytesRead();
    const ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    return *bytesRead() - *before - result.out.size() - result.err.size();  // which the test has read
  };
  if (!bytesRead()) GTEST_SKIP() << "/proc/self/io is absent: this system does not count what processes read";
  const std::uint64_t none = readBy({"schema"});
  EXPECT_LE(readBy({"info", path}), none + 65536);
  EXPECT_LE(readBy({"info", path, "--format", "json"}), none + 65536);
  EXPECT_GT(readBy({"info", path, "--count"}), none + (1u << 20));  // the counter counts
  // Nor does it matter what is in the voxels.
  std::string bytes = test::readWhole(path);
  const std::string before = test::dump({"info", path, "--format", "json"}).out;
  std::fill(bytes.begin() + 65536, bytes.end(), '\x55');
  folder_.write("large.kelp", bytes);
  EXPECT_EQ(test::dump({"info", path, "--format", "json"}).out, before);
}

// Exit code 4: what no machine can do. 0 to 3, 5 and 7 are elsewhere in these tests.
TEST_F(Input, WhatDoesNotFitIntoMemoryIsAFailureAtRunTime) {
  if (!png_) GTEST_SKIP() << "this kelp-dump was built without libpng";
  if (test::kSanitized) return;  // it is large: takes a minute
  RawPack pack;
  pack.palette.resize(1);
  RawPart& part = pack.parts.emplace_back();
  const auto memory = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  part.size = {1024, std::min(32768, static_cast<int>(memory / 12 / 1024 / 1024) + 64), 1024};
  if (part.size.y > 8192) GTEST_SKIP() << "this machine has more memory than a pack can ask for";
  part.knots = test::figureKnots(test::kFigure6[0]);
  const glm::ivec3 grid = brickGrid(part.size);
  RawLevel& level = part.levels.emplace_back();
  level.cells.resize(static_cast<std::size_t>(grid.x) * static_cast<std::size_t>(grid.y) *
                     static_cast<std::size_t>(grid.z));
  level.cells[0] = kCellSolid;
  level.codes.assign(kBrickVoxels, 0);
  level.codes[0] = kSurfaceCode;
  level.attributes = {0};
  const std::string path = folder_.write("vast.kelp", std::span<const std::byte>(test::writeToMemory(pack)));
  EXPECT_LT(std::filesystem::file_size(path), 100000u);
  const ProcessResult result = test::dump({"slice", path, "-o", "-", "--what", "clearance"});
  EXPECT_EQ(result.exit, 4) << result.err;
  EXPECT_NE(result.err.find("this machine has"), std::string::npos) << result.err;
  EXPECT_EQ(test::dump({"slice", path, "-o", folder_ / "ok.png", "--axis", "y", "--at", "0"}).exit, 0);
}

}  // namespace
}  // namespace kelp
