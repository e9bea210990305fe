// SPDX-License-Identifier: MIT
// The grammar of rigs: what is read, what is refused and with which words, and that printing is the inverse
// of reading.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseRig(text);
  } catch (const RigError& error) {
    return error.what();
  }
  return "";
}

// A rig with one wave or one key, written as `entry`.
std::string withWave(const std::string& entry) {
  return R"({"kelp": 1, "clips": {"c": {"waves": [)" + entry + "]}}}";
}
std::string withKeys(const std::string& entries) {
  return R"({"kelp": 1, "clips": {"c": {"keys": [)" + entries + "]}}}";
}

TEST(ParseRig, PlantOfTheDesign) {
  const RigDescription rig = parseRig(R"({"kelp": 1, "clips": {"sway": {"waves": [
  {"knot": 1, "offset":  [0.15, 0, 0.04], "period": 3.2},
  {"knot": 1, "tangent": [0.40, 0, 0.10], "period": 3.2, "phase": -0.05}]}}})");
  EXPECT_FALSE(rig.axis);
  EXPECT_TRUE(rig.knots.empty());
  ASSERT_EQ(rig.clips.size(), 1u);
  const auto& clip = rig.clips[0];
  EXPECT_EQ(clip.name, "sway");
  EXPECT_FALSE(clip.duration);
  ASSERT_EQ(clip.waves.size(), 2u);
  EXPECT_EQ(clip.waves[0], (RigDescription::Wave{1, Target::kKnotOffset, {0.15f, 0, 0.04f}, 3.2f, 0}));
  EXPECT_EQ(clip.waves[1], (RigDescription::Wave{1, Target::kKnotTangent, {0.40f, 0, 0.10f}, 3.2f, -0.05f}));
}

TEST(ParseRig, FishOfTheDesign) {
  const RigDescription rig = parseRig(
      R"({"kelp": 1, "axis": "-x", "knots": [{"at": 0}, {"at": 0.45}, {"at": 1}], "clips": {"swim": {"waves": [
  {"knot": 0, "offset": [0, 0, 0.02], "period": 0.8},
  {"knot": 1, "offset": [0, 0, 0.05], "period": 0.8, "phase": -0.2},
  {"knot": 2, "offset": [0, 0, 0.20], "period": 0.8, "phase": -0.5}]}}})");
  EXPECT_EQ(rig.axis, Axis::kMinusX);
  ASSERT_EQ(rig.knots.size(), 3u);
  EXPECT_EQ(rig.knots[1], (RigDescription::Knot{0.45f, glm::vec3(0), std::nullopt}));
  ASSERT_EQ(rig.clips.at(0).waves.size(), 3u);
  EXPECT_EQ(rig.clips[0].waves[2],
            (RigDescription::Wave{2, Target::kKnotOffset, {0, 0, 0.20f}, 0.8f, -0.5f}));
}

TEST(ParseRig, KeysBecomeTracks) {
  const RigDescription rig =
      parseRig(R"({"kelp": 1, "clips": {"nod": {"duration": 4, "interpolation": "cubic", "keys": [
    {"time": 0, "knot": 1, "offset": [0, 0, 0]},
    {"time": 0, "rotation": [0, 0, 0, 1], "interpolation": "linear"},
    {"time": 1, "knot": 1, "offset": [0.1, 0, 0], "in": [1, 2, 3], "out": [4, 5, 6]},
    {"time": 2, "rotation": [0, 0.6, 0, 0.8]},
    {"time": 0.5, "scale": [1, 1.5, 1], "interpolation": "step"}]}}})");
  const auto& clip = rig.clips.at(0);
  EXPECT_EQ(clip.duration, 4.0f);
  ASSERT_EQ(clip.tracks.size(), 3u);
  EXPECT_EQ(clip.tracks[0].target, Target::kKnotOffset);
  EXPECT_EQ(clip.tracks[0].knot, 1);
  EXPECT_EQ(clip.tracks[0].interpolation, Interpolation::kCubic);
  ASSERT_EQ(clip.tracks[0].keys.size(), 2u);
  EXPECT_FALSE(clip.tracks[0].keys[0].in);
  EXPECT_EQ(clip.tracks[0].keys[1].out, glm::vec4(4, 5, 6, 0));
  EXPECT_EQ(clip.tracks[1].target, Target::kPartRotation);
  EXPECT_EQ(clip.tracks[1].interpolation, Interpolation::kLinear);
  EXPECT_EQ(clip.tracks[1].keys.at(1).value, glm::vec4(0, 0.6f, 0, 0.8f));
  EXPECT_EQ(clip.tracks[2].interpolation, Interpolation::kStep);
  EXPECT_EQ(clip.tracks[2].keys.at(0).value, glm::vec4(0, 0.5f, 0, 0));
}

