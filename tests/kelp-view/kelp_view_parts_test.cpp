// SPDX-License-Identifier: MIT
// The views of parts: what a pack says of its skin, colours, joints, and what is said of a part.
#include <gtest/gtest.h>

#include <string>

#include <glm/gtc/quaternion.hpp>

#include "arguments.h"
#include "kelp/common/part_colors.h"
#include "part_look.h"
#include "support/scratch.h"
#include "support/test_pack.h"

namespace kelp::view {
namespace {

constexpr char kSkin[] =
    R"({"tool":{},"skin":{"parts":[)"
    R"({"joints":["hip"],"fit":{"mean":0.25,"p95":1,"max":2.5}},)"
    R"({"joints":["arm [0]","arm [1]"],"knots":4,"fit":{"mean":0.5,"p95":4,"max":9}}]}})";

TEST(SkinInfo, IsReadPartByPart) {
  const std::vector<PartSkin> skin = readSkin(kSkin, 2);
  ASSERT_EQ(skin.size(), 2u);
  EXPECT_EQ(skin[0].joints, std::vector<std::string>{"hip"});
  EXPECT_EQ(skin[1].joints, (std::vector<std::string>{"arm [0]", "arm [1]"}));
  ASSERT_TRUE(skin[0].fit && skin[1].fit);
  EXPECT_EQ(skin[0].fit->mean, 0.25);
  EXPECT_EQ(skin[0].fit->p95, 1);
  EXPECT_EQ(skin[1].fit->max, 9);
  EXPECT_TRUE(knowsFit(skin));
}

TEST(SkinInfo, HasAnEntryForEachPartWhateverItSays) {
  EXPECT_EQ(readSkin(kSkin, 1).size(), 1u);
  const std::vector<PartSkin> more = readSkin(kSkin, 4);
  ASSERT_EQ(more.size(), 4u);
  EXPECT_TRUE(more[1].fit);
  EXPECT_FALSE(more[2].fit || more[3].fit);
  EXPECT_TRUE(readSkin(kSkin, 0).empty());
}

TEST(SkinInfo, WhatMakesNoSenseIsNotKnown) {
  const auto part = [](const std::string& text) { return R"({"skin":{"parts":[)" + text + "]}}"; };
  const auto fit = [&](const std::string& numbers) {
    return part(R"({"joints":["a"],"fit":)" + numbers + "}");
  };
  const std::string deep(100000, '[');
  for (const std::string& info :
       std::vector<std::string>{"",
                                "null",
                                "7",
                                "[]",
                                "{",
                                "{}",
                                R"("skin")",
                                R"({"skin":null})",
                                R"({"skin":[]})",
                                R"({"skin":{}})",
                                R"({"skin":{"parts":7}})",
                                R"({"skin":{"parts":{"0":1}}})",
                                part(""),
                                part("null"),
                                part("[]"),
                                part("{}"),
                                part(R"({"fit":3})"),
                                part(R"({"fit":[1,2,3]})"),
                                fit("{}"),
                                fit(R"({"mean":1,"p95":2})"),
                                fit(R"({"mean":1,"p95":"2","max":3})"),
                                fit(R"({"mean":1,"p95":null,"max":3})"),
                                fit(R"({"mean":-1,"p95":2,"max":3})"),
                                fit(R"({"mean":1,"p95":-0.1,"max":3})"),
                                fit(R"({"mean":1,"p95":2,"max":-3})"),
                                fit(R"({"mean":1,"p95":2,"max":1.5})"),
                                fit(R"({"mean":4,"p95":2,"max":3})"),
                                fit(R"({"mean":1,"p95":2,"max":1e300})"),
                                fit(R"({"mean":1,"p95":2,"max":1e999})"),
                                fit(R"({"mean":NaN,"p95":2,"max":3})"),
                                fit(R"({"mean":1,"p95":nan,"max":Infinity})"),
                                fit(R"({"mean":true,"p95":2,"max":3})"),
                                fit(R"({"mean":1,"p95":2,"max":18446744073709551615})"),
                                part(R"({"joints":"a","fit":{}})"),
                                part(R"({"joints":[1,null,{}]})"),
                                deep,
                                "{\"skin\":" + deep,
                                part(deep),
                                "\xff\xfe" + std::string(kSkin),
                                std::string(kSkin).substr(0, 120)}) {
    const std::vector<PartSkin> skin = readSkin(info, 3);
    EXPECT_EQ(skin.size(), 3u);
    EXPECT_FALSE(knowsFit(skin)) << info.substr(0, 200);
  }
  EXPECT_EQ(readSkin(part(R"({"joints":["a",7,"b"]})"), 1)[0].joints, (std::vector<std::string>{"a", "b"}));
}

TEST(PartColors, FitGoesFromGreenOverYellowToRed) {
  const auto greenest = [](glm::u8vec3 c) { return c.g > 1.5 * c.r && c.g > 1.5 * c.b; };
  const auto yellow = [](glm::u8vec3 c) { return c.r > 200 && c.g > 180 && c.b < 120; };
  const auto reddest = [](glm::u8vec3 c) { return c.r > 2 * c.g && c.r > 2 * c.b; };
  EXPECT_TRUE(greenest(fitColor(0)));
  EXPECT_TRUE(yellow(fitColor(kPoorFit / 2)));
  EXPECT_TRUE(reddest(fitColor(kPoorFit)));
  EXPECT_EQ(fitColor(kPoorFit), fitColor(1e6));
  EXPECT_EQ(fitColor({}).r, fitColor({}).g);
  EXPECT_EQ(fitColor({}).r, fitColor({}).b);
  for (double voxels = 0; voxels < kPoorFit; voxels += 0.1) {  // never greener again
    const glm::u8vec3 near = fitColor(voxels), far = fitColor(voxels + 0.1);
    EXPECT_LE(static_cast<double>(near.r) / near.g, static_cast<double>(far.r) / far.g) << voxels;
    EXPECT_NE(near, far);
  }
}

// By the distance of CompuPhase ("Colour metric", T. Riemersma), 0 to 765.
TEST(PartColors, TwoDozenPartsAreToldApart) {
  for (int a = 0; a < 24; ++a) {
    for (int b = 0; b < a; ++b) {
      const glm::dvec3 one(partColor(a)), other(partColor(b)), d = one - other;
      const double red = (one.r + other.r) / 2;
      const double square = (2 + red / 256) * d.r * d.r + 4 * d.g * d.g + (2 + (255 - red) / 256) * d.b * d.b;
      EXPECT_GT(std::sqrt(square), a - b < 3 ? 150 : 70) << a << " and " << b;
    }
  }
}

// The texel that kPartSurface reads for each part of each instance.
TEST(PartColors, TexelsAreWhereTheShaderReads) {
  for (const std::size_t parts : {1, 3, 1024, 1025, 4096}) {
    std::vector<std::vector<glm::u8vec3>> colors(3);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t p = 0; p < (i == 1 ? parts : 1); ++p) colors[i].emplace_back(i, p % 251, p / 251);
    }
    const PartTexels texels(colors);
    ASSERT_EQ(texels.texels.size(), static_cast<std::size_t>(texels.size.x * texels.size.y));
    EXPECT_LE(texels.size.x, 2048);  // what every OpenGL ES 3.0 has
    EXPECT_LE(texels.size.y, 2048);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t p = 0; p < colors[i].size(); ++p) {
        const std::size_t x = p % 1024, y = i * static_cast<std::size_t>(texels.rows) + p / 1024;
        EXPECT_EQ(glm::u8vec3(texels.texels[y * static_cast<std::size_t>(texels.size.x) + x]), colors[i][p]);
      }
    }
  }
}

