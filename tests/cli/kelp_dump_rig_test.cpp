// SPDX-License-Identifier: MIT
// kelp-dump rig --set without the baker: what changes, what stays, what is refused, and that a pack is the
// old or the new one at every time.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

#include "extract_packs.h"
#include "kelp/rig/rig.h"

namespace kelp {
namespace {

using nlohmann::json;
using test::ProcessResult;

constexpr const char* kNod =
    R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.4, "offset": [0.02, 0, 0]}, {"at": 1}], "clips": {"nod": {"waves": [{"knot": 2, "offset": [0.1, 0, 0], "period": 2}]}}, "sockets": {"tip": {"at": 1}}})";
constexpr const char* kSway =
    R"({"kelp": 1, "clips": {"sway": {"waves": [{"knot": 1, "offset": [0.1, 0, 0], "period": 4}]}, "nod": {"waves": [{"knot": 1, "tangent": [0.1, 0, 0], "period": 3}]}}})";

class SetRig : public testing::Test {
 protected:
  // Parts with these rigs, as kelp-bake would have written them.
  RawPack pack(const std::vector<std::string>& rigs,
               const std::string& options =
                   R"({"resolution": 32, "rig": {"name": "old.rig.json", "xxh3": "0"}, "fill": "auto"})") {
    RawPack raw;
    raw.info_json = R"({"tool":"kelp-bake 0.1.0","options":)" + json::parse(options).dump() + "}";
    raw.palette = test::paletteOf(3);
    for (std::uint32_t i = 0; i < rigs.size(); ++i) {
      raw.parts.push_back(test::rawPart(test::ball(test::scaled(0.01f), 3), "part " + std::to_string(i)));
      const RigDescription rig = parseRig(rigs[i]);
      const RawRig rest = realizeRig(rig);
      raw.parts[i].knots = rest.knots;
      raw.parts[i].automatic_tangents = rest.automatic_tangents;
      raw.parts[i].bend = rest.bend;
      raw.parts[i].roll = rest.roll;
      mergeClips(raw.clips, realizeClips(rig, i));
      for (RawSocket& socket : realizeSockets(rig, i)) raw.sockets.push_back(std::move(socket));
    }
    return raw;
  }
  std::string write(const RawPack& raw) const {
    return folder_.write("pack.kelp", std::span<const std::byte>(test::writeToMemory(raw)));
  }
  std::string writeRig(const std::string& text, const std::string& name = "new.rig.json") const {
    return folder_.write(name, text);
  }
  static ProcessResult set(const std::string& pack, const std::string& rig,
                           std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"rig", pack, "--set", rig});
    return test::dump(more);
  }
  // Everything but INFO.
  static bool same(const std::string& a, const std::string& b) {
    const json report = json::parse(test::dump({"diff", a, b, "--format", "json"}).out);
    for (const json& d : report["differences"])
      if (d["kind"] != "info") return ADD_FAILURE() << report.dump(1), false;
    return true;
  }

  test::Scratch folder_;
};

TEST_F(SetRig, IsThePackBakedWithThatRig) {
  const std::string expected =
      folder_.write("expected.kelp", std::span<const std::byte>(test::writeToMemory(pack({kNod}))));
  const std::string path = write(pack({kSway}));
  const ProcessResult result = set(path, writeRig(kNod), {"-o", folder_ / "out.kelp"});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("part 0 'part 0' has the rig of"), std::string::npos) << result.err;
  EXPECT_TRUE(same(folder_ / "out.kelp", expected));
  EXPECT_TRUE(same(path, write(pack({kSway}))));  // which was not touched
  // INFO names the new rig where kelp-bake does, and keeps the rest.
  const json info = json::parse(test::dump({"info", folder_ / "out.kelp", "--format", "json"}).out)["info"];
  EXPECT_EQ(info["options"]["rig"]["name"], "new.rig.json");
  EXPECT_EQ(info["options"]["rig"]["xxh3"].get<std::string>().size(), 16u);
  EXPECT_EQ(info["options"]["resolution"], 32);
  EXPECT_EQ(test::dump({"verify", folder_ / "out.kelp", "--format", "json"}).exit, 0);
}

// The roll, which is not one of whole degrees, to the bit.
TEST_F(SetRig, KeepsHowAPartBends) {
  const std::string swept =
      R"({"kelp": 1, "bend": "sweep", "roll": 12.3456789, "knots": [{"at": 0}, {"at": 1, "tangent": [0.1, 1, 0]}]})";
  const std::string path = write(pack({kSway}));
  const std::string expected =
      folder_.write("expected.kelp", std::span<const std::byte>(test::writeToMemory(pack({swept}))));
  const std::string described = test::dump({"rig", expected}).out;
  EXPECT_EQ(parseRig(described).bend, Bend::kSweep);
  EXPECT_EQ(parseRig(described).roll, parseRig(swept).roll);
  EXPECT_EQ(set(path, writeRig(described), {"-o", folder_ / "out.kelp"}).exit, 0);
  EXPECT_TRUE(same(folder_ / "out.kelp", expected));
  EXPECT_EQ(set(folder_ / "out.kelp", writeRig(test::dump({"rig", path}).out)).exit, 0);
  EXPECT_TRUE(same(folder_ / "out.kelp", path));
}