TEST(ParseRig, SocketsOfTheReadme) {
  const RigDescription rig = parseRig(R"({"kelp": 1, "parent_at": 0.7, "sockets": {
    "hand": {"at": 0.9, "offset": [0.1, 0, 0.05], "rotation": [0, 0.6, 0, 0.8]},
    "elbow": {"at": 0.5}}})");
  EXPECT_EQ(rig.parent_at, 0.7f);
  ASSERT_EQ(rig.sockets.size(), 2u);
  EXPECT_EQ(rig.sockets[0],
            (RigDescription::Socket{"hand", 0.9f, {0.1f, 0, 0.05f}, glm::quat(0.8f, 0, 0.6f, 0)}));
  EXPECT_EQ(rig.sockets[1], (RigDescription::Socket{"elbow", 0.5f, {}, glm::quat(1, 0, 0, 0)}));
  EXPECT_EQ(parseRig(R"({"kelp": 1, "parent_at": -1})"), parseRig(R"({"kelp": 1})"));
  EXPECT_EQ(parseRig(R"({"kelp": 1})").parent_at, -1.0f);
}

TEST(ParseRig, ARigSaysHowItsPartBends) {
  EXPECT_EQ(parseRig(R"({"kelp": 1})").bend, std::nullopt);
  EXPECT_EQ(parseRig(R"({"kelp": 1, "bend": "shear"})").bend, Bend::kShear);
  const RigDescription rig = parseRig(R"({"kelp": 1, "roll": -90, "bend": "sweep"})");
  EXPECT_EQ(rig.bend, Bend::kSweep);
  EXPECT_FLOAT_EQ(rig.roll, -1.57079633f);
  EXPECT_EQ(parseRig(R"({"kelp": 1, "bend": "sweep", "roll": 180})").roll, 3.14159274f);
  const RigDescription caged = parseRig(R"({"kelp": 1, "bend": "cage", "roll": 180})");
  EXPECT_EQ(caged.bend, Bend::kSweep);
  EXPECT_TRUE(caged.caged && !rig.caged);
  EXPECT_EQ(caged.cell, 0);
  EXPECT_EQ(parseRig(R"({"kelp": 1, "cell": 4, "bend": "cage"})").cell, 4);
}

TEST(ParseRig, ARigHas1024SocketsAtMost) {
  const auto withSockets = [](int count) {
    std::string text = R"({"kelp": 1, "sockets": {)";
    for (int i = 0; i < count; ++i) text += (i ? ", \"" : "\"") + std::to_string(i) + R"(": {"at": 0.5})";
    return text + "}}";
  };
  EXPECT_EQ(parseRig(withSockets(1024)).sockets.size(), 1024u);
  EXPECT_NE(errorOf(withSockets(1025)).find("/sockets: has 1025 sockets"), std::string::npos);
}

TEST(ParseRig, ClipsKeepTheirOrder) {
  const RigDescription rig = parseRig(R"({"kelp": 1, "clips": {
    "zoom": {"waves": [{"knot": 1, "offset": [1, 0, 0], "period": 1}]},
    "arc":  {"waves": [{"knot": 1, "offset": [1, 0, 0], "period": 1}]}}})");
  ASSERT_EQ(rig.clips.size(), 2u);
  EXPECT_EQ(rig.clips[0].name, "zoom");
}