// A body, and on it an arm that is swept. The arm is turned by a clip about its pivot, which is one metre up.
class PartViews : public ::testing::Test {
 protected:
  void SetUp() override { open(packOf(kSkin)); }
  static RawPack packOf(const char* info) {
    const fields::Occupancy volume{{8, 48, 8}, std::vector<std::uint8_t>(8 * 48 * 8, 1)};
    RawPack pack = test::packOf(volume);
    pack.info_json = info;
    RawPart arm = pack.parts[0];
    arm.name = "arm";
    arm.parent = 0;
    arm.bend = Bend::kSweep;
    arm.knots = {{0, {0, 0, 0}, {0, 1, 0}}, {0.5f, {0, 0.5f, 0}, {0, 1, 0}}, {1, {0, 1, 0}, {0, 1, 0}}};
    arm.pivot = glm::mat4x3(1);
    arm.pivot[3] = {0, 1, 0};
    RawPart hand = pack.parts[0];
    hand.name = "hand";
    hand.parent = 1;
    hand.pivot[3] = {0.25f, 0.5f, 0};
    pack.parts.push_back(arm);
    pack.parts.push_back(hand);
    RawClip clip;
    clip.name = "turn";
    clip.duration = 1;
    RawTrack track;
    track.part = 1;
    track.target = Target::kPartRotation;
    const glm::quat half = glm::angleAxis(3.14159265f, glm::vec3(0, 0, 1));
    track.keys = {{0, glm::vec4(half.x, half.y, half.z, half.w), {}, {}}};
    clip.tracks.push_back(track);
    pack.clips.push_back(clip);
    return pack;
  }
  void open(const RawPack& pack) {
    auto opened = Model::open(scratch_.write("model.kelp", test::bytesOf(pack)).string());
    ASSERT_TRUE(opened) << describe(opened.error());
    model_ = *std::move(opened);
  }