TEST_F(SetRig, OnePartOfSeveral) {
  const std::string path = write(pack({kSway, kNod, kSway}));
  const std::string rig = writeRig(kNod);
  EXPECT_EQ(set(path, rig, {"--part", "part 2", "-o", folder_ / "one.kelp"}).exit, 0);
  EXPECT_TRUE(same(
      folder_ / "one.kelp",
      folder_.write("a.kelp", std::span<const std::byte>(test::writeToMemory(pack({kSway, kNod, kNod}))))));
  // One after the other: nothing is left of the first, not even the length of a clip that they share.
  EXPECT_EQ(set(folder_ / "one.kelp", rig, {"--part", "0"}).exit, 0);
  EXPECT_TRUE(same(
      folder_ / "one.kelp",
      folder_.write("a.kelp", std::span<const std::byte>(test::writeToMemory(pack({kNod, kNod, kNod}))))));
  const std::string still = writeRig(R"({"kelp": 1})", "still.rig.json");
  for (const char* part : {"0", "1", "2"})
    EXPECT_EQ(set(folder_ / "one.kelp", still, {"--part", part}).exit, 0);
  EXPECT_EQ(json::parse(test::dump({"info", folder_ / "one.kelp", "--format", "json"}).out)["clips"],
            json::array());
  EXPECT_EQ(json::parse(test::dump({"info", folder_ / "one.kelp", "--format", "json"}).out)["sockets"].size(),
            3u)
      << "a rig without sockets leaves those that are there";
  const ProcessResult which = set(path, rig);
  EXPECT_EQ(which.exit, 1);
  EXPECT_NE(which.err.find("choose one of 0 'part 0', 1 'part 1', 2 'part 2' with --part"), std::string::npos)
      << which.err;
}

TEST_F(SetRig, WhatIsPrintedCanBeSetAgain) {
  const std::string path = write(pack({kNod, kSway}));
  for (const char* part : {"0", "1"}) {
    const std::string printed = writeRig(test::dump({"rig", path, "--part", part}).out, "printed.rig.json");
    EXPECT_EQ(set(path, printed, {"--part", part, "-o", folder_ / "again.kelp"}).exit, 0);
    EXPECT_TRUE(same(path, folder_ / "again.kelp"));
  }
}

TEST_F(SetRig, PresetsAreRigsToo) {
  const std::string path = write(pack({kNod}));
  EXPECT_EQ(set(path, "sway").exit, 0);
  EXPECT_EQ(json::parse(test::dump({"info", path, "--format", "json"}).out)["info"]["options"]["rig"],
            "sway");
  const ProcessResult swim = set(path, "swim");
  EXPECT_EQ(swim.exit, 3);
  EXPECT_NE(swim.err.find("bends along -z; the voxels were baked along +y: bake again with this rig, or turn "
                          "the preset with --axis +y"),
            std::string::npos)
      << swim.err;
  EXPECT_EQ(set(path, "swim", {"--axis", "+y"}).exit, 0);
  const json options = json::parse(test::dump({"info", path, "--format", "json"}).out)["info"]["options"];
  EXPECT_EQ(options["rig"], "swim");
  EXPECT_EQ(options["axis"], "+y");
}