TEST(ParseRig, EveryErrorNamesThePlaceAndTheRemedy) {
  struct Case {
    std::string text;
    std::vector<std::string> says;
  };
  const std::string wave = R"("knot": 1, "offset": [0, 0, 0.1], "period": 1)";
  const std::vector<Case> cases{
      {"", {"line 1, column 1", "not valid JSON"}},
      {"{\"kelp\": 1,\n \"axis\" \"x\"}", {"line 2, column 11", "not valid JSON"}},
      {"{\"kelp\": 1} x", {"line 1, column 13", "not valid JSON"}},
      {"{\"kelp\": \"\xff\"}", {"not valid JSON", "UTF-8"}},
      {"[1]", {"rig:", "must be an object", "array"}},
      {"{}", {"'kelp' is missing", "\"kelp\": 1"}},
      {R"({"kelp": 2})", {"/kelp", "version 1", "update kelp"}},
      {R"({"kelp": "1"})", {"/kelp", "version 1"}},
      {R"({"kelp": 1, "Clips": {}})", {"/Clips", "unknown key", "did you mean 'clips'?"}},
      {R"({"kelp": 1, "kelp": 1})", {"'kelp'", "twice"}},
      {R"({"kelp": 1, "a/b~c": 1})",
       {"/a~1b~0c",
        "known are 'kelp', 'axis', 'knots', 'clips', 'sockets', 'parent_at', 'bend', "
        "'cell', 'roll'"}},
      {R"({"kelp": 1, "axis": "up"})", {"/axis", "\"up\"", "\"+x\""}},
      {R"({"kelp": 1, "axis": 1})", {"/axis", "not 1"}},
      {R"({"kelp": 1, "knots": {}})", {"/knots", "must be an array"}},
      {R"({"kelp": 1, "knots": [{"at": 0}]})", {"/knots", "has 1 knot;", "2 to 64"}},
      {R"({"kelp": 1, "knots": [{"at": 0}, {}]})", {"/knots/1", "'at' is missing"}},
      {R"({"kelp": 1, "knots": [{"at": 0.1}, {"at": 1}]})", {"/knots/0/at", "first knot must be at 0"}},
      {R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.9}]})", {"/knots/1/at", "last knot must be at 1"}},
      {R"({"kelp": 1, "knots": [{"at": 0}, {"at": 0.5}, {"at": 0.5}, {"at": 1}]})",
       {"/knots/2/at", "ascend", "sort"}},
      {R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1.5}]})",
       {"/knots/1/at", "1.5 is out of range", "between 0 and 1"}},
      {R"({"kelp": 1, "knots": [{"at": 0, "ofset": [0,0,0]}, {"at": 1}]})",
       {"/knots/0/ofset", "did you mean 'offset'?"}},
      {R"({"kelp": 1, "knots": [{"at": 0, "offset": [0,0]}, {"at": 1}]})",
       {"/knots/0/offset", "3 numbers", "has 2"}},
      {R"({"kelp": 1, "knots": [{"at": 0, "offset": [0,0,"1"]}, {"at": 1}]})",
       {"/knots/0/offset/2", "must be a number", "string"}},
      {R"({"kelp": 1, "knots": [{"at": 0, "offset": [0,0,1e300]}, {"at": 1}]})",
       {"/knots/0/offset/2", "out of range"}},
      {R"({"kelp": 1e999})", {"too large"}},
      {R"({"kelp": 1, "sockets": []})", {"/sockets", "maps names to sockets", "array"}},
      {R"({"kelp": 1, "socket": {}})", {"/socket", "did you mean 'sockets'?"}},
      {R"({"kelp": 1, "sockets": {"hand": 0.5}})", {"/sockets/hand", "must be an object", "number"}},
      {R"({"kelp": 1, "sockets": {"": {"at": 0.5}}})", {"/sockets/", "socket's name has 1 to 255", "0"}},
      {R"({"kelp": 1, "sockets": {"a": {"at": 0}, "a": {"at": 1}}})", {"'a'", "twice"}},
      {"{\"kelp\": 1, \"sockets\": {\"a\xc2\x9b\": {\"at\": 0}}}", {"/sockets/", "control characters"}},
      {R"({"kelp": 1, "sockets": {"hand": {}}})", {"/sockets/hand", "'at' is missing", "0 to 1"}},
      {R"({"kelp": 1, "sockets": {"hand": {"at": 1.1}}})",
       {"/sockets/hand/at", "1.1 is out of range", "between 0 and 1"}},
      {R"({"kelp": 1, "sockets": {"hand": {"at": 1, "ofset": [0, 0, 0]}}})",
       {"/sockets/hand/ofset", "did you mean 'offset'?"}},
      {R"({"kelp": 1, "axis": "-x", "sockets": {"hand": {"at": 1, "offset": [0.5, 0.1, 0]}}})",
       {"/sockets/hand/offset", "-0.5 along the axis -x", "across the axis", "with \"at\""}},
      {R"({"kelp": 1, "sockets": {"hand": {"at": 1, "rotation": [0, 0, 0, 2]}}})",
       {"/sockets/hand/rotation", "unit quaternion", "length 2"}},
      {R"({"kelp": 1, "sockets": {"hand": {"at": 1, "rotation": [0, 0, 1]}}})",
       {"/sockets/hand/rotation", "must have 4 numbers, has 3"}},
      {R"({"kelp": 1, "parent_at": 1.5})", {"/parent_at", "1.5 is no place", "between 0 and 1"}},
      {R"({"kelp": 1, "parent_at": -0.5})", {"/parent_at", "-0.5 is no place"}},
      {R"({"kelp": 1, "parent_at": "0.5"})", {"/parent_at", "must be a number"}},
      {R"({"kelp": 1, "bend": "twist"})", {"/bend", "\"sweep\", \"shear\" or \"cage\", not \"twist\""}},
      {R"({"kelp": 1, "bend": 1})", {"/bend", "not 1"}},
      {R"({"kelp": 1, "bend": "sweep", "roll": 181})", {"/roll", "181"}},
      {R"({"kelp": 1, "bend": "sweep", "roll": "90"})", {"/roll", "must be a number"}},
      {R"({"kelp": 1, "bend": "shear", "roll": 90})", {"/roll", "only a swept part", "take \"roll\" out"}},
      {R"({"kelp": 1, "bend": "cage", "cell": 3})", {"/cell", "2, 4, 8 or 16, not 3"}},
      {R"({"kelp": 1, "bend": "cage", "cell": "8"})", {"/cell", "must be a number"}},
      {R"({"kelp": 1, "bend": "sweep", "cell": 8})", {"/cell", "only a cage", "take \"cell\" out"}},
      {R"({"kelp": 1, "cell": 8})", {"/cell", "write \"bend\": \"cage\""}},
      {R"({"kelp": 1, "roll": 0})", {"/roll", "write \"bend\": \"sweep\""}},
      {R"({"kelp": 1, "parents_at": 1})", {"/parents_at", "did you mean 'parent_at'?"}},
      {R"({"kelp": 1, "clips": []})", {"/clips", "maps names to clips"}},
      {R"({"kelp": 1, "clips": {"": {"waves": [{)" + wave + "}]}}}", {"/clips/", "name", "0"}},
      {"{\"kelp\": 1, \"clips\": {\"a\xc2\x9b\": {\"waves\": [{" + wave + "}]}}}",
       {"/clips/", "control characters"}},
      {R"({"kelp": 1, "clips": {"c": {}}})", {"/clips/c", "moves nothing"}},
      {R"({"kelp": 1, "clips": {"c": {"wave": []}}})", {"/clips/c/wave", "did you mean 'waves'?"}},
      {R"({"kelp": 1, "clips": {"c": {"duration": 0, "waves": [{)" + wave + "}]}}}",
       {"/clips/c/duration", "out of range"}},
      {R"({"kelp": 1, "clips": {"c": {"interpolation": "step", "waves": [{)" + wave + "}]}}}",
       {"/clips/c/interpolation", "none"}},
      {withWave(R"({"offset": [0,0,0], "period": 1})"), {"/clips/c/waves/0", "'knot' is missing"}},
      {withWave(R"({"knot": 2, "offset": [0,0,0], "period": 1})"),
       {"/clips/c/waves/0/knot", "no knot 2", "0 to 1"}},
      {withWave(R"({"knot": -1, "offset": [0,0,0], "period": 1})"), {"/clips/c/waves/0/knot", "no knot -1"}},
      {withWave(R"({"knot": 0.5, "offset": [0,0,0], "period": 1})"),
       {"/clips/c/waves/0/knot", "no knot 0.5"}},
      {withWave(R"({"knot": 1, "offset": [0,0,0]})"), {"/clips/c/waves/0", "'period' is missing"}},
      {withWave(R"({"knot": 1, "offset": [0,0,0], "perod": 1})"),
       {"/clips/c/waves/0/perod", "did you mean 'period'?"}},
      {withWave(R"({"knot": 1, "offset": [0,0,0], "period": 0})"),
       {"/clips/c/waves/0/period", "out of range"}},
      {withWave(R"({"knot": 1, "offset": [0,0,0], "period": -2})"),
       {"/clips/c/waves/0/period", "out of range"}},
      {withWave(R"({"knot": 1, "period": 1})"),
       {"/clips/c/waves/0", "exactly one of 'offset', 'tangent', 'width' or 'twist'"}},
      {withWave(R"({"knot": 1, "offset": [0,0,0], "tangent": [0,0,0], "period": 1})"),
       {"/clips/c/waves/0", "both 'offset' and 'tangent'"}},
      {withKeys(""), {"/clips/c", "moves nothing"}},
      {withKeys(R"({"knot": 1, "offset": [0,0,0]})"), {"/clips/c/keys/0", "'time' is missing"}},
      {withKeys(R"({"time": 0, "knot": 1})"), {"/clips/c/keys/0", "exactly one of", "'scale'"}},
      {withKeys(R"({"time": 0, "knot": 1, "offset": [0,0,0]})"), {"/clips/c", "no length", "duration"}},
      {withKeys(R"({"time": -1, "knot": 1, "offset": [0,0,0]})"), {"/clips/c/keys/0/time", "out of range"}},
      {withKeys(R"({"time": 1, "offset": [0,0,0]})"), {"/clips/c/keys/0", "'knot' is missing"}},
      {withKeys(R"({"time": 1, "knot": 0, "scale": [1,1,1]})"), {"/clips/c/keys/0/knot", "whole part"}},
      {withKeys(R"({"time": 1, "rotation": [0,0,0]})"), {"/clips/c/keys/0/rotation", "4 numbers"}},
      {withKeys(R"({"time": 1, "rotation": [0,0,0,0.5]})"),
       {"/clips/c/keys/0/rotation", "unit quaternion", "0.5"}},
      {withKeys(R"({"time": 1, "knot": 1, "offset": [0,0,0]}, {"time": 1, "knot": 1, "offset": [0,0,1]})"),
       {"/clips/c/keys/1/time", "ascend"}},
      {withKeys(R"({"time": 1, "knot": 1, "offset": [0,0,0], "interpolation": "cubi"})"),
       {"/clips/c/keys/0/interpolation", "did you mean 'cubic'?"}},
      {withKeys(R"({"time": 1, "knot": 1, "offset": [0,0,0], "interpolation": 2})"),
       {"/clips/c/keys/0/interpolation", "must be"}},
      {withKeys(
           R"({"time": 1, "knot": 1, "offset": [0,0,0], "interpolation": "step"}, {"time": 2, "knot": 1, "offset": [0,0,0], "interpolation": "cubic"})"),
       {"/clips/c/keys/1/interpolation", "'step'", "share"}},
      {withKeys(R"({"time": 1, "knot": 1, "offset": [0,0,0], "in": [0,0,0]})"),
       {"/clips/c/keys/0/in", "cubic"}},
      {R"({"kelp": 1, "clips": {"c": {"duration": 1, "keys": [{"time": 2, "knot": 1, "offset": [0,0,0]}]}}})",
       {"/clips/c/duration", "last key at 2"}},
  };
  for (const Case& c : cases) {
    const std::string error = errorOf(c.text);
    EXPECT_FALSE(error.empty()) << "was accepted: " << c.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(error.find("json.exception"), std::string::npos) << error;
    EXPECT_LT(error.size(), 400u) << error;
    for (const std::string& words : c.says)
      EXPECT_NE(error.find(words), std::string::npos) << "'" << words << "' is not in: " << error;
  }
}

