// SPDX-License-Identifier: MIT
// Rig files with rigs of parts by name: that printing is the inverse of reading, and what packs tell of their
// parts.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/rig/rig_file.h"
#include "support/test_pack.h"

namespace kelp {
namespace {

using PartRig = RigFile::PartRig;

TEST(RigFiles, PartsKeepTheirOrder) {
  const RigFile file = parseRigFile(R"({"kelp": 1, "parts": {
    "leg": {"bend": "sweep", "roll": 30}, "a/b": {}, "arm \"r\"": {"kelp": 1, "axis": "-x", "knots": [{"at": 0}, {"at": 1}]}}})");
  ASSERT_EQ(file.parts.size(), 3u);
  EXPECT_EQ(file.parts[0].name, "leg");
  EXPECT_EQ(file.parts[0].rig.roll, rollOfDegrees(30));
  EXPECT_EQ(file.parts[1], (PartRig{"a/b", {}}));
  EXPECT_EQ(file.find("arm \"r\"")->axis, Axis::kMinusX);
  EXPECT_EQ(file.find("arm"), nullptr);
  EXPECT_EQ(file.whole, RigDescription());
  EXPECT_EQ(printRigFile(file), R"({
  "kelp": 1,
  "parts": {
    "leg": {
      "bend": "sweep",
      "roll": 30},
    "a/b": {},
    "arm \"r\"": {
      "axis": "-x",
      "knots": [
        {"at": 0},
        {"at": 1}]}}}
)");
}

TEST(RigFiles, ARigOfAWholeFileIsOneToo) {
  const std::string text = R"({"kelp": 1, "axis": "+z", "bend": "shear"})";
  EXPECT_EQ(parseRigFile(text).whole, parseRig(text));
  EXPECT_TRUE(parseRigFile(text).parts.empty());
  EXPECT_EQ(printRigFile(parseRigFile(text)), printRig(parseRig(text)));
  EXPECT_THROW(parseRig(R"({"kelp": 1, "parts": {"a": {}}})"), RigError) << "extras.kelp is of one part";
}