TEST_F(SetRig, TheAxisMustBeThatOfTheVoxels) {
  // A part baked along -x of its file.
  RawPack raw = pack({kNod});
  const glm::mat3 turn = glm::transpose(axisRotation(Axis::kMinusX));
  for (int i = 0; i < 3; ++i) raw.parts[0].to_object[i] = 0.01f * turn[i];
  const std::string path = write(raw);
  EXPECT_EQ(json::parse(test::dump({"rig", path}).out)["axis"], "-x");
  const ProcessResult other = set(path, writeRig(R"({"kelp": 1, "axis": "-z"})"));
  EXPECT_EQ(other.exit, 3);
  EXPECT_NE(other.err.find("new.rig.json: part 0 'part 0': the rig bends along -z; the voxels were baked "
                           "along -x: bake again with this rig\n"),
            std::string::npos)
      << other.err;
  const ProcessResult none = set(path, writeRig(kNod));
  EXPECT_EQ(none.exit, 3);
  EXPECT_NE(none.err.find("bends along +y, as it names no axis; the voxels were baked along -x"),
            std::string::npos)
      << none.err;
  EXPECT_EQ(set(path, writeRig(kNod), {"--axis", "-x"}).exit, 0);
  EXPECT_EQ(set(path, writeRig(R"({"kelp": 1, "axis": "-x"})")).exit, 0);
  const ProcessResult both = set(path, writeRig(R"({"kelp": 1, "axis": "-x"})"), {"--axis", "+x"});
  EXPECT_EQ(both.exit, 1);
  EXPECT_NE(both.err.find("names the axis -x itself"), std::string::npos) << both.err;
  // kelp-bake was told --axis: a rig without one means that.
  raw.info_json = R"({"options":{"resolution":32,"axis":"-x"}})";
  EXPECT_EQ(set(write(raw), writeRig(kNod)).exit, 0);
  // Nobody can tell.
  raw.parts[0].to_object[0] += glm::vec3(0, 0, 0.004f);
  raw.info_json = "{}";
  const ProcessResult skewed = set(write(raw), writeRig(kNod));
  EXPECT_EQ(skewed.exit, 1);
  EXPECT_NE(skewed.err.find("give it with --axis"), std::string::npos) << skewed.err;
  EXPECT_EQ(set(path, writeRig(kNod), {"--axis", "-x"}).exit, 0);
  // Nor whether empty layers lie at the spline's ends.
  raw.info_json = R"({"options":{"axis":"-x","pad":2},"files":{)";
  for (int i = 0; i < 5000; ++i) raw.info_json += (i ? ",\"" : "\"") + std::to_string(i) + "\":null";
  raw.info_json += "}}";
  const ProcessResult unread = set(write(raw), writeRig(kNod), {"--axis", "-x"});
  EXPECT_EQ(unread.exit, 3);
  EXPECT_NE(unread.err.find("its INFO about the bake cannot be read"), std::string::npos) << unread.err;
}

TEST_F(SetRig, RefusesWhatTheBakerRefuses) {
  const std::string path = write(pack({kNod}));
  const std::string before = test::readWhole(path);
  const auto check = [&](const std::string& rig, int exit, const std::string& says) {
    const ProcessResult result = set(path, rig);
    EXPECT_EQ(result.exit, exit) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(test::readWhole(path), before) << "the pack was changed";
  };
  check(folder_ / "missing.rig.json", 2, "missing.rig.json: cannot be read: No such file");
  check(folder_.folder(), 2, "cannot be read: Is a directory");
  check(writeRig("{"), 3, "new.rig.json: ");
  check(writeRig(R"({"kelp": 1, "clips": {"s": {"waves": [{"knot": 1, "offset": [0, 0, 0], "perod": 1}]}}})"),
        3, "new.rig.json: /clips/s/waves/0/perod: unknown key; did you mean 'period'?");
  check(writeRig(R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1, "offset": [0, -2, 0]}]})"), 3,
        "new.rig.json: part 0 'part 0': knot 0 (at 0): the spline turns back");
  check(writeRig(
            R"({"kelp": 1, "clips": {"hop": {"waves": [{"knot": 1, "offset": [0, 1.5, 0], "period": 1}]}}})"),
        3, "hop");
  check(writeRig(std::string((16 << 20) + 5, ' ')), 3, "16 MiB");
  // Voxels lie where a straight rig has them, with empty layers at its ends.
  const std::string padded = write(pack({R"({"kelp": 1})"}, R"({"resolution": 32, "pad": 2})"));
  for (const char* rig : {kNod, R"({"kelp": 1, "sockets": {"tip": {"at": 1}}})"}) {
    const ProcessResult result = set(padded, writeRig(rig));
    EXPECT_EQ(result.exit, 3);
    EXPECT_NE(result.err.find("was baked with --pad 2 and a rig that does not bend"), std::string::npos)
        << result.err;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
}

