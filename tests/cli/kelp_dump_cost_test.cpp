// SPDX-License-Identifier: MIT
// Packs and rigs of a few kilobytes that name so much that work which grows with its square would take
// minutes; and those that other writers make, which kelp-dump leaves as they are.
#include <nlohmann/json.hpp>

#include "extract_packs.h"

namespace kelp {
namespace {

using test::ProcessResult;

class KelpDumpCost : public testing::Test {
 protected:
  ProcessResult dump(std::vector<std::string> arguments, int exit) {
    arguments.insert(arguments.begin(), KELP_DUMP);
    const ProcessResult result = test::runProcess(arguments);
    EXPECT_EQ(result.exit, exit) << arguments[1] << ": " << result.err;
    return result;
  }

  RawPack pack(const std::vector<std::string>& parts = {"a"}) const {
    RawPack pack;
    pack.palette = test::paletteOf(4);
    for (const std::string& name : parts)
      pack.parts.push_back(test::rawPart(test::ball(glm::mat4x3(1), 4), name));
    return pack;
  }
  std::string write(const std::string& name, const RawPack& pack) const {
    const std::vector<std::byte> bytes = test::writeToMemory(pack);
    return folder_.write(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

  test::Scratch folder_;
};

TEST_F(KelpDumpCost, DifferencesAreLinear) {
  RawPack few = pack(), many = pack();
  many.clips.assign(300000, RawClip{"", 1, {}, {}});
  const std::string a = write("a.kelp", few), b = write("b.kelp", many);
  const ProcessResult clips = dump({"diff", a, b}, 7);
  EXPECT_NE(clips.out.find("clip '' is in B alone"), std::string::npos) << clips.out.substr(0, 500);
  dump({"diff", b, b}, 0);
  // As many keys as an object may have, in each of many.
  const auto info = [](char letter) {
    std::string text = "[";
    for (int object = 0; object < 100; ++object) {
      text += object ? ",{" : "{";
      for (int key = 0; key < 4096; ++key)
        text += (key ? ",\"" : "\"") + std::string(1, letter) + std::to_string(key) + "\":0";
      text += "}";
    }
    return text + "]";
  };
  few.info_json = info('x');
  many = few;
  many.info_json = info('y');
  dump({"diff", write("a.kelp", few), write("b.kelp", many)}, 0);
  dump({"info", folder_ / "a.kelp"}, 0);
}

TEST_F(KelpDumpCost, ControlsAreEscapedInJson) {
  RawPack named = pack();
  named.info_json =
      "{\"program\": \"a\xc2\x9b"
      "31mRED\x7f\xc2\xa0\xc3\xa9\"}";
  const std::string path = write("a.kelp", named);
  const ProcessResult result = dump({"info", path, "--format", "json"}, 0);
  EXPECT_NE(result.out.find("a\\u009b31mRED\\u007f\xc2\xa0\xc3\xa9"), std::string::npos) << result.out;
  EXPECT_EQ(nlohmann::json::parse(result.out)["info"]["program"],
            nlohmann::json::parse(named.info_json)["program"]);
}

// SPEC.md asks no name of a clip to be its own, and none to move anything.
TEST_F(KelpDumpCost, SettingARigLeavesOtherPartsClipsAlone) {
  RawPack two = pack({"a", "b"});
  const Wave wave{1, 1, Target::kKnotOffset, {0.5f, 0, 0}, 2, 0};
  Wave other = wave;
  other.period = 3;
  two.clips = {{"walk", 2, {wave}, {}}, {"walk", 3, {other}, {}}, {"idle", 1, {}, {}}};
  const std::string before = write("before.kelp", two), after = folder_ / "after.kelp";
  dump({"rig", before, "--part", "a", "--set", "none", "--axis", "+y", "-o", after}, 0);
  const nlohmann::json clips =
      nlohmann::json::parse(dump({"info", after, "--format", "json"}, 0).out)["clips"];
  ASSERT_EQ(clips.size(), 3u) << clips;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(clips[i]["name"], "walk");
    EXPECT_EQ(clips[i]["waves"], 1);
  }
  EXPECT_EQ(clips[2]["name"], "idle");
  // Its own are replaced: "a" sways alone.
  dump({"rig", before, "--part", "a", "--set", "sway", "--axis", "+y", "-o", after}, 0);
  EXPECT_EQ(nlohmann::json::parse(dump({"info", after, "--format", "json"}, 0).out)["clips"].size(), 4u);
}

TEST_F(KelpDumpCost, InfoThatHasOtherRigsIsReplaced) {
  RawPack two = pack({"a", "b"});
  two.info_json = R"({"options":{},"rigs":5})";
  const std::string path = write("a.kelp", two);
  dump({"rig", path, "--part", "a", "--set", "sway", "--axis", "+y"}, 0);
  EXPECT_EQ(
      nlohmann::json::parse(dump({"info", path, "--format", "json"}, 0).out)["info"]["rigs"]["a"]["preset"],
      "sway");
}

// Waves whose periods have no common multiple: so many that no proof comes to its end in time.
TEST_F(KelpDumpCost, RigsThatTakeTooLongToProveAreRefused) {
  std::string waves;
  for (int period = 0; period < 60; ++period)
    for (int harmonic = 1; harmonic <= 16; ++harmonic)
      waves += (waves.empty() ? "" : ",") + std::string(R"({"knot": 1, "offset": [0, )") +
               std::to_string(0.0045 / harmonic) + R"(, 0], "period": )" +
               std::to_string((10 + 0.3437 * period) / harmonic) + "}";
  const std::string rig = folder_.write(
      "waves.rig.json",
      R"({"kelp": 1, "axis": "+y", "knots": [{"at": 0}, {"at": 0.5}, {"at": 1}], "clips": {"c": {"waves": [)" +
          waves + "]}}}");
  const std::string path = write("a.kelp", pack());
  const ProcessResult result = dump({"rig", path, "--set", rig, "-o", folder_ / "out.kelp"}, 3);
  EXPECT_NE(result.err.find("clip 'c', part 0: the segment"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace kelp
