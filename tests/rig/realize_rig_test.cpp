// SPDX-License-Identifier: MIT
// From the artist's axes to the part's, against numbers worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kelp/rig/rig.h"
#include "support/spline_truth.h"

namespace kelp {
namespace {

constexpr std::array<Axis, 6> kAxes{Axis::kPlusX,  Axis::kMinusX, Axis::kPlusY,
                                    Axis::kMinusY, Axis::kPlusZ,  Axis::kMinusZ};

glm::vec3 direction(Axis axis) {
  switch (axis) {
    case Axis::kPlusX:
      return {1, 0, 0};
    case Axis::kMinusX:
      return {-1, 0, 0};
    case Axis::kPlusY:
      return {0, 1, 0};
    case Axis::kMinusY:
      return {0, -1, 0};
    case Axis::kPlusZ:
      return {0, 0, 1};
    case Axis::kMinusZ:
      return {0, 0, -1};
  }
  return {};
}

TEST(Axis, RotationsAreProperAndTurnTheAxisUp) {
  for (const Axis axis : kAxes) {
    const glm::mat3 r = axisRotation(axis);
    EXPECT_EQ(r * direction(axis), glm::vec3(0, 1, 0)) << toString(axis);
    EXPECT_EQ(glm::determinant(r), 1.0f) << toString(axis);
    EXPECT_EQ(glm::transpose(r) * r, glm::mat3(1)) << toString(axis);
    EXPECT_EQ(parseAxis(toString(axis)), axis);
  }
  EXPECT_EQ(axisRotation(Axis::kPlusY), glm::mat3(1));
  EXPECT_EQ(parseAxis("z"), Axis::kPlusZ);
  for (const char* bad : {"", "+", "w", "+xy", "X", "--x"}) EXPECT_FALSE(parseAxis(bad)) << bad;
}

TEST(RealizeKnots, TheStraightRigIsStraightToTheLastBit) {
  for (const Axis axis : kAxes) {
    RigDescription rig;
    rig.axis = axis;
    for (const float at : {0.0f, 0.1f, 1.0f / 3, 0.7f, 1.0f})
      rig.knots.push_back({at, glm::vec3(0), std::nullopt});
    for (const Knot& knot : realizeKnots(rig)) {
      EXPECT_EQ(knot.position, glm::vec3(0, knot.at, 0));
      EXPECT_EQ(knot.tangent, glm::vec3(0, 1, 0));
    }
  }
  const auto two = realizeKnots({});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].at, 1.0f);
  EXPECT_EQ(two[1].position, glm::vec3(0, 1, 0));
}

TEST(RealizeKnots, PoseOfThePaper) {
  // Tangents (3,0,1) and (3,0,2), as the paper writes them: no y part.
  const auto rig =
      parseRig(R"({"kelp": 1, "knots": [{"at": 0, "tangent": [3, 0, 1]}, {"at": 1, "tangent": [3, 0, 2]}]})");
  const auto knots = realizeKnots(rig);
  EXPECT_EQ(knots[0].tangent, glm::vec3(3, 0, 1));
  EXPECT_EQ(knots[1].tangent, glm::vec3(3, 0, 2));
  EXPECT_TRUE(checkKnots(knots));
}

TEST(RealizeKnots, OffsetsAndAutomaticTangentsByHand) {
  // Axis -x, so that artist (dx, dy, dz) is part (dy, -dx, dz). Slopes: ends one-sided, the middle between
  // its neighbors.
  const auto rig = parseRig(
      R"({"kelp": 1, "axis": "-x", "knots": [{"at": 0}, {"at": 0.25, "offset": [-0.05, 0.1, 0.2]}, {"at": 1, "offset": [0, 0, 0.4]}]})");
  const auto knots = realizeKnots(rig);
  const auto expectNear = [](const glm::vec3& a, const glm::vec3& b) {
    EXPECT_LT(glm::length(a - b), 1e-6f) << a.x << " " << a.y << " " << a.z;
  };
  expectNear(knots[1].position, {0.1f, 0.25f + 0.05f, 0.2f});
  expectNear(knots[2].position, {0, 1, 0.4f});
  expectNear(knots[0].tangent, {0.1f / 0.25f, 0.3f / 0.25f, 0.2f / 0.25f});
  expectNear(knots[1].tangent, {0, 1, 0.4f});
  expectNear(knots[2].tangent, {-0.1f / 0.75f, 0.7f / 0.75f, 0.2f / 0.75f});
  EXPECT_EQ(automaticTangents(rig), 7u);
}