TEST_F(SetRig, ReplacesThePackWhole) {
  const std::string path = write(pack({kNod})), link = folder_ / "link.kelp", rig = writeRig(kSway);
  std::filesystem::create_symlink("pack.kelp", link);
  ::chmod(path.c_str(), 0640);
  EXPECT_EQ(set(link, rig).exit, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
  RawPack expected = pack({kSway});
  expected.sockets = realizeSockets(parseRig(kNod), 0);  // kSway has none, so they stay
  EXPECT_TRUE(
      same(path, folder_.write("expected.kelp", std::span<const std::byte>(test::writeToMemory(expected)))));
  // A damaged page is found while it is copied: the old file stays.
  std::string bytes = test::readWhole(path);
  bytes[bytes.size() - 70] ^= 1;
  folder_.write("pack.kelp", bytes);
  const ProcessResult hurt = set(path, rig);
  EXPECT_EQ(hurt.exit, 3);
  EXPECT_NE(hurt.err.find("checksum"), std::string::npos) << hurt.err;
  EXPECT_EQ(test::readWhole(path), bytes);
  // A full disk.
  const ProcessResult full =
      test::runProcess({"/bin/sh", "-c",
                        std::string("'") + KELP_DUMP + "' rig '" + (folder_ / "expected.kelp").string() +
                            "' --set '" + rig + "' -o - > /dev/full"});
  EXPECT_EQ(full.exit, 2);
  EXPECT_EQ(set(folder_ / "expected.kelp", rig, {"-o", folder_ / "nowhere/out.kelp"}).exit, 2);
  EXPECT_EQ(set(folder_ / "expected.kelp", rig, {"-o", folder_.folder()}).exit, 2);
}

// What INFO says of a skin becomes the rig that divides it so.
TEST_F(SetRig, ASkinsRigComesFromInfo) {
  RawPack raw = pack({kNod, kSway, kNod});
  const auto printed = [&](const std::string& skin, std::vector<std::string> more = {}) {
    raw.info_json = R"({"tool":"kelp-bake 0.1.0","options":{"resolution":32},"skin":)" + skin + "}";
    more.insert(more.begin(), {"rig", write(raw)});
    return test::dump(more);
  };
  const std::string good =
      R"({"parts":[{"joints":["hip"],"fit":{"mean":0.1}},{"joints":["tail","tip"],"knots":4},{"joints":["hip"]}]})";
  const ProcessResult result = printed(good);
  EXPECT_EQ(result.exit, 0) << result.err;
  using Group = RigDescription::SkinGroup;
  EXPECT_EQ(parseRig(result.out).skin,
            (std::vector<Group>{Group{{"hip"}, 0, 2}, Group{{"tail", "tip"}, 4, 1}}));
  EXPECT_EQ(parseRig(printed(good, {"--part", "1"}).out).clips.size(), 2u);  // as ever
  EXPECT_EQ(parseRig(printed(good, {"--axis", "+x"}).out).clips.size(), 1u);
  // Anything else: a word about it, and the rig of the first part.
  const char* const kBad[] = {
      "3",
      "[]",
      "{}",
      R"({"parts":7})",
      R"({"parts":[]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":[3]}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":"c"}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":[]}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["\u001b[2J"]}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},7]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["c","d"],"knots":2}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["c","d"],"knots":1e99}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["c","d"],"knots":"5"}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["c"],"knots":5}]})",
      R"({"parts":[{"joints":["a"]},{"joints":["b"]},{"joints":["c","a"]}]})",
  };
  for (const char* bad : kBad) {
    const ProcessResult said = printed(bad);
    EXPECT_EQ(said.exit, 0) << bad << said.err;
    EXPECT_NE(said.err.find("what its INFO says of a skin cannot be used ("), std::string::npos)
        << bad << said.err;
    EXPECT_TRUE(parseRig(said.out).skin.empty()) << bad;
    EXPECT_EQ(parseRig(said.out).clips.size(), 1u) << bad;
  }
  // It is made by baking, not set.
  const std::string before = test::readWhole(write(raw));
  const ProcessResult refused = set(folder_ / "pack.kelp", writeRig(result.out));
  EXPECT_EQ(refused.exit, 3);
  EXPECT_NE(refused.err.find("/skin: "), std::string::npos) << refused.err;
  EXPECT_EQ(test::readWhole(folder_ / "pack.kelp"), before);
}

// Ctrl-C while a file is written: exit code 130, and nothing left behind.
TEST_F(SetRig, AnInterruptLeavesNoTemporaryFile) {
  RawPack raw;
  raw.info_json = "{}";
  raw.palette = test::paletteOf(3);
  RawPart& part = raw.parts.emplace_back();
  part.name = "noise";
  part.size = glm::ivec3(256);
  part.knots = test::figureKnots(test::kFigure6[0]);
  part.levels.push_back(test::RandomPack(1).makeLevel(part.size, 3, 0.3f));
  const std::string path = write(raw), out = folder_ / "out.ply";
  const auto leftovers = [&] {
    int found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.folder()))
      found += entry.path().extension() == ".tmp";
    return found;
  };
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGINT, SIG_DFL);
    ::execl(KELP_DUMP, KELP_DUMP, "extract", path.c_str(), "--ply", out.c_str(), static_cast<char*>(nullptr));
    ::_exit(99);
  }
  int status = 0;
  while (leftovers() == 0 && ::waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ASSERT_EQ(leftovers(), 1) << "it was faster than the test";
  ::kill(child, SIGINT);
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 130) << status;
  EXPECT_EQ(leftovers(), 0);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace kelp
