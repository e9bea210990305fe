// SPDX-License-Identifier: MIT
// Files with skins, baked with the rig that was made of them, and with rigs that an artist changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "import_scratch.h"
#include "kelp/bake/bake.h"
#include "support/assets.h"

namespace kelp::bake {
namespace {

using SkinGroups = std::vector<RigDescription::SkinGroup>;

// The parts by INFO, one entry a part.
SkinGroups partsOfInfo(const RawPack& pack) {
  SkinGroups parts;
  const nlohmann::json info = nlohmann::json::parse(pack.info_json);
  for (const nlohmann::json& part : info.at("skin").at("parts"))
    parts.push_back({part.at("joints"), part.value("knots", 0), 1});
  return parts;
}

// As kelp-dump rig: rigid parts of one joint are pieces of one entry.
SkinGroups entriesOf(const SkinGroups& parts) {
  SkinGroups entries;
  for (const auto& part : parts) {
    const auto same = std::find_if(entries.begin(), entries.end(), [&](const auto& entry) {
      return part.knots == 0 && entry.knots == 0 && entry.joints == part.joints;
    });
    if (same == entries.end())
      entries.push_back(part);
    else
      ++same->pieces;
  }
  return entries;
}

class SkinRigFiles : public ::testing::Test {
 protected:
  RawPack baked(const std::filesystem::path& path, const SkinGroups& groups = {}) {
    Settings settings;
    settings.threads = 1;
    if (!groups.empty()) {
      RigDescription rig;
      rig.skin = groups;
      settings.rig_file = scratch.write("skin.rig.json", printRig(rig));
    }
    report = {};
    return bake(path, settings, report);
  }
  // Of the worst clip.
  Report::Fit worst() const {
    Report::Fit most;
    for (const Report::Clip& clip : report.clips)
      if (clip.fit.p95 > most.p95) most = clip.fit;
    return most;
  }
  std::vector<std::string> namesOfSwept() const {
    std::vector<std::string> names;
    for (const Report::Part& part : report.parts)
      if (part.swept) names.push_back(part.name);
    std::sort(names.begin(), names.end());
    return names;
  }
  // The rig that was made bakes to as many parts, the same swept ones, and nearly as good a fit.
  void expectTheSameAgain(const std::filesystem::path& path) {
    const RawPack before = baked(path);
    const Report::Fit fit = worst();
    const std::vector<std::string> swept = namesOfSwept();
    const SkinGroups entries = entriesOf(partsOfInfo(before));
    const RawPack after = baked(path, entries);
    EXPECT_EQ(after.parts.size(), before.parts.size());
    EXPECT_EQ(namesOfSwept(), swept);
    EXPECT_EQ(after.clips.size(), before.clips.size());
    EXPECT_LE(worst().mean, 1.1 * fit.mean);
    EXPECT_LE(worst().p95, 1.15 * fit.p95);
    for (const Report::Part& part : report.parts) EXPECT_EQ(part.rig_origin, "rig file skin.rig.json");
    for (const std::string& notice : report.notices)
      EXPECT_EQ(notice.find("/skin/parts"), std::string::npos) << notice;
    // INFO has that rig again.
    std::map<std::vector<std::string>, int> pieces;
    for (const auto& entry : entriesOf(partsOfInfo(after)))
      pieces[entry.joints] = 100 * entry.knots + entry.pieces;
    for (const auto& entry : entries) EXPECT_EQ(pieces[entry.joints], 100 * entry.knots + entry.pieces);
  }

  test::Scratch scratch;
  Report report;
};

TEST_F(SkinRigFiles, FoxAgain) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  expectTheSameAgain(path);
}

TEST_F(SkinRigFiles, GreenmanAgain) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  expectTheSameAgain(path);
}

TEST_F(SkinRigFiles, AFoxThatAnArtistChanged) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const SkinGroups wanted{
      {{"b_Hip_01", "b_Spine01_02"}, 0, 4},                                // joined, and cut otherwise
      {{"b_Tail01_012", "b_Tail02_013", "b_Tail03_014"}, 4, 1},            // fewer knots
      {{"b_Neck_04", "b_Head_05"}, 0, 1},                                  // joined
      {{"b_LeftLeg01_015", "b_LeftLeg02_016", "b_LeftFoot01_017"}, 0, 2},  // joined, two pieces
      {{"b_RightLeg01_019"}, 0, 1},
      {{"b_RightLeg02_020"}, 0, 1},  // split
      {{"b_RightUpperArm_06"}, 0, 1},
      {{"b_LeftUpperArm_09"}, 0, 1}};
  const RawPack pack = baked(path, wanted);
  EXPECT_EQ(entriesOf(partsOfInfo(pack)).size(), wanted.size());
  for (const auto& entry : entriesOf(partsOfInfo(pack)))
    EXPECT_NE(std::find(wanted.begin(), wanted.end(), entry), wanted.end()) << entry.joints.front();
  EXPECT_EQ(pack.parts.size(), 12u);
  EXPECT_EQ(namesOfSwept(), std::vector<std::string>{"b_Tail01_012"});
  for (const RawPart& part : pack.parts)
    if (part.name == "b_Tail01_012") {
      EXPECT_EQ(part.knots.size(), 4u);
    }
  EXPECT_EQ(pack.clips.size(), 3u);
}

}  // namespace
}  // namespace kelp::bake
