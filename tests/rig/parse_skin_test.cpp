// SPDX-License-Identifier: MIT
// Rigs that divide a skin: what is read, what is refused and with which words, and that printing is the
// inverse of reading.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

using Group = RigDescription::SkinGroup;

std::string refusalOf(const std::string& text) {
  try {
    parseRig(text);
  } catch (const RigError& error) {
    return error.what();
  }
  return "";
}

std::string skinOf(const std::string& parts) { return R"({"kelp": 1, "skin": {"parts": [)" + parts + "]}}"; }

TEST(ParseSkin, GroupsKeepTheirOrder) {
  const RigDescription rig = parseRig(skinOf(
      R"({"joints": ["Tail 1", "Tail 2"], "knots": 5}, {"joints": ["Hip"], "pieces": 3}, {"joints": ["Arm", "Hand"]})"));
  ASSERT_EQ(rig.skin.size(), 3u);
  EXPECT_EQ(rig.skin[0], (Group{{"Tail 1", "Tail 2"}, 5, 1}));
  EXPECT_EQ(rig.skin[1], (Group{{"Hip"}, 0, 3}));
  EXPECT_EQ(rig.skin[2], (Group{{"Arm", "Hand"}, 0, 1}));
  EXPECT_TRUE(rig.knots.empty());
  EXPECT_EQ(printRig(rig), R"({
  "kelp": 1,
  "skin": {"parts": [
    {"joints": ["Tail 1", "Tail 2"], "knots": 5},
    {"joints": ["Hip"], "pieces": 3},
    {"joints": ["Arm", "Hand"]}]}}
)");
}

TEST(ParseSkin, EveryErrorNamesThePlaceAndTheRemedy) {
  struct Case {
    std::string text;
    std::vector<std::string> says;
  };
  const std::string good = R"({"joints": ["a"]})";
  std::string many = good;
  for (int i = 0; i < 4; ++i) many += R"(, {"joints": ["a)" + std::to_string(i) + R"("], "pieces": 256})";
  const std::vector<Case> cases{
      {R"({"kelp": 1, "skin": []})", {"/skin: ", "must be an object"}},
      {R"({"kelp": 1, "skin": {}})", {"/skin: ", "'parts' is missing", "joints"}},
      {R"({"kelp": 1, "skin": {"part": []}})", {"/skin/part: unknown key", "'parts'"}},
      {R"({"kelp": 1, "skin": {"parts": {}}})", {"/skin/parts: ", "must be an array"}},
      {skinOf(""), {"/skin/parts: ", "no part"}},
      {skinOf("3"), {"/skin/parts/0: ", "must be an object"}},
      {skinOf("{}"), {"/skin/parts/0: ", "'joints' is missing"}},
      {skinOf(R"({"joints": "a"})"), {"/skin/parts/0/joints: ", "must be an array"}},
      {skinOf(R"({"joints": []})"), {"/skin/parts/0/joints: ", "no joint"}},
      {skinOf(R"({"joints": [1]})"), {"/skin/parts/0/joints/0: ", "name of a joint"}},
      {skinOf(R"({"joints": [""]})"), {"/skin/parts/0/joints/0: ", "1 to 255 bytes"}},
      {skinOf(R"({"joints": ["a\n"]})"), {"/skin/parts/0/joints/0: ", "control characters"}},
      {skinOf(R"({"joint": ["a"]})"), {"/skin/parts/0/joint: unknown key", "'joints'"}},
      {skinOf(R"({"joints": ["a", "a"]})"), {"/skin/parts/0/joints/1: ", "'a' is named twice"}},
      {skinOf(good + ", " + good), {"/skin/parts/1/joints/0: ", "'a' is named twice", "one entry"}},
      {skinOf(R"({"joints": ["a"], "pieces": 0})"), {"/skin/parts/0/pieces: 0 is out of range", "1"}},
      {skinOf(R"({"joints": ["a"], "pieces": 257})"), {"/skin/parts/0/pieces: 257", "256"}},
      {skinOf(R"({"joints": ["a"], "pieces": 1.5})"), {"/skin/parts/0/pieces: 1.5 is no whole number"}},
      {skinOf(R"({"joints": ["a"], "pieces": "2"})"), {"/skin/parts/0/pieces: must be a number"}},
      {skinOf(R"({"joints": ["a", "b"], "knots": 2})"), {"/skin/parts/0/knots: 2", "3 and 24"}},
      {skinOf(R"({"joints": ["a", "b"], "knots": 25})"), {"/skin/parts/0/knots: 25", "3 and 24"}},
      {skinOf(R"({"joints": ["a", "b"], "knots": [{"at": 0}]})"), {"/skin/parts/0/knots: must be a number"}},
      {skinOf(R"({"joints": ["a"], "knots": 5})"), {"/skin/parts/0/knots: ", "at least two joints"}},
      {skinOf(R"({"joints": ["a", "b"], "knots": 5, "pieces": 1})"), {"/skin/parts/0/pieces: ", "one piece"}},
      {skinOf(many), {"/skin/parts: ", "more than 1024 parts"}},
      {R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1}], "skin": {"parts": [{"joints": ["a"]}]}})",
       {"/knots: ", "a rig with \"skin\" has no 'knots'"}},
      {R"({"kelp": 1, "skin": {"parts": [{"joints": ["a"]}]}, "bend": "sweep"})",
       {"/bend: ", "a rig with \"skin\" has no 'bend'"}},
      {R"({"kelp": 1, "skin": {"parts": [{"joints": ["a"]}]}, "clip": {}})", {"/clip: unknown key"}},
  };
  for (const Case& c : cases)
    for (const std::string& words : c.says)
      EXPECT_NE(refusalOf(c.text).find(words), std::string::npos)
          << c.text << "\n  says: " << refusalOf(c.text) << "\n  not: " << words;
}

TEST(ParseSkin, PrintingIsTheInverse) {
  std::mt19937 random(11);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 200; ++i) {
    RigDescription rig;
    int joint = 0;
    for (int groups = 1 + below(5); groups > 0; --groups) {
      Group& group = rig.skin.emplace_back();
      for (int joints = 1 + below(4); joints > 0; --joints)
        group.joints.push_back(std::string(below(3) ? "j\"\\\xc3\xa4 " : "~/") + std::to_string(joint++));
      if (group.joints.size() > 1 && below(2))
        group.knots = kMinSkinKnots + below(kMaxSkinKnots - kMinSkinKnots + 1);
      else if (below(2))
        group.pieces = 1 + below(9);
    }
    RigDescription back;
    ASSERT_NO_THROW(back = parseRig(printRig(rig))) << printRig(rig);
    EXPECT_EQ(back, rig) << printRig(rig);
  }
}

}  // namespace
}  // namespace kelp
