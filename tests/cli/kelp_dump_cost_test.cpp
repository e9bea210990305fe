// SPDX-License-Identifier: MIT
// Packs and rigs of a few kilobytes that name so much that work which grows with its square would take
// minutes; and INFO of other writers.
#include <nlohmann/json.hpp>

#include "extract_packs.h"
#include "kelp/rig/rig_file.h"

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

TEST_F(KelpDumpCost, ASkinsRigComesFromInfo) {
  RawPack raw = pack({"a", "b", "c"});
  raw.clips = {{"nod", 2, {Wave{0, 1, Target::kKnotOffset, {0.1f, 0, 0}, 2, 0}}, {}},
               {"sway", 4, {Wave{1, 1, Target::kKnotOffset, {0.1f, 0, 0}, 4, 0}}, {}}};
  const auto printed = [&](const std::string& skin, std::vector<std::string> more = {}) {
    raw.info_json = R"({"tool":"kelp-bake 0.1.0","options":{"resolution":32},"skin":)" + skin + "}";
    more.insert(more.begin(), {"rig", write("pack.kelp", raw)});
    return test::dump(more);
  };
  // The rigs that a rig file gave to parts; the skin makes the others.
  const ProcessResult given = printed(R"({"rigs":["b","z"]})");
  EXPECT_EQ(given.exit, 0) << given.err;
  const RigFile file = parseRigFile(given.out);
  ASSERT_EQ(file.parts.size(), 1u);
  EXPECT_EQ(file.parts[0].name, "b");
  EXPECT_EQ(file.parts[0].rig.clips.size(), 1u);
  EXPECT_EQ(parseRig(printed(R"({"rigs":[]})", {"--part", "1"}).out).clips.size(), 1u);
  for (const char* none : {R"({"rigs":[]})", "{}", R"({"rigs":3})", R"({"rigs":["\u001b[2J"]})"}) {
    const ProcessResult said = printed(none);
    EXPECT_NE(said.exit, 0) << none;
    EXPECT_NE(said.err.find("a skin moves its parts, and none has a rig of its own"), std::string::npos)
        << none << said.err;
  }
  EXPECT_EQ(parseRigFile(printed("3").out).parts.size(), 3u) << "no skin";
}

TEST_F(KelpDumpCost, NamesThatNoRigFileHas) {
  for (const auto& [names, said] :
       {std::pair<std::vector<std::string>, const char*>{{"a", "a"}, "stands twice"},
        {{"a", ""}, "1 to 255 bytes"}}) {
    const ProcessResult result = test::dump({"rig", write("pack.kelp", pack(names))});
    EXPECT_EQ(result.exit, 3);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("--part INDEX"), std::string::npos) << result.err;
    EXPECT_EQ(test::dump({"rig", write("pack.kelp", pack(names)), "--part", "1"}).exit, 0);
  }
}

}  // namespace
}  // namespace kelp
