// SPDX-License-Identifier: MIT
// `kelp-dump extract`: refusals, and packs that are damaged. Each format has a test of its own.
#include <algorithm>
#include <map>

#include "extract_packs.h"
#include "support/fog_pack.h"

namespace kelp {
namespace {

class Extract : public testing::Test {
 protected:
  test::Scratch folder_;
};

TEST_F(Extract, AnotherProgramsTemporaryFileIsNoObstacle) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  // The shell's number is that of the program which it becomes.
  const test::ProcessResult result = test::runProcess({"/bin/sh", "-c",
                                                       "cd '" + folder_.folder().string() +
                                                           "' && : > .out.vox.$$-0.tmp && exec '" KELP_DUMP
                                                           "' extract ball.kelp --vox out.vox"});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.vox"));
}

TEST_F(Extract, RefusalsSayWhatToDo) {
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  const auto bytes = test::bytesOf(test::fogPack(test::fogOf({16, 16, 16}, test::puffs), 0.3f));
  const std::string fog = folder_.write("fog.kelp", std::span<const std::byte>(bytes)), out = folder_ / "out";
  const auto check = [&](std::vector<std::string> arguments, int exit, const std::string& says) {
    arguments.insert(arguments.begin(), "extract");
    const test::ProcessResult result = test::dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  check({pack, "--ply", out}, 1, "--ply is gone");
  check({pack, "--slices=" + out}, 1, "--slices is gone");
  check({pack, "--vox", out, "--part", "bell"}, 1, "there is no part 'bell'; parts are 0 'ball'");
  check({pack, "--vox", out, "--level", "2"}, 1, "there are levels 0 to 1");
  check({pack, "--vox", out, "--level", "-1"}, 1, "there are levels 0 to 1");
  check({pack, "--npy", "-"}, 1, "name a folder");
  check({pack, "--vox", folder_ / "nowhere/out.vox"}, 2,
        "No such file or directory; choose a folder that exists");
  check({pack, "--vox", folder_.folder()}, 2, "is a folder; name a file");
  check({pack, "--npy", pack}, 2, "is not a folder");
  check({fog, "--vox", out}, 5, "is fog, which MagicaVoxel cannot hold; use --vdb");
  const std::string far = test::writePackFile(
      folder_, "far.kelp", {test::rawPart(test::ball(test::scaled(1, {1e9f, 0, 0}), 3), "far")},
      test::paletteOf(3));
  check({far, "--vox", out}, 5, "from the origin");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
    EXPECT_EQ(entry.path().extension(), ".kelp") << entry.path() << " was left behind";
}

TEST_F(Extract, WhatIsNotBuiltInIsRefused) {
  const test::ProcessResult version = test::dump({"--version"});
  const std::string pack = test::writePackFile(
      folder_, "ball.kelp", {test::rawPart(test::ball(test::scaled(1), 3), "ball")}, test::paletteOf(3));
  for (const std::string format : {"vox", "proxy", "vdb", "nvdb"}) {
    const test::ProcessResult result = test::dump(
        {"extract", pack, "--" + format, folder_ / ("out." + (format == "proxy" ? "obj" : format))});
    const bool built = version.out.find(format == "vdb" ? " vdb" : format) != std::string::npos;
    EXPECT_EQ(result.exit, built ? 0 : 5) << format << ": " << result.err;
    // the program that is not there, or the library
    const std::string_view says = format == "vdb" || format == "nvdb" ? "is neither in" : "was built without";
    EXPECT_EQ(result.err.find(says) == std::string::npos, built) << result.err;
  }
}

// Well-formed packs whose voxels make no sense, and packs with a byte changed: nothing but an answer and, if
// that is 0, a file: of a damaged pack, the file of the sound one, since what is not read may be damaged.
TEST_F(Extract, WhateverAPackHoldsIsAnsweredInOrder) {
  std::mt19937 random(5);
  const std::string version = test::dump({"--version"}).out;
  std::vector<std::string> formats{"vox"};
  if (version.find(" vdb") != std::string::npos) formats.push_back("vdb");
  if (version.find("proxy") != std::string::npos) formats.push_back("proxy");
  for (int round = 0; round < 4; ++round) {
    std::vector<std::byte> bytes =
        test::writeToMemory(test::makeRandomPack(static_cast<std::uint32_t>(round + 1)));
    std::map<std::string, std::string> sound;
    for (int damage = 0; damage < 5; ++damage) {
      if (damage > 0) bytes[random() % bytes.size()] ^= std::byte{0x11};
      const std::string pack = folder_.write("random.kelp", std::span<const std::byte>(bytes));
      for (const std::string& format : formats) {
        const std::filesystem::path out = folder_ / ("out." + (format == "proxy" ? "off" : format));
        std::filesystem::remove(out);
        std::vector<std::string> arguments{"extract", pack, "--" + format, out};
        if (format == "proxy") arguments.insert(arguments.end(), {"--part", "0"});  // one file
        const test::ProcessResult result = test::dump(arguments);
        EXPECT_TRUE(result.exit == 0 || result.exit == 5 || (result.exit == 3 && damage > 0))
            << format << ": " << result.exit << " " << result.err;
        ASSERT_EQ(std::filesystem::exists(out), result.exit == 0);
        if (result.exit != 0) continue;
        std::string written = test::readWhole(out);
        if (format == "vdb") written.replace(21, 36, 36, '-');  // every VDB file has another UUID
        const auto [first, is_sound] = sound.try_emplace(format, written);
        EXPECT_EQ(is_sound, damage == 0);
        EXPECT_TRUE(written == first->second) << format << " of a damaged pack";
      }
    }
  }
}

}  // namespace
}  // namespace kelp
