// SPDX-License-Identifier: MIT
// The published schema and the parser speak one language, and the examples of LANGUAGE.md are part of it.
#include <gtest/gtest.h>

#include <fstream>

#include "kelp/rig/rig_file.h"
#include "support/json_schema.h"

namespace kelp {
namespace {

const std::string kFolder = std::string(KELP_SOURCE_DIR) + "/tools/rig/";

bool parses(const std::string& text) {
  try {
    parseRigFile(text);
    return true;
  } catch (const RigError&) {
    return false;
  }
}

TEST(RigSchema, AcceptsTheExamplesOfItsPage) {
  std::ifstream file(kFolder + "LANGUAGE.md");
  const std::string readme((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const test::JsonSchema schema(kFolder + "rig.schema.json");
  int examples = 0;
  for (std::size_t at = readme.find("```json\n"); at != std::string::npos;
       at = readme.find("```json\n", at + 1)) {
    const std::string text = readme.substr(at + 8, readme.find("```", at + 8) - at - 8);
    const RigFile rigs = parseRigFile(text);
    EXPECT_EQ(schema.check(nlohmann::json::parse(text)), "") << text;
    EXPECT_EQ(schema.check(nlohmann::json::parse(printRigFile(rigs))), "") << text;
    std::vector<RigDescription> all{rigs.whole};
    for (const RigFile::PartRig& part : rigs.parts) all.push_back(part.rig);
    for (const RigDescription& rig : all) {
      const RawRig rest = realizeRig(rig);
      EXPECT_NO_THROW(checkRest(rest, {32, 256, 32}));
      EXPECT_NO_THROW(realizeSockets(rig, 0));
      for (const RawClip& clip : realizeClips(rig, 0))
        EXPECT_NO_THROW(proveClip(clip, 0, rest, {64, 128, 64}));
    }
    ++examples;
  }
  EXPECT_EQ(examples, 9);
}

TEST(RigSchema, AgreesWithTheParser) {
  const test::JsonSchema schema(kFolder + "rig.schema.json");
  for (const std::string& name : presetNames())
    EXPECT_EQ(schema.check(nlohmann::json::parse(printRig(*presetRig(name)))), "");
  const char* const kTakenByBoth[] = {
      R"({"kelp": 1, "parts": {"a": {}, "b c": {"kelp": 1, "bend": "sweep", "roll": 1}}})",
      R"({"kelp": 1, "bend": "cage", "cell": 16})",
      R"({"kelp": 1, "parts": {"a": {"bend": "cage", "cell": 2, "roll": 9}}})",
      R"({"kelp": 1, "cell": 4, "sides": {"-x-z": {}, "+x+y": {"knots": [{"at": 0}, {"at": 1}]}}})",
      R"({"kelp": 1, "parts": {"a": {"bend": "cage", "cell": 4, "sides": {"+y-z": {}}}}})",
      R"({"kelp": 1, "knots": [{"at": 0, "width": 2, "twist": -400}, {"at": 1, "width": [0.5, 1], "keep_volume": true}]})",
      R"({"kelp": 1, "clips": {"a": {"waves": [{"knot": 0, "width": [0.1, -3], "period": 1}, {"knot": 1, "twist": 4, "period": 1}]}}})",
      R"({"kelp": 1, "clips": {"a": {"duration": 1, "interpolation": "cubic", "keys": [{"time": 0, "knot": 0, "width": 0, "in": [1, 2]}, {"time": 1, "knot": 1, "twist": 90, "out": -1}]}}})",
  };
  for (const char* text : kTakenByBoth) {
    EXPECT_TRUE(parses(text)) << text;
    EXPECT_EQ(schema.check(nlohmann::json::parse(text)), "") << text;
  }
  const char* const kRefusedByBoth[] = {
      R"({})",
      R"({"kelp": 2})",
      R"({"kelp": 1, "axes": "+x"})",
      R"({"kelp": 1, "axis": "up"})",
      R"({"kelp": 1, "knots": [{"at": 0}]})",
      R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1, "offset": [1, 2]}]})",
      R"({"kelp": 1, "sockets": {"": {"at": 0}}})",
      R"({"kelp": 1, "sockets": {"hand": {}}})",
      R"({"kelp": 1, "sockets": {"hand": {"at": 1.5}}})",
      R"({"kelp": 1, "sockets": {"hand": {"at": 1, "scale": [1, 1, 1]}}})",
      R"({"kelp": 1, "sockets": {"hand": {"at": 1, "offset": [1, 0]}}})",
      R"({"kelp": 1, "sockets": {"hand": {"at": 1, "rotation": [0, 0, 1]}}})",
      R"({"kelp": 1, "parent_at": 1.5})",
      R"({"kelp": 1, "parent_at": -0.5})",
      R"({"kelp": 1, "bend": "twist"})",
      R"({"kelp": 1, "bend": "sweep", "roll": 181})",
      R"({"kelp": 1, "bend": "shear", "roll": 1})",
      R"({"kelp": 1, "roll": 1})",
      R"({"kelp": 1, "cell": 8})",
      R"({"kelp": 1, "bend": "sweep", "cell": 8})",
      R"({"kelp": 1, "bend": "cage", "cell": 1})",
      R"({"kelp": 1, "parts": {"a": {"bend": "shear", "cell": 8}}})",
      R"({"kelp": 1, "parts": {"a": {}}, "bend": "cage", "cell": 8})",
      R"({"kelp": 1, "sides": {}})",
      R"({"kelp": 1, "knots": [{"at": 0, "width": 0}, {"at": 1}]})",
      R"({"kelp": 1, "knots": [{"at": 0, "width": [1, 1, 1]}, {"at": 1}]})",
      R"({"kelp": 1, "knots": [{"at": 0, "twist": [1]}, {"at": 1}]})",
      R"({"kelp": 1, "knots": [{"at": 0, "keep_volume": 2}, {"at": 1}]})",
      R"({"kelp": 1, "clips": {"a": {"waves": [{"knot": 0, "width": 1, "twist": 1, "period": 1}]}}})",
      R"({"kelp": 1, "clips": {"a": {"keys": [{"time": 1, "width": 1}]}}})",
      R"({"kelp": 1, "sides": {"+x": {}}})",
      R"({"kelp": 1, "sides": {"+x-z": {"axis": "+y"}}})",
      R"({"kelp": 1, "sides": {"+x-z": {"knots": [{"at": 0}]}}})",
      R"({"kelp": 1, "bend": "sweep", "sides": {"+x-z": {}}})",
      R"({"kelp": 1, "bend": "cage", "roll": 1, "sides": {"+x-z": {}}})",
      R"({"kelp": 1, "bend": "shear", "cell": 8, "sides": {"+x-z": {}}})",
      R"({"kelp": 1, "parts": {"a": {"roll": 1, "sides": {"+x-z": {}}}}})",
      R"({"kelp": 1, "parts": {"a": {}}, "sides": {"+x-z": {}}})",
      R"({"kelp": 1, "skin": {}})",
      R"({"kelp": 1, "skin": {"parts": [{"joints": ["a"]}]}})",
      R"({"kelp": 1, "parts": {}})",
      R"({"kelp": 1, "parts": [{}]})",
      R"({"parts": {"a": {}}})",
      R"({"kelp": 1, "parts": {"": {}}})",
      R"({"kelp": 1, "parts": {"a": 1}})",
      R"({"kelp": 1, "parts": {"a": {"kelp": 2}}})",
      R"({"kelp": 1, "parts": {"a": {"roll": 1}}})",
      R"({"kelp": 1, "parts": {"a": {"knots": [{"at": 0}]}}})",
      R"({"kelp": 1, "parts": {"a": {"parts": {"a": {}}}}})",
      R"({"kelp": 1, "parts": {"a": {"skin": {"parts": [{"joints": ["a"]}]}}}})",
      R"({"kelp": 1, "parts": {"a": {}}, "axis": "+x"})",
      R"({"kelp": 1, "parts": {"a": {}}, "bend": "sweep", "roll": 1})",
      R"({"kelp": 1, "parts": {"a": {}}, "skin": {"parts": []}})",
      R"({"kelp": 1, "clips": {"": {"waves": [{"knot": 1, "offset": [0, 0, 0], "period": 1}]}}})",
      R"({"kelp": 1, "clips": {"c": {"waves": [{"knot": 1, "offset": [0, 0, 0], "tangent": [0, 0, 0], "period": 1}]}}})",
      R"({"kelp": 1, "clips": {"c": {"waves": [{"knot": 1, "offset": [0, 0, 0], "period": 0}]}}})",
      R"({"kelp": 1, "clips": {"c": {"waves": [{"knot": 1, "period": 1}]}}})",
      R"({"kelp": 1, "clips": {"c": {"keys": [{"time": 1, "offset": [0, 0, 0]}]}}})",
      R"({"kelp": 1, "clips": {"c": {"keys": [{"time": 1, "knot": 1, "scale": [0, 0, 0]}]}}})",
      R"({"kelp": 1, "clips": {"c": {"keys": [{"time": 1, "rotation": [0, 0, 0]}]}}})",
      R"({"kelp": 1, "clips": {"c": {"keys": [{"time": -1, "knot": 1, "offset": [0, 0, 0]}]}}})",
  };
  for (const char* text : kRefusedByBoth) {
    EXPECT_FALSE(parses(text)) << text;
    EXPECT_NE(schema.check(nlohmann::json::parse(text)), "") << text;
  }
}

}  // namespace
}  // namespace kelp