  const test::Scratch scratch_;
  std::unique_ptr<Model> model_;
};

TEST_F(PartViews, JointsFollowThePose) {
  model_->clipWeights()[0] = 0;
  model_->pose(0);
  EXPECT_FALSE(jointOf(*model_, 0).from);
  EXPECT_LT(glm::distance(jointOf(*model_, 1).at, glm::vec3(0, 1, 0)), 1e-4f);
  ASSERT_TRUE(jointOf(*model_, 1).from);
  EXPECT_LT(glm::distance(*jointOf(*model_, 1).from, jointOf(*model_, 0).at), 1e-4f);
  EXPECT_LT(glm::distance(jointOf(*model_, 2).at, glm::vec3(0.25f, 0.5f, 0)), 1e-4f);
  // From the nearest point of the arm's centre line.
  EXPECT_LT(glm::distance(jointOf(*model_, 2).from.value(), glm::vec3(0, 0.5f, 0)), 1e-3f);
  // Half a turn about (0, 1, 0): the arm points up from there, and takes the hand along.
  model_->clipWeights()[0] = 1;
  model_->pose(0);
  EXPECT_LT(glm::distance(jointOf(*model_, 1).at, glm::vec3(0, 1, 0)), 1e-4f);
  EXPECT_LT(glm::distance(jointOf(*model_, 2).at, glm::vec3(-0.25f, 1.5f, 0)), 1e-4f);
  EXPECT_LT(glm::distance(jointOf(*model_, 2).from.value(), glm::vec3(0, 1.5f, 0)), 1e-3f);
}

TEST_F(PartViews, SaysWhatIsKnown) {
  EXPECT_EQ(
      describePart(*model_, 0),
      (std::vector<std::string>{"part: rigid", "joint: hip", "fit: mean 0.25, 95 % 1.00, max 2.50 voxels"}));
  EXPECT_EQ(describePart(*model_, 1),
            (std::vector<std::string>{"arm: swept, 3 knots", "joints: arm [0], arm [1]",
                                      "fit: mean 0.50, 95 % 4.00, max 9.00 voxels"}));
  EXPECT_EQ(describePart(*model_, 2), std::vector<std::string>{"hand: sheared, 2 knots"});
}