// The spline of a column whose knots lie on a slanted line is that line.
TEST(RealizeKnots, OffsetsAloneLeanAColumnStraight) {
  for (const Axis axis : kAxes) {
    const glm::mat3 to_artist = glm::transpose(axisRotation(axis));
    for (int degrees = 10; degrees <= 70; degrees += 10) {
      const glm::vec3 lean = std::tan(glm::radians(static_cast<float>(degrees))) * glm::vec3(0.6f, 0, 0.8f);
      RigDescription rig;
      rig.axis = axis;
      for (const float at : {0.0f, 0.5f, 1.0f}) rig.knots.push_back({at, to_artist * (at * lean), {}});
      EXPECT_EQ(automaticTangents(rig), 7u);
      const std::vector<Knot> knots = realizeKnots(rig);
      double worst = 0;
      for (std::size_t k = 0; k < 2; ++k) {
        const test::SplineTruth segment(knots[k], knots[k + 1]);
        for (double t = 0; t <= 1; t += 1.0 / 64)
          for (const int i : {0, 2})
            worst = std::max(worst, std::abs(segment.value(i, t) - double{lean[i]} * segment.value(1, t)));
      }
      EXPECT_LT(worst, 0.01 / 128) << toString(axis) << ' ' << degrees;  // half a voxel is what it needs
    }
  }
}

TEST(RealizeKnots, ATangentThatIsGivenIsNotAutomatic) {
  const auto rig = parseRig(
      R"({"kelp": 1, "knots": [{"at": 0, "tangent": [0, 1, 0]}, {"at": 0.3}, {"at": 0.6, "tangent": [0.1, 1, 0]}, {"at": 1}]})");
  EXPECT_EQ(automaticTangents(rig), 0b1010u);
  EXPECT_EQ(automaticTangents({}), 0b11u) << "of the default rig all are";
  EXPECT_EQ(realizeKnots(rig)[2].tangent, glm::vec3(0.1f, 1, 0));
}

TEST(RealizeClips, WavesAndKeysByHand) {
  const auto rig = parseRig(R"({"kelp": 1, "axis": "+z", "clips": {
    "a": {"waves": [{"knot": 1, "tangent": [0.5, 0.25, 0.125], "period": 3, "phase": 0.1}, {"knot": 0, "offset": [1, 0, 0], "period": 5}]},
    "b": {"interpolation": "cubic", "keys": [
      {"time": 0, "knot": 1, "offset": [0, 0, 0]}, {"time": 1, "knot": 1, "offset": [0.5, 0, 0]}, {"time": 3, "knot": 1, "offset": [0.3, 0, 0], "in": [0, 0, 1]},
      {"time": 0, "translation": [1, 2, 3], "interpolation": "linear"}, {"time": 2, "translation": [4, 5, 6]}]}}})");
  const auto clips = realizeClips(rig, 7);
  ASSERT_EQ(clips.size(), 2u);
  EXPECT_EQ(clips[0].duration, 5.0f);  // the longest period
  EXPECT_EQ(clips[0].waves[0].part, 7u);
  EXPECT_EQ(clips[0].waves[0].knot, 1u);
  // +z: artist (x, y, z) is part (x, z, -y)
  EXPECT_EQ(clips[0].waves[0].amplitude, glm::vec3(0.5f, 0.125f, -0.25f));
  EXPECT_EQ(clips[0].waves[0].period, 3.0f);
  EXPECT_EQ(clips[0].waves[0].phase, 0.1f);

  EXPECT_EQ(clips[1].duration, 3.0f);  // the last key
  const auto& keys = clips[1].tracks.at(0).keys;
  EXPECT_EQ(keys[1].value, glm::vec4(0.5f, 0, 0, 0));
  EXPECT_FLOAT_EQ(keys[0].out.x, 0.5f);  // one-sided: a half in 1 s
  EXPECT_FLOAT_EQ(keys[1].in.x, 0.1f);   // between its neighbors: 0.3 in 3 s
  EXPECT_FLOAT_EQ(keys[1].out.x, 0.1f);
  EXPECT_EQ(keys[2].in, glm::vec4(0, 1, 0, 0));
  EXPECT_FLOAT_EQ(keys[2].out.x, -0.1f);
  // Part motion is in the pivot's units: neither scaled nor turned.
  EXPECT_EQ(clips[1].tracks.at(1).keys[1].value, glm::vec4(4, 5, 6, 0));
}