TEST(ParseRig, HostileTextIsBounded) {
  EXPECT_NE(errorOf(std::string(1 << 20, '[')).find("nested"), std::string::npos);
  EXPECT_NE(errorOf(std::string((16 << 20) + 1, ' ')).find("16 MiB"), std::string::npos);
  std::string many = R"({"kelp": 1)";
  for (int i = 0; i < 100000; ++i) many += ",\"k" + std::to_string(i) + "\":1";
  EXPECT_NE(errorOf(many + "}").find("4096 keys"), std::string::npos);
  // A name full of line breaks, or of ten thousand letters, still makes one short line.
  const std::string error = errorOf("{\"kelp\": 1, \"" + std::string(10000, 'a') + "\\n\": 1}");
  EXPECT_LT(error.size(), 200u);
  EXPECT_EQ(errorOf("{\"kelp\": 1, \"a\\nb\": 1}").find('\n'), std::string::npos);
}

TEST(ParseRig, EveryPrefixAndEveryFlippedByteIsAnswered) {
  const std::string text =
      R"({"kelp": 1, "axis": "-x", "bend": "sweep", "roll": 9, "parent_at": 0.5, "sockets": {"h": {"at": 1, "offset": [0, 1, 2]}}, "knots": [{"at": 0}, {"at": 0.5, "tangent": [1, 0, 2]}, {"at": 1}], "clips": {"a": {"keys": [
    {"time": 0, "knot": 1, "offset": [0, 0.1, 0]}, {"time": 1.5, "rotation": [0, 0, 0, 1]}], "waves": [{"knot": 2, "offset": [1, 2, 3], "period": 2}]}}})";
  ASSERT_EQ(errorOf(text), "");
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_NE(errorOf(text.substr(0, i)), "") << i;
    std::string flipped = text;
    for (int bit = 0; bit < 8; ++bit) {
      flipped[i] = static_cast<char>(text[i] ^ (1 << bit));
      EXPECT_EQ(errorOf(flipped).find('\n'), std::string::npos);
    }
  }
}