TEST_F(PartViews, LongListsOfJointsAreCut) {
  std::string joints;
  for (int i = 0; i < 1000; ++i) joints += (i > 0 ? ",\"" : "\"") + std::string(1000, 'j') + "\"";
  open(packOf((R"({"skin":{"parts":[{"joints":[)" + joints + "]}]}}").c_str()));
  const std::vector<std::string> lines = describePart(*model_, 0);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_LT(lines[1].size(), 500u);
  EXPECT_NE(lines[1].find("992 more"), std::string::npos) << lines[1];
  EXPECT_EQ(lines[2], "fit: not known");
}

TEST_F(PartViews, ColoursAreThoseOfTheSurface) {
  EXPECT_EQ(colorsOf(*model_, Surface::kParts, {}),
            (std::vector<glm::u8vec3>{partColor(0), partColor(1), partColor(2)}));
  EXPECT_EQ(colorsOf(*model_, Surface::kFit, {}),
            (std::vector<glm::u8vec3>{fitColor(1), fitColor(4), fitColor({})}));
  const auto sum = [](const glm::u8vec3& c) { return c.r + c.g + c.b; };
  const std::vector<glm::u8vec3> pointed = colorsOf(*model_, Surface::kFit, {1, -1});
  EXPECT_GT(sum(pointed[1]), sum(fitColor(4)));
  EXPECT_EQ(pointed[0], fitColor(1));
  const std::vector<glm::u8vec3> chosen = colorsOf(*model_, Surface::kFit, {-1, 1});
  EXPECT_EQ(chosen[1], fitColor(4));
  EXPECT_LT(sum(chosen[0]), sum(fitColor(1)));
  EXPECT_LT(sum(chosen[2]), sum(fitColor({})));
}

TEST_F(PartViews, WithoutClipsNothingWasMeasured) {
  EXPECT_TRUE(knowsFit(model_->skin()));
  RawPack pack = packOf(kSkin);
  pack.clips.clear();
  open(pack);
  EXPECT_FALSE(knowsFit(model_->skin()));
  EXPECT_EQ(model_->skin()[0].joints.size(), 1u);
}

TEST(Surfaces, HaveNamesAndAnOrder) {
  for (int i = 0; i < static_cast<int>(Surface::kCount); ++i) {
    const auto surface = static_cast<Surface>(i);
    EXPECT_EQ(parseSurface(toString(surface)), surface);
    EXPECT_NE(std::string(kSurfaceNames).find(toString(surface)), std::string::npos);
  }
  EXPECT_FALSE(parseSurface("nonsense"));
  EXPECT_EQ(afterParts(Surface::kNormals, true), Surface::kParts);
  EXPECT_EQ(afterParts(Surface::kParts, true), Surface::kFit);
  EXPECT_EQ(afterParts(Surface::kParts, false), Surface::kShaded);
  EXPECT_EQ(afterParts(Surface::kFit, true), Surface::kShaded);
}

TEST(Surfaces, AreAnOption) {
  std::string wrong;
  const char* const good[] = {"kelp-view", "--view", "fit", "fox.kelp"};
  const auto arguments = parseArguments(4, good, wrong);
  ASSERT_TRUE(arguments) << wrong;
  EXPECT_EQ(arguments->surface, Surface::kFit);
  EXPECT_EQ(arguments->pack, "fox.kelp");
  const char* const bad[] = {"kelp-view", "--view", "nonsense"};
  EXPECT_FALSE(parseArguments(3, bad, wrong));
  EXPECT_FALSE(parseArguments(2, bad, wrong));
  EXPECT_NE(wrong.find("--view"), std::string::npos);
}

}  // namespace
}  // namespace kelp::view