TEST(RealizeClips, NeighboringRotationsTakeTheShortWay) {
  const auto rig = parseRig(R"({"kelp": 1, "clips": {"c": {"interpolation": "cubic", "keys": [
    {"time": 0, "rotation": [0, 0, 0, 1]}, {"time": 1, "rotation": [0, -0.6, 0, -0.8]}, {"time": 2, "rotation": [0, -0.8, 0, -0.6]}]}}})");
  const auto keys = realizeClips(rig, 0)[0].tracks[0].keys;
  for (const Key& key : keys) {
    EXPECT_GE(key.value.w, 0.0f);
    EXPECT_NEAR(glm::length(key.value), 1, 1e-6);
  }
  EXPECT_FLOAT_EQ(keys[1].in.y, 0.4f);
}

TEST(MergeClips, JoinsByName) {
  RawClip waves{"idle", 5, {Wave{}}, {}}, tracks{"idle", 2, {}, {RawTrack{}}}, other{"run", 1, {Wave{}}, {}},
      longer{"idle", 3, {}, {RawTrack{}}};
  std::vector<RawClip> clips{waves};
  mergeClips(clips, {tracks, other});
  ASSERT_EQ(clips.size(), 2u);
  EXPECT_EQ(clips[0].duration, 2.0f);  // tracks say when the clip repeats
  EXPECT_EQ(clips[0].waves.size(), 1u);
  EXPECT_EQ(clips[0].tracks.size(), 1u);
  mergeClips(clips, {longer});
  EXPECT_EQ(clips[0].duration, 3.0f);
  EXPECT_EQ(clips[0].tracks.size(), 2u);
}

TEST(DescribeRig, IsTheInverseOfRealize) {
  const auto rig = parseRig(
      R"({"kelp": 1, "axis": "-z", "knots": [{"at": 0}, {"at": 0.3, "offset": [0.1, 0.02, 0.3]}, {"at": 1, "tangent": [0.5, 0.2, -1]}], "clips": {
    "a": {"waves": [{"knot": 1, "tangent": [0.5, 0.25, 0.125], "period": 3, "phase": 0.1}]},
    "b": {"interpolation": "cubic", "keys": [{"time": 0, "knot": 1, "offset": [0, 0, 0]}, {"time": 1, "knot": 1, "offset": [0.5, 0, 0]},
          {"time": 2, "scale": [1, 1, 2], "interpolation": "step"}]}}})");
  const auto knots = realizeKnots(rig);
  auto clips = realizeClips(rig, 3);
  clips.push_back({"of another part", 1, {Wave{}}, {}});
  const RigDescription described =
      parseRig(printRig(describeRig({{knots, automaticTangents(rig)}}, clips, 3)));
  EXPECT_EQ(described.axis, Axis::kPlusY);
  EXPECT_FALSE(described.knots[0].tangent || described.knots[1].tangent) << "automatic";
  EXPECT_TRUE(described.knots[2].tangent);
  ASSERT_EQ(described.clips.size(), 2u);

  const auto again = realizeKnots(described);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    EXPECT_LT(glm::length(again[i].position - knots[i].position), 1e-4f);
    EXPECT_LT(glm::length(again[i].tangent - knots[i].tangent), 1e-4f);
  }
  const auto clips_again = realizeClips(described, 3);
  EXPECT_EQ(clips_again[0].duration, clips[0].duration);
  EXPECT_LT(glm::length(clips_again[0].waves[0].amplitude - clips[0].waves[0].amplitude), 1e-4f);
  ASSERT_EQ(clips_again[1].tracks.size(), 2u);
  EXPECT_EQ(clips_again[1].tracks[1].interpolation, Interpolation::kStep);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LT(glm::length(clips_again[1].tracks[0].keys[k].value - clips[1].tracks[0].keys[k].value), 1e-4f);
    EXPECT_LT(glm::length(clips_again[1].tracks[0].keys[k].out - clips[1].tracks[0].keys[k].out), 1e-4f);
  }
}