RigDescription randomRig(std::mt19937& random) {
  const auto uniform = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const auto vec = [&] {
    return glm::vec3(uniform(-1, 1), uniform(-1e-4f, 1e-4f), below(3) ? uniform(-2, 2) : 0.0f);
  };
  RigDescription rig;
  if (below(2)) rig.axis = static_cast<Axis>(below(6));
  const int knots = below(2) ? 2 + below(5) : 2;
  if (knots > 2) {
    for (int i = 0; i < knots; ++i) {
      RigDescription::Knot knot;
      knot.at = i == 0 ? 0.0f
                : i + 1 == knots
                    ? 1.0f
                    : (static_cast<float>(i) + uniform(-0.4f, 0.4f)) / static_cast<float>(knots - 1);
      if (below(2)) knot.offset = vec();
      if (below(2)) knot.tangent = vec();
      rig.knots.push_back(knot);
    }
  }
  for (int c = below(3); c > 0; --c) {
    RigDescription::Clip clip;
    clip.name = "clip \"" + std::to_string(c) + "\\ \xc3\xa9";
    if (below(2)) clip.duration = uniform(10, 20);
    for (int w = 1 + below(3); w > 0; --w)
      clip.waves.push_back({below(knots), below(2) ? Target::kKnotOffset : Target::kKnotTangent, vec(),
                            uniform(0.1f, 9), below(2) ? uniform(-1, 1) : 0});
    for (int t = 0; t < 5; ++t) {
      if (below(2)) continue;
      RigDescription::Track track{0, static_cast<Target>(t), static_cast<Interpolation>(below(3)), {}};
      if (t < 2) track.knot = below(knots);
      float time = uniform(0, 1);
      for (int k = 1 + below(4); k > 0; --k, time += uniform(0.01f, 2)) {
        RigDescription::Key key{time, glm::vec4(vec(), 0), std::nullopt, std::nullopt};
        if (t == 3) key.value = glm::normalize(glm::vec4(vec(), 0.5f));
        if (track.interpolation == Interpolation::kCubic && below(2))
          key.in = glm::vec4(vec(), t == 3 ? 0.25f : 0.0f);
        if (track.interpolation == Interpolation::kCubic && below(2)) key.out = glm::vec4(vec(), 0);
        track.keys.push_back(key);
      }
      clip.tracks.push_back(track);
    }
    rig.clips.push_back(clip);
  }
  for (int s = below(4); s > 0; --s) {
    RigDescription::Socket socket;
    socket.name = "socket \"" + std::to_string(s) + "\\ \xc3\xa9";
    socket.at = below(3) ? uniform(0, 1) : 1.0f;
    if (below(2)) socket.offset = {uniform(-2, 2), uniform(-1e-4f, 1e-4f), uniform(-2, 2)};
    if (rig.axis && below(2)) socket.offset = vec();
    if (rig.axis) socket.offset[static_cast<int>(*rig.axis) / 2] = 0;
    if (below(2)) socket.rotation = glm::normalize(glm::quat(uniform(-1, 1), uniform(-1, 1), 0.5f, 0));
    rig.sockets.push_back(socket);
  }
  if (below(2)) rig.parent_at = below(3) ? uniform(0, 1) : 0.0f;
  if (below(3)) rig.bend = below(2) ? Bend::kSweep : Bend::kShear;
  rig.caged = rig.bend == Bend::kSweep && below(2);
  if (rig.caged) rig.cell = below(2) ? 2 << below(4) : 0;
  if (rig.bend == Bend::kSweep) rig.roll = below(4) ? uniform(-3.14159265f, 3.14159265f) : 3.14159274f;
  return rig;
}