// Rigs once said which joints make which parts.
TEST(RigFiles, WhatDividedSkinsSaysWhatReplacesIt) {
  for (const char* text : {R"({"kelp": 1, "skin": {"parts": [{"joints": ["Hip"], "pieces": 2}]}})",
                           R"({"kelp": 1, "skin": {}, "parts": {"Hip": {}}})",
                           R"({"kelp": 1, "parts": {"Hip": {"skin": 3}}})"}) {
    try {
      parseRigFile(text);
      ADD_FAILURE() << text;
    } catch (const RigError& error) {
      EXPECT_NE(std::string(error.what()).find("/skin: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("under \"parts\""), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(parseRig(R"({"kelp": 1, "skin": {}})"), RigError);
}

// A pack of parts, all rotations of whose clips are unit as far as floats can be.
RawPack packOf(const std::vector<std::string>& names, const std::string& info, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> share(0, 1);
  RawPack pack;
  std::vector<RigDescription> rigs;
  for (std::uint32_t p = 0; p < names.size(); ++p) {
    RawPack one = test::packOf(test::ballClump({8, 12, 8}, 2, 1));
    one.parts[0].name = names[p];
    RigDescription rig;
    rig.axis = static_cast<Axis>(p % 6);
    const glm::mat3 to_artist = glm::transpose(axisRotation(*rig.axis));
    rig.knots = {{0, {}, {}},
                 {0.1f + 0.8f * share(random), to_artist * glm::vec3(0.01f, 0, 0.1f / 3), {}},
                 {1, {}, {}}};
    rig.sockets = {{"s", share(random), to_artist * glm::vec3(share(random), 0, 0), {1, 0, 0, 0}}};
    RigDescription::Track turns{0, Target::kPartRotation, Interpolation::kLinear, {}};
    for (int k = 0; k < 50; ++k) {
      const glm::vec4 q(normal(random), normal(random), normal(random), normal(random));
      turns.keys.push_back({0.1f * static_cast<float>(k), glm::normalize(q), {}, {}});
    }
    rig.clips = {{p % 2 ? "odd" : "even",
                  {},
                  {{1, Target::kKnotOffset, to_artist * glm::vec3(0.02f, 0, 0), 1.7f, 0.3f}},
                  {turns}},
                 {"all", {}, {{2, Target::kKnotTangent, to_artist * glm::vec3(0, 0, 0.1f), 0.7f, 0}}, {}}};
    one.parts[0].to_object = glm::mat4x3(glm::mat4(to_artist));
    const RawRig rest = realizeRig(rig);
    one.parts[0].knots = rest.knots;
    one.parts[0].automatic_tangents = rest.automatic_tangents;
    one.parts[0].bend = rest.bend;
    if (p == 0)
      pack = one;
    else
      pack.parts.push_back(one.parts[0]);
    mergeClips(pack.clips, realizeClips(rig, p));
    for (RawSocket& socket : realizeSockets(rig, p)) pack.sockets.push_back(socket);
  }
  pack.info_json = info;
  return pack;
}

struct Opened {
  explicit Opened(const RawPack& raw)
      : bytes(test::bytesOf(raw)), memory(bytes), pack(Pack::open(memory.source())) {}
  std::vector<std::byte> bytes;
  MemorySource memory;
  Result<Pack> pack;
};

TEST(RigFiles, ThePacksRigsReadBackToTheSameBits) {
  const std::vector<std::string> names{"arm", "leg", "a \"b\"", "c/d", "e", "f", "g"};
  for (unsigned seed = 0; seed < 20; ++seed) {
    RawPack raw = packOf(names, "{}", seed);
    const Opened open(raw);
    ASSERT_TRUE(open.pack) << open.pack.error().detail;
    const RigFile file = parseRigFile(printRigFile(describeParts(*open.pack, RiggedPack(*open.pack))));
    ASSERT_EQ(file.parts.size(), names.size());
    raw.clips.clear();
    raw.sockets.clear();
    for (std::uint32_t p = 0; p < names.size(); ++p) {
      const RigDescription& rig = *file.find(names[p]);
      EXPECT_EQ(rig.axis, static_cast<Axis>(p % 6));
      raw.parts[p].knots = realizeKnots(rig);
      mergeClips(raw.clips, realizeClips(rig, p));
      for (RawSocket& socket : realizeSockets(rig, p)) raw.sockets.push_back(socket);
    }
    EXPECT_TRUE(test::bytesOf(raw) == open.bytes) << seed;
  }
}

TEST(RigFiles, InfoTellsOfPartsAndIsNotTrusted) {
  const auto rigged = [](const std::vector<std::string>& names, const std::string& info) {
    const Opened open(packOf(names, info, 1));
    return RiggedPack(*open.pack);
  };
  EXPECT_FALSE(rigged({"a"}, "{}").by_part);
  EXPECT_TRUE(rigged({"a", "b"}, "{}").by_part);
  EXPECT_TRUE(rigged({"a"}, R"({"options": {"parts": "nodes"}})").by_part);
  EXPECT_EQ(rigged({"a", "b"}, R"({"axes": {"b": "+z", "c": "-z"}})").axes,
            (std::vector<Axis>{Axis::kPlusX, Axis::kPlusZ}));
  const RiggedPack skin = rigged({"a", "b"}, R"({"skin": {"rigs": ["b", "c"]}})");
  EXPECT_TRUE(skin.skinned);
  EXPECT_EQ(skin.given, (std::vector<bool>{false, true}));
  EXPECT_EQ(rigged({"a", "b"}, "{}").given, (std::vector<bool>{true, true}));
  for (const char* none :
       {R"({"skin": {}})", R"({"skin": {"rigs": {"a": 1}}})", R"({"skin": {"rigs": [1]}})"})
    EXPECT_EQ(rigged({"a", "b"}, none).given, (std::vector<bool>{false, false})) << none;
  for (const char* bad :
       {"", "[]", "3", "{\"axes\": []}", R"({"axes": {"a": 3, "b": "up"}})", R"({"options": 1})",
        R"({"options": {"parts": ["nodes"], "rig": {"name": "skin"}}})"}) {
    const RiggedPack out = rigged({"a", "b"}, bad);
    EXPECT_EQ(out.axes, (std::vector<Axis>{Axis::kPlusX, Axis::kMinusX})) << bad;
    EXPECT_FALSE(out.skinned) << bad;
  }
}

TEST(RigFiles, NoAxisIsFoundWhereThePartIsSkewed) {
  const glm::mat4x3 straight(1);
  for (int i = 0; i < 6; ++i) {
    const Axis axis = static_cast<Axis>(i);
    const glm::mat4 turn = glm::rotate(glm::mat4(1), 0.7f, glm::vec3(0.6f, 0, 0.8f));
    EXPECT_EQ(
        axisByPlace(glm::mat4x3(turn * glm::mat4(glm::transpose(axisRotation(axis)))), glm::mat4x3(turn)),
        axis);
  }
  EXPECT_EQ(axisByPlace(glm::mat4x3(glm::rotate(glm::mat4(1), 0.7f, glm::vec3(0, 1, 0))), straight),
            std::nullopt);
}

}  // namespace
}  // namespace kelp
