// SPDX-License-Identifier: MIT
// kelp-render --view parts and --view fit: each part in one colour.
#include "render_fixture.h"

namespace kelp {
namespace {

using namespace test;

// Two boxes, one above the other, and a clip.
RawPack twoParts(const std::string& skin) {
  RawPack pack = boxPack();
  pack.info_json = "{\"skin\":" + skin + "}";
  pack.parts.push_back(pack.parts[0]);
  pack.parts[1].name = "above";
  pack.parts[1].to_object[3].y += 1;
  return pack;
}

std::string skinOf(const std::string& below, const std::string& above) {
  const auto fit = [](const std::string& p95) { return R"({"fit":{"mean":0,"max":9,"p95":)" + p95 + "}}"; };
  return R"({"parts":[)" + fit(below) + "," + fit(above) + "]}";
}

bool isGreen(const glm::ivec4& c) { return c.g > 1.5 * c.r && c.g > 1.5 * c.b; }
bool isRed(const glm::ivec4& c) { return c.r > 2 * c.g && c.r > 2 * c.b; }
bool isYellow(const glm::ivec4& c) { return c.r > 200 && c.g > 180 && c.b < 120; }
bool isGrey(const glm::ivec4& c) { return c.r > 60 && c.r < 200 && c.r == c.g && c.r == c.b; }

TEST_F(KelpRender, PartsHaveColoursOfTheirOwn) {
  write(pack_, bytesOf(twoParts("{}")));
  const Picture p = picture({"--view", "parts"});
  const glm::ivec4 below = p.at(60, 90), above = p.at(60, 30);
  EXPECT_GT(glm::length(glm::vec3(below - above)), 60);
  // All of a part, whatever its materials are; the same in each pack of the picture.
  const auto alike = [](const glm::ivec4& a, const glm::ivec4& b) {
    return glm::length(glm::vec3(a - b)) < 8;
  };
  EXPECT_TRUE(alike(p.at(54, 110), p.at(66, 70)));
  EXPECT_TRUE(alike(p.at(54, 50), p.at(66, 10)));
  const Picture both = picture({"--view", "parts", "--size", "240x120", "--and", pack_, "--at", "2,0,0"});
  EXPECT_GT(both.middle(0, 120), 90);
  for (const int y : {35, 85}) {
    std::vector<glm::ivec4> seen;
    for (int x = 0; x < 240; ++x) {
      const glm::ivec4 c = both.at(x, y);
      if (both.covered(x, y) && both.covered(x - 1, y) && both.covered(x + 1, y)) seen.push_back(c);
    }
    ASSERT_GT(seen.size(), 20u);
    EXPECT_LT(glm::length(glm::vec3(seen.front() - seen.back())), 25) << y;
  }
}

TEST_F(KelpRender, FitIsGreenYellowOrRed) {
  write(pack_, bytesOf(twoParts(skinOf("0.1", "2"))));
  const Picture good = picture({"--view", "fit"});
  EXPECT_TRUE(isGreen(good.at(60, 90)));
  EXPECT_TRUE(isYellow(good.at(60, 30)));
  write(pack_, bytesOf(twoParts(skinOf("6", "-1"))));
  const Picture poor = picture({"--view", "fit"});
  EXPECT_TRUE(isRed(poor.at(60, 90)));
  EXPECT_TRUE(isGrey(poor.at(60, 30)));
}

TEST_F(KelpRender, AnUnknownFitIsGrey) {
  for (const std::string skin : {R"(null)", R"({"parts":[{"fit":{"p95":1e999}}]})", R"({"parts":[7,[]]})"}) {
    write(pack_, bytesOf(twoParts(skin)));
    const Picture p = picture({"--view", "fit"});
    EXPECT_TRUE(isGrey(p.at(60, 90)) && isGrey(p.at(60, 30))) << skin;
  }
}

TEST_F(KelpRender, PartsLookTheSameWithOpenGlEs) {
  write(pack_, bytesOf(twoParts(skinOf("0.1", "2"))));
  const Picture desktop = picture({"--view", "fit"});
  // Mesa then refuses a context of OpenGL 3.3.
  const ProcessResult result =
      runProcess({"env", "MESA_GL_VERSION_OVERRIDE=3.2", KELP_RENDER, pack_, "-o", out_, "--size", "120x120",
                  "--yaw", "0", "--pitch", "0", "--background", "none", "--view", "fit"});
  ASSERT_EQ(result.exit, 0) << result.err;
  const Picture embedded(out_);
  for (const int y : {30, 90}) EXPECT_LT(glm::length(glm::vec3(embedded.at(60, y) - desktop.at(60, y))), 4);
}

TEST_F(KelpRender, ThePapersMethodDrawsNoParts) {
  for (const char* const view : {"parts", "fit"}) {
    const ProcessResult refused = render({pack_, "-o", out_, "--view", view, "--method", "paper"});
    EXPECT_EQ(refused.exit, 1);
    EXPECT_NE(refused.err.find(std::string("--view ") + view), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace kelp