TEST(PrintRig, IsTheInverseOfParseRig) {
  std::mt19937 random(7);
  for (int i = 0; i < 500; ++i) {
    const RigDescription rig = randomRig(random);
    const std::string text = printRig(rig);
    RigDescription back;
    ASSERT_NO_THROW(back = parseRig(text)) << text;
    EXPECT_EQ(back, rig) << text;
  }
}

TEST(PrintRig, ReadsLikeAHandWroteIt) {
  const std::string text = printRig(parseRig(
      R"({"kelp":1,"roll":22.5,"bend":"sweep","parent_at":0.25,"sockets":{"hand":{"at":0.9,"offset":[0.1,0,0.05]},"tip":{"rotation":[0,0.6,0,0.8],"at":1}},"knots":[{"at":0},{"at":1,"tangent":[3,0,2]}],"clips":{"sway":{"waves":[{"knot":1,"offset":[0.15,0,0.04],"period":3.2}]}}})"));
  EXPECT_EQ(text, R"({
  "kelp": 1,
  "knots": [
    {"at": 0},
    {"at": 1, "tangent": [3, 0, 2]}],
  "clips": {
    "sway": {
      "waves": [
        {"knot": 1, "offset": [0.15, 0, 0.04], "period": 3.2}]}},
  "sockets": {
    "hand": {"at": 0.9, "offset": [0.1, 0, 0.05]},
    "tip": {"at": 1, "rotation": [0, 0.6, 0, 0.8]}},
  "parent_at": 0.25,
  "bend": "sweep",
  "roll": 22.5}
)");
}

}  // namespace
}  // namespace kelp
