// SPDX-License-Identifier: MIT
// Sides in the rig language: what is read and printed, what is refused and with which words, which parts they
// make, and where they cross.
#include <gtest/gtest.h>

#include "kelp/rig/rig_file.h"

namespace kelp {
namespace {

const std::string kSlab = R"({
  "kelp": 1,
  "axis": "+x",
  "bend": "cage",
  "cell": 4,
  "sides": {
    "+y-z": {
      "knots": [
        {"at": 0},
        {"at": 0.5, "offset": [0, 0.1, 0]},
        {"at": 1}],
      "clips": {
        "go": {
          "waves": [
            {"knot": 2, "offset": [0, 0.1, 0], "period": 2}],
          "keys": [
            {"time": 1, "knot": 1, "tangent": [0, 1, 0]}]}}},
    "-y-z": {}}}
)";

TEST(ParseSides, PrintingIsTheInverseOfReading) {
  const RigDescription rig = parseRig(kSlab);
  ASSERT_EQ(rig.sides.size(), 2u);
  EXPECT_EQ(rig.sides[0].corner, "+y-z");
  EXPECT_EQ(rig.sides[0].knots.size(), 3u);
  EXPECT_EQ(rig.sides[0].clips.at(0).waves.at(0).knot, 2);
  EXPECT_TRUE(rig.sides[1].knots.empty() && rig.sides[1].clips.empty());
  EXPECT_TRUE(rig.caged && rig.bend == Bend::kShear && rig.cell == 4);
  EXPECT_EQ(printRig(rig), kSlab);
  const RigFile file = parseRigFile(R"({"kelp": 1, "parts": {"a": {"sides": {"+x+z": {}}}, "b": {}}})");
  EXPECT_EQ(parseRigFile(printRigFile(file)), file);
  EXPECT_EQ(parseRig(R"({"kelp": 1, "sides": {"+x+z": {}}})"),
            parseRig(R"({"kelp": 1, "bend": "cage", "sides": {"+x+z": {}}})"));
}

TEST(ParseSides, ErrorsNameThePlaceAndTheRemedy) {
  const auto withSide = [](const std::string& side) {
    return R"({"kelp": 1, "sides": {"+x-z": )" + side + "}}";
  };
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {R"({"kelp": 1, "sides": []})", {"/sides", "must be an object"}},
      {R"({"kelp": 1, "sides": {}})", {"/sides", "names no corner", "take \"sides\" out"}},
      {R"({"kelp": 1, "sides": {"+x": {}}})", {"/sides/+x", "unknown key"}},
      {R"({"kelp": 1, "sides": {"x-z": {}}})", {"/sides/x-z", "did you mean"}},
      {R"({"kelp": 1, "sides": {"+x-z": {}, "+x-z": {}}})", {"'+x-z'", "twice"}},
      {R"({"kelp": 1, "bend": "shear", "sides": {"+x-z": {}}})", {"/bend", "by its cage", "write \"cage\""}},
      {R"({"kelp": 1, "bend": "sweep", "sides": {"+x-z": {}}})", {"/bend", "by its cage"}},
      {R"({"kelp": 1, "roll": 3, "sides": {"+x-z": {}}})", {"/roll", "take \"roll\" out"}},
      {R"({"kelp": 1, "cell": 5, "sides": {"+x-z": {}}})", {"/cell", "2, 4, 8 or 16"}},
      {R"({"kelp": 1, "sides": {"+x-z": {}}, "parts": {"a": {}}})", {"/sides", "beside \"parts\""}},
      {withSide("3"), {"/sides/+x-z", "must be an object"}},
      {withSide(R"({"knot": []})"), {"/sides/+x-z/knot", "did you mean 'knots'?"}},
      {withSide(R"({"axis": "+y"})"), {"/sides/+x-z/axis", "\"knots\" and \"clips\" alone", "own rig"}},
      {withSide(R"({"bend": "sweep"})"), {"/sides/+x-z/bend", "alone"}},
      {withSide(R"({"sockets": {}})"), {"/sides/+x-z/sockets", "alone"}},
      {withSide(R"({"sides": {"+x-z": {}}})"), {"/sides/+x-z/sides", "alone"}},
      {withSide(R"({"knots": [{"at": 0}]})"), {"/sides/+x-z/knots", "1 knot"}},
      {withSide(R"({"clips": {"c": {"keys": [{"time": 1, "translation": [1, 0, 0]}]}}})"),
       {"/sides/+x-z/clips/c/keys", "knots alone", "'translation'", "own rig"}},
      {withSide(R"({"clips": {"c": {"waves": [{"knot": 2, "offset": [1, 0, 0], "period": 1}]}}})"),
       {"/sides/+x-z/clips/c/waves/0/knot", "no knot 2"}},
  };
  for (const auto& [text, says] : cases) {
    std::string error;
    try {
      parseRigFile(text);
    } catch (const RigError& thrown) {
      error = thrown.what();
    }
    EXPECT_FALSE(error.empty()) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    for (const std::string& words : says)
      EXPECT_NE(error.find(words), std::string::npos) << "'" << words << "' is not in: " << error;
  }
  EXPECT_NO_THROW(parseRig(R"({"kelp": 1, "cell": 8, "sides": {"+x-z": {}}})"));
}

