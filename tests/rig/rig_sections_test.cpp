// SPDX-License-Identifier: MIT
// Widths and twists in the rig language: what is read and printed, what is refused, and the part they make.
#include <gtest/gtest.h>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

std::string refusalOf(const std::string& text) {
  try {
    parseRig(text);
    return "";
  } catch (const RigError& error) {
    return error.what();
  }
}

const std::string kTower = R"({
  "kelp": 1,
  "axis": "+z",
  "knots": [
    {"at": 0, "width": 1.25, "twist": -30},
    {"at": 0.4, "width": [0.7, 1.5], "keep_volume": true},
    {"at": 1, "offset": [0.1, 0, 0], "twist": 90, "keep_volume": 0.25}],
  "clips": {
    "turn": {
      "duration": 2,
      "waves": [
        {"knot": 1, "offset": [0, 0.1, 0], "period": 2},
        {"knot": 1, "width": [0.1, 0.2], "period": 2},
        {"knot": 2, "twist": 45, "period": 1, "phase": 0.25}],
      "keys": [
        {"time": 0, "knot": 0, "width": 1},
        {"time": 2, "knot": 0, "width": [1.1, 0.8]},
        {"time": 1, "knot": 2, "twist": 10, "interpolation": "cubic", "in": 5, "out": -5}]}},
  "bend": "cage"}
)";

TEST(ParseSections, PrintingIsTheInverseOfReading) {
  const RigDescription rig = parseRig(kTower);
  EXPECT_EQ(rig.knots[0].section.width, glm::vec2(1.25f));
  EXPECT_EQ(rig.knots[1].section.width, glm::vec2(0.7f, 1.5f));
  EXPECT_FLOAT_EQ(rig.knots[2].section.twist, glm::radians(90.0f));
  EXPECT_EQ(rig.knots[2].section.keep_volume, 0.25f);
  EXPECT_EQ(printRig(rig), kTower);
  EXPECT_TRUE(hasSections(rig));
  EXPECT_FALSE(
      hasSections(parseRig(R"({"kelp": 1, "knots": [{"at": 0, "width": 1}, {"at": 1, "twist": 0}]})")));
}

// The empty part has the widths as its knots' offsets, along the part's own axes, and the twists as tangents.
TEST(ParseSections, BecomeAPartAndComeBack) {
  for (const char* const axis : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    std::string text = kTower;
    text.replace(text.find("+z"), 2, axis);
    const RigDescription rig = parseRig(text);
    const RigDescription sections = sectionRig(rig);
    const std::vector<Knot> knots = realizeKnots(sections);
    ASSERT_EQ(knots.size(), 3u);
    EXPECT_EQ(automaticTangents(sections), 0u);
    EXPECT_EQ(knots[1].at, 0.4f);
    // The artist's first axis across, as a part has it.
    const int along = axis[1] - 'x';
    glm::vec3 first(0);
    first[along == 0 ? 1 : 0] = 1;
    const glm::vec3 in_part = glm::abs(axisRotation(*rig.axis) * first);
    const glm::vec2 width(0.7f, 1.5f);
    EXPECT_NEAR(1 + knots[1].position.x, in_part.x != 0 ? width.x : width.y, 1e-6f) << axis;
    EXPECT_NEAR(1 + knots[1].position.z, in_part.x != 0 ? width.y : width.x, 1e-6f) << axis;
    EXPECT_NEAR(knots[0].tangent.x, glm::radians(-30.0f), 1e-6f);
    EXPECT_EQ(knots[1].tangent, glm::vec3(0, 1, 1));
    const std::vector<RawClip> clips = realizeClips(sections, 7);
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_EQ(clips[0].duration, 2);
    ASSERT_EQ(clips[0].waves.size(), 2u);
    EXPECT_EQ(clips[0].waves[0].target, Target::kKnotOffset);
    EXPECT_EQ(clips[0].waves[1].target, Target::kKnotTangent);
    EXPECT_NEAR(clips[0].waves[1].amplitude.x, glm::radians(45.0f), 1e-6f);
    ASSERT_EQ(clips[0].tracks.size(), 2u);
    EXPECT_EQ(clips[0].tracks[0].keys[0].value, glm::vec4(0));
    // The part itself has the rest.
    ASSERT_EQ(realizeClips(rig, 0).at(0).waves.size(), 1u);
    EXPECT_TRUE(realizeClips(rig, 0)[0].tracks.empty());

    RigDescription back = rig;
    for (RigDescription::Knot& knot : back.knots) knot.section = {};
    std::erase_if(back.clips[0].waves, [](const auto& wave) { return wave.of_section; });
    std::erase_if(back.clips[0].tracks, [](const auto& track) { return track.of_section; });
    addSections(sections, back);
    EXPECT_EQ(printRig(back), printRig(rig));
  }
}

TEST(ParseSections, ErrorsNameThePlaceAndTheRemedy) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"kelp": 1, "knots": [{"at": 0, "width": 0}, {"at": 1}]})", "/knots/0/width"},
      {R"({"kelp": 1, "knots": [{"at": 0}, {"at": 1, "width": [1, "a"]}]})", "/knots/1/width/1"},
      {R"({"kelp": 1, "knots": [{"at": 0, "width": [1]}, {"at": 1}]})", "one for each axis across"},
      {R"({"kelp": 1, "knots": [{"at": 0, "twist": true}, {"at": 1}]})", "/knots/0/twist"},
      {R"({"kelp": 1, "knots": [{"at": 0, "keep_volume": -1}, {"at": 1}]})", "/knots/0/keep_volume"},
      {R"({"kelp": 1, "clips": {"a": {"waves": [{"knot": 0, "period": 1}]}}})", "'width' or 'twist'"},
      {R"({"kelp": 1, "clips": {"a": {"waves": [{"knot": 0, "offset": [1, 0, 0], "twist": 1, "period": 1}]}}})",
       "both 'offset' and 'twist'"},
      {R"({"kelp": 1, "clips": {"a": {"keys": [{"time": 1, "twist": 1}]}}})", "which knot"},
      {R"({"kelp": 1, "knots": [{"at": 0, "width": 2}, {"at": 1}], "sides": {"-x-z": {}}})",
       "exclude each other"},
      {R"({"kelp": 1, "sides": {"-x-z": {"knots": [{"at": 0, "twist": 2}, {"at": 1}]}}})", "no sections"},
  };
  for (const auto& [text, words] : cases)
    EXPECT_NE(refusalOf(text).find(words), std::string::npos) << text << ": " << refusalOf(text);
}

}  // namespace
}  // namespace kelp