// An artist whose file has the spline along another axis gets the rig in that file's axes.
TEST(DescribeRig, SpeaksOfEveryAxis) {
  const auto rig = parseRig(
      R"({"kelp": 1, "axis": "-z", "knots": [{"at": 0}, {"at": 0.25, "offset": [0.125, 0.5, 0.375]}, {"at": 1, "tangent": [0.5, 0.25, -1]}], "clips": {
    "a": {"waves": [{"knot": 1, "tangent": [0.5, 0.25, 0.125], "period": 3}]},
    "b": {"interpolation": "cubic", "keys": [{"time": 0, "knot": 1, "offset": [0, 0, 0]}, {"time": 1, "knot": 1, "offset": [0.5, 0, 0.25]}, {"time": 2, "rotation": [0, 0, 0, 1]}]}}})");
  const auto knots = realizeKnots(rig);
  const auto clips = realizeClips(rig, 0);
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    const RigDescription described =
        parseRig(printRig(describeRig({{knots, automaticTangents(rig)}}, clips, 0, axis)));
    EXPECT_EQ(described.axis, axis);
    const auto again = realizeKnots(described);
    for (std::size_t i = 0; i < knots.size(); ++i)
      EXPECT_TRUE(again[i].position == knots[i].position && again[i].tangent == knots[i].tangent)
          << toString(axis);
    const auto clips_again = realizeClips(described, 0);
    EXPECT_EQ(clips_again[0].waves[0].amplitude, clips[0].waves[0].amplitude);
    for (std::size_t t = 0; t < clips[1].tracks.size(); ++t)
      for (std::size_t k = 0; k < clips[1].tracks[t].keys.size(); ++k) {
        EXPECT_EQ(clips_again[1].tracks[t].keys[k].value, clips[1].tracks[t].keys[k].value);
        EXPECT_EQ(clips_again[1].tracks[t].keys[k].out, clips[1].tracks[t].keys[k].out);
      }
    EXPECT_TRUE(axis != Axis::kMinusZ || described.knots[1].offset == rig.knots[1].offset);
  }
}

TEST(DescribeRig, NamesThatAPackMayRepeatBecomeKeys) {
  std::vector<RawClip> clips;
  for (const char* name : {"", "swim", "swim", ""})
    clips.push_back({name, 1, {Wave{0, 1, Target::kKnotOffset, {1, 0, 0}, 1, 0}}, {}});
  const auto rig = parseRig(printRig(describeRig({{realizeKnots({}), 0}}, clips, 0)));
  std::vector<std::string> names;
  for (const auto& clip : rig.clips) names.push_back(clip.name);
  EXPECT_EQ(names, (std::vector<std::string>{"clip", "swim", "swim 2", "clip 2"}));
}

// A socket's place, and the directions to which its rotation turns x, y and z, are the same in
// either axes.
TEST(RealizeRig, BendsAsItSaysOrElseByDefault) {
  RigDescription rig;
  EXPECT_EQ(realizeRig(rig).bend, kDefaultBend);
  EXPECT_EQ(realizeRig(rig, Bend::kSweep).bend, Bend::kSweep);
  rig.bend = Bend::kShear;
  EXPECT_EQ(realizeRig(rig, Bend::kSweep).bend, Bend::kShear);
  EXPECT_EQ(describeRig(realizeRig(rig), {}, 0).bend, Bend::kShear);
}

TEST(CheckRest, AShearedPartMayNotTurnBackASweptOneMayNotFold) {
  const auto errorOf = [](const RawRig& rest, const glm::ivec3& size) -> std::string {
    try {
      checkRest(rest, size);
    } catch (const RigError& error) {
      return error.what();
    }
    return "";
  };
  // A hook: up, over and down again.
  RawRig rest;
  rest.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0.3f, 0.4f, 0}, {1, 0, 0}}, {1, {0.6f, 0, 0}, {0, -1, 0}}};
  EXPECT_NE(errorOf(rest, {16, 128, 16}).find("knot 1 (at 0.5): "), std::string::npos);
  EXPECT_NE(errorOf(rest, {16, 128, 16}).find("\"bend\": \"sweep\""), std::string::npos);
  rest.bend = Bend::kSweep;
  EXPECT_EQ(errorOf(rest, {16, 128, 16}), "");
  EXPECT_NE(errorOf(rest, {128, 128, 128}).find("knot 0 (at 0): "), std::string::npos);
  EXPECT_NE(errorOf(rest, {128, 128, 128}).find("may not fold"), std::string::npos);
  // A board that is flat across the bend, and one that stands on its edge.
  EXPECT_EQ(errorOf(rest, {2, 128, 128}), "");
  rest.roll = 1.5708f;
  EXPECT_NE(errorOf(rest, {2, 128, 128}), "");
}