TEST(ParseSides, CornersFollowTheirPartsAndOthersTheLast) {
  const SideRigs four =
      sideRigs(parseRig(R"({"kelp": 1, "axis": "-z", "knots": [{"at": 0}, {"at": 0.5}, {"at": 1}],
    "clips": {"a": {"keys": [{"time": 1, "translation": [1, 0, 0]}]},
              "b": {"keys": [{"time": 1, "scale": [1, 1, 2]}, {"time": 1, "knot": 2, "offset": [1, 0, 0]}]}},
    "sides": {"+x+y": {}, "-x-y": {}}})"));
  ASSERT_EQ(four.parts.size(), 3u);
  EXPECT_EQ(four.parts[2].first, kOwnSide);
  EXPECT_EQ(four.parts[2].second.knots.size(), 3u);
  ASSERT_EQ(four.parts[2].second.clips.size(), 1u) << "the part itself moves as a whole";
  EXPECT_EQ(four.parts[2].second.clips[0].tracks.size(), 1u);
  for (int corner = 0; corner < 4; ++corner) {
    const std::string name = cornerName(corner, Axis::kMinusZ);
    EXPECT_EQ(four.parts[static_cast<std::size_t>(four.followed[corner])].first,
              name == "+x+y" || name == "-x-y" ? name : kOwnSide);
  }
  EXPECT_THROW(sideRigs(parseRig(R"({"kelp": 1, "sides": {"+x+y": {}}})")), RigError);
}

TEST(ParseSides, SidesCrossWhereASectionIsTurnedAround) {
  RawRig straight;
  straight.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
  const std::array<std::uint32_t, 4> parts{1, 2, 3, 4};
  const glm::ivec3 size(20, 100, 10);
  const auto crossing = [&](float x, float swing) {
    std::array<RawRig, 4> rests{straight, straight, straight, straight};
    for (Knot& knot : rests[1].knots) knot.position.x += x;
    const RawClip clip{"go", 2, {{2, 0, Target::kKnotOffset, {swing, 0, 0}, 8, 0}}, {}};
    return sidesCross(parts, rests, swing == 0 ? nullptr : &clip, size);
  };
  EXPECT_EQ(crossing(-0.19f, 0), "");
  EXPECT_EQ(crossing(-0.2f, 0), "") << "they meet";
  EXPECT_EQ(crossing(-0.21f, 0), "at rest, at 0 of its height");
  EXPECT_EQ(crossing(0, 0.19f), "");
  // At three quarters of a period that is longer than the clip says.
  EXPECT_EQ(crossing(0, 0.2001f), "in clip 'go' at 6 s, at 0 of its height");
}

}  // namespace
}  // namespace kelp