TEST(RealizeSockets, ThePlaceAndTheTurnAreTheArtists) {
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    SCOPED_TRACE(toString(axis));
    const int along = static_cast<int>(axis) / 2;
    RigDescription rig;
    rig.axis = axis;
    RigDescription::Socket socket{"hand", 0.75f, {0.5f, 0.25f, -0.125f}, glm::quat(0.8f, 0.36f, 0, 0.48f)};
    socket.offset[along] = 0;
    rig.sockets = {socket};
    const std::vector<RawSocket> sockets = realizeSockets(rig, 3);
    ASSERT_EQ(sockets.size(), 1u);
    EXPECT_EQ(sockets[0].name, "hand");
    EXPECT_EQ(sockets[0].part, 3u);
    EXPECT_EQ(sockets[0].at, 0.75f);
    const glm::mat3 to_artist = glm::inverse(axisRotation(axis));
    const glm::vec3 place = to_artist * glm::vec3(sockets[0].offset.x, 0, sockets[0].offset.y);
    EXPECT_LT(glm::distance(place, socket.offset), 1e-6f);
    for (int i = 0; i < 3; ++i) {
      glm::vec3 direction(0);
      direction[i] = 1;
      const glm::vec3 turned = to_artist * (sockets[0].rotation * (axisRotation(axis) * direction));
      EXPECT_LT(glm::distance(turned, socket.rotation * direction), 1e-6f);
    }

    // And back, to the bit.
    rig.parent_at = 0.5f;
    rig.bend = Bend::kSweep;
    rig.roll = 0.7f;
    rig.caged = true;
    rig.cell = 4;
    const RigDescription back = parseRig(printRig(describeRig(realizeRig(rig), {}, 3, axis, sockets)));
    EXPECT_EQ(back.bend, Bend::kSweep);
    EXPECT_EQ(back.roll, 0.7f);
    EXPECT_TRUE(back.caged);
    EXPECT_EQ(back.cell, 4);
    EXPECT_EQ(back.sockets, rig.sockets);
    EXPECT_EQ(back.parent_at, 0.5f);
    EXPECT_TRUE(describeRig({{realizeKnots(rig), 0}}, {}, 2, axis, sockets).sockets.empty())
        << "another part's";

    rig.sockets[0].offset[along] = 0.01f;
    try {
      realizeSockets(rig, 0);
      ADD_FAILURE() << "an offset along the axis is taken";
    } catch (const RigError& error) {
      EXPECT_NE(std::string(error.what()).find("/sockets/hand/offset: "), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("\"at\""), std::string::npos);
    }
    rig.sockets[0].offset[along] = 5e-7f;
    EXPECT_NO_THROW(realizeSockets(rig, 0));
  }
}

// A text may be off by a thousandth, a pack's quaternion by less.
TEST(RealizeSockets, RotationsAreUnit) {
  for (const char* w : {"0.9991", "1.0009"}) {
    const auto sockets = realizeSockets(
        parseRig(std::string(R"({"kelp": 1, "sockets": {"a": {"at": 0, "rotation": [0, 0, 0, )") + w +
                 "]}}}"),
        0);
    EXPECT_FLOAT_EQ(sockets.at(0).rotation.w, 1);
  }
}

TEST(DescribeRig, SocketsThatShareANameGetTheirOwn) {
  std::vector<RawSocket> sockets;
  for (const char* name : {"hand", "hand", "hand 2"}) sockets.push_back({name, 0, 0.5f, {}, {1, 0, 0, 0}});
  const auto rig = parseRig(printRig(describeRig({{realizeKnots({}), 0}}, {}, 0, Axis::kPlusY, sockets)));
  ASSERT_EQ(rig.sockets.size(), 3u);
  EXPECT_EQ(rig.sockets[1].name, "hand 2");
  EXPECT_EQ(rig.sockets[2].name, "hand 2 2");
}

}  // namespace
}  // namespace kelp
