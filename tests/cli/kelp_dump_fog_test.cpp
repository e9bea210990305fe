// SPDX-License-Identifier: MIT
// kelp-dump on packs of fog: what info counts, and every kind of falsehood that verify --deep must find.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "process.h"
#include "support/fog_pack.h"
#include "support/json_schema.h"

namespace kelp {
namespace {

using nlohmann::json;
using test::ProcessResult;

double coreHeat(const glm::dvec3& p) {
  return std::clamp(1 - 5 * glm::distance(p, glm::dvec3(0.5, 0.3, 0.5)), 0.0, 1.0);
}

const glm::ivec3 kSize(61, 70, 47);

fields::FogSamples glowingPuffs() { return test::fogOf(kSize, test::puffs, coreHeat); }

class KelpDumpFog : public testing::Test {
 protected:
  std::string path() const { return folder_ / "fog.kelp"; }
  void write(const RawPack& pack) {
    const std::vector<std::byte> bytes = test::bytesOf(pack);
    std::ofstream(path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  // A sub-command and its options, on the pack.
  ProcessResult dump(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KELP_DUMP);
    arguments.push_back(path());
    return test::runProcess(arguments);
  }
  json dumpJson(std::vector<std::string> arguments, int exit) {
    arguments.insert(arguments.end(), {"--format", "json"});
    const ProcessResult result = dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.out << result.err;
    EXPECT_EQ(result.err, "");
    const json report = json::parse(result.out, nullptr, false);
    EXPECT_EQ(schema_.check(report), "") << result.out;
    return report;
  }
  void expectSound(const RawPack& pack) {
    write(pack);
    EXPECT_TRUE(dumpJson({"verify", "--deep"}, 0).at("sound").get<bool>());
  }
  // The deep check, and only it, finds exactly this; answers the first.
  json onlyDeepFinds(const RawPack& pack, const std::vector<int>& ids) {
    write(pack);
    EXPECT_TRUE(dumpJson({"verify"}, 0).at("sound").get<bool>());
    const json report = dumpJson({"verify", "--deep"}, 3);
    std::vector<int> found;
    for (const json& issue : report.at("issues")) found.push_back(issue.at("id"));
    EXPECT_EQ(found, ids) << report.dump(1);
    return report.at("issues").empty() ? json() : report.at("issues").at(0);
  }

  test::Scratch folder_;
  test::JsonSchema schema_{std::string(KELP_SOURCE_DIR) + "/tools/kelp-dump/kelp-dump.schema.json"};
};

// Of dense samples: cubes with anything at a corner.
std::uint64_t cubesNotClear(const fields::FogSamples& fog) {
  const auto at = [&](const glm::ivec3& v) {
    const auto i = static_cast<std::size_t>(v.x + fog.size.x * (v.y + fog.size.y * v.z));
    return fog.density[i] != 0 || (!fog.heat.empty() && fog.heat[i] != 0);
  };
  std::uint64_t count = 0;
  for (int z = 0; z + 1 < fog.size.z; ++z) {
    for (int y = 0; y + 1 < fog.size.y; ++y) {
      for (int x = 0; x + 1 < fog.size.x; ++x) {
        bool any = false;
        for (int c = 0; c < 8; ++c) any = any || at({x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)});
        count += any;
      }
    }
  }
  return count;
}

TEST_F(KelpDumpFog, InfoCountsWhatIsThere) {
  const fields::FogSamples fog = glowingPuffs();
  RawPack pack = test::fogPack(fog, 0.5f);
  pack.parts[0].fog->anisotropy = 0.25f;
  write(pack);
  const json info = dumpJson({"info", "--count"}, 0);
  EXPECT_EQ(info["format"], json({{"major", 1}, {"minor", 0}}));
  const json& part = info["parts"][0];
  EXPECT_EQ(part["kind"], "fog");
  EXPECT_EQ(part["size"], json({61, 70, 47}));
  EXPECT_EQ(part["fog"]["color"], json({0.9f, 0.8f, 0.7f}));
  EXPECT_EQ(part["fog"]["hex"], "#f3e7da");
  EXPECT_EQ(part["fog"]["anisotropy"], 0.25);
  EXPECT_EQ(part["fog"]["glow"], 0.5);
  EXPECT_EQ(part["fog"]["ramp"], json({{0, 0, 0}, {0.6f, 0.1f, 0}, {1, 0.8f, 0.3f}}));
  ASSERT_EQ(part["levels"].size(), 5u);
  const json& level = part["levels"][0];
  EXPECT_EQ(level["size"], json({61, 70, 47}));
  EXPECT_EQ(level["cells"], 8 * 9 * 6);  // 60 x 69 x 46 cubes
  EXPECT_EQ(level["cubes"], 60 * 69 * 46);
  EXPECT_EQ(level["cubes_not_clear"], cubesNotClear(fog));
  EXPECT_EQ(level["extinction"], 0.5);
  EXPECT_EQ(level["solid_voxels"], 0);
  EXPECT_EQ(part["levels"][1]["size"], json({31, 35, 24}));
  EXPECT_LT(part["levels"][1]["extinction"], 0.5);
  std::uint64_t stored = 0, bricks = 0;
  for (const json& l : part["levels"]) bricks += l["bricks"].get<std::uint64_t>();
  for (const json& chunk : info["chunks"]) {
    stored += chunk["stored_bytes"].get<std::uint64_t>();
    if (chunk["kind"] == "FOGB") {
      EXPECT_EQ(chunk["decoded_bytes"], bricks * 2 * 729);
    }
    EXPECT_NE(chunk["kind"], "BRCK");
  }
  EXPECT_EQ(stored, std::filesystem::file_size(path()));

  const ProcessResult text = dump({"info", "--count"});
  for (const char* words :
       {"format 1.0", "part (fog): 61 x 70 x 47 voxels",
        "fog of #f3e7da, anisotropy 0.25; glow 0.5 in 3 colors from 0 0 0 to 1 0.8 0.3", "not clear", "FOGB"})
    EXPECT_NE(text.out.find(words), std::string::npos) << "'" << words << "' is not in:\n" << text.out;

  write(test::fogPack(test::fogOf(kSize, test::puffs), 0.5f));
  EXPECT_EQ(dumpJson({"info"}, 0)["parts"][0]["fog"]["ramp"], json::array());
  EXPECT_NE(dump({"info"}).out.find("; no heat"), std::string::npos);
}

TEST_F(KelpDumpFog, VerifyAcceptsSoundPacks) {
  expectSound(test::fogPack(glowingPuffs(), 0.5f));
  expectSound(test::fogPack(test::fogOf(kSize, test::puffs), 2.0f));
  // Heat without density, which leaves levels without a greatest density.
  expectSound(test::fogPack(test::fogOf(
                                kSize, [](const glm::dvec3&) { return 0.0; }, coreHeat),
                            0.5f));
  for (const glm::ivec3& size :
       {glm::ivec3(1, 1, 1), glm::ivec3(1, 40, 9), glm::ivec3(33, 1, 17), glm::ivec3(10, 18, 1)})
    expectSound(test::fogPack(
        test::fogOf(
            size, [](const glm::dvec3& p) { return p.y; }, [](const glm::dvec3& p) { return 1 - p.y; }),
        1.0f));
  // Beside a solid part.
  RawPack both = test::fogPack(glowingPuffs(), 0.5f);
  fields::Occupancy block{{9, 20, 11}, std::vector<std::uint8_t>(9 * 20 * 11, 1)};
  RawPack solid = test::packOf(block);
  solid.parts[0].levels.resize(1);
  both.parts.push_back(solid.parts[0]);
  expectSound(both);
}

TEST_F(KelpDumpFog, DeepFindsClearancesThatAreOneOff) {
  const RawPack sound = test::fogPack(glowingPuffs(), 0.5f);
  for (const int change : {1, -1}) {
    RawPack pack = sound;
    auto& cells = pack.parts[0].levels[0].cells;
    const auto empty = std::find_if(cells.begin(), cells.end(), [&](std::uint32_t cell) {
      return !(cell & kCellSolid) && cellClearance(cell) > 0 && cellClearance(cell) < 127;
    });
    ASSERT_NE(empty, cells.end());
    *empty += static_cast<std::uint32_t>(change) << kCellClearanceShift;
    const json issue = onlyDeepFinds(pack, {change > 0 ? 500 : 501});
    const auto index = static_cast<int>(empty - cells.begin());
    EXPECT_EQ(issue["brick"], json({index % 8, index / 8 % 9, index / 72}));
  }
}

// Sample `index` of the first stored brick, by slot, where it is not 0.
std::size_t findSample(const std::vector<std::uint8_t>& samples, std::size_t index) {
  for (std::size_t at = index; at < samples.size(); at += kFogSamples)
    if (samples[at] != 0) return at;
  ADD_FAILURE() << "no such sample";
  return index;
}

TEST_F(KelpDumpFog, DeepFindsSamplesThatAreNotTheMean) {
  const RawPack sound = test::fogPack(glowingPuffs(), 0.5f);
  constexpr std::size_t kInner = 3 + 9 * 2 + 81 * 1;  // in no other brick
  // In the coarsest level, which has one brick, so that no other level is made of it.
  RawPack pack = sound;
  const int right = pack.parts[0].levels.back().density[kInner]++;
  json issue = onlyDeepFinds(pack, {506});
  EXPECT_EQ(issue["level"], 4);
  EXPECT_EQ(issue["count"], 1);
  EXPECT_EQ(issue["voxel"], json({3, 2, 1}));
  EXPECT_EQ(issue["brick"], json({0, 0, 0}));
  EXPECT_EQ(issue["detail"],
            "density " + std::to_string(right + 1) + " stored, " + std::to_string(right) + " is right");
  pack = sound;
  pack.parts[0].levels.back().heat[kInner] ^= 4;
  issue = onlyDeepFinds(pack, {506});
  EXPECT_EQ(issue["detail"].get<std::string>().find("heat "), 0u) << issue;
  // In the finest: the level above it is then not its mean.
  pack = sound;
  auto& density = pack.parts[0].levels[0].density;
  density[findSample(density, kInner)] ^= 0x40;
  EXPECT_EQ(onlyDeepFinds(pack, {506})["level"], 1);
  // Between: wrong itself, and the next above it is not its mean.
  pack = sound;
  auto& middle = pack.parts[0].levels[2].density;
  middle[findSample(middle, 5 + 9 * 4 + 81 * 5)] ^= 0x40;
  EXPECT_EQ(onlyDeepFinds(pack, {506, 506})["level"], 2);
}

TEST_F(KelpDumpFog, DeepFindsAWrongExtinction) {
  RawPack pack = test::fogPack(glowingPuffs(), 0.5f);
  float& extinction = pack.parts[0].levels.back().extinction;
  const float right = extinction;
  extinction = std::nextafter(extinction, 1.0f);
  expectSound(pack);  // another way to the same mean
  extinction = right * 1.001f;
  const json issue = onlyDeepFinds(pack, {507});
  EXPECT_EQ(issue["level"], 4);
  EXPECT_FALSE(issue.contains("voxel"));
  EXPECT_NE(issue["detail"].get<std::string>().find("is right"), std::string::npos);
}

TEST_F(KelpDumpFog, DeepFindsBricksThatDisagree) {
  const RawPack sound = test::fogPack(glowingPuffs(), 0.5f);
  for (const bool heat : {false, true}) {
    RawPack pack = sound;
    auto& samples = heat ? pack.parts[0].levels[0].heat : pack.parts[0].levels[0].density;
    samples[findSample(samples, 0)] ^= 0x80;  // the corner that eight bricks share
    const json issue = onlyDeepFinds(pack, {508});
    EXPECT_EQ(issue["level"], 0);
    EXPECT_GE(issue["count"], 1);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(issue["voxel"][static_cast<std::size_t>(axis)].get<int>() % 8, 0);
    EXPECT_EQ(issue["detail"], "a neighbor holds another value");
  }
}

TEST_F(KelpDumpFog, DeepFindsABrickThatIsMissing) {
  RawPack pack = test::fogPack(glowingPuffs(), 0.5f);
  RawLevel& level = pack.parts[0].levels[0];
  // The last brick that shares fog with another at its first corner.
  std::size_t slot = level.density.size() / kFogSamples;
  while (level.density[--slot * kFogSamples] == 0) {
  }
  for (std::uint32_t& cell : level.cells) {
    if (!(cell & kCellSolid)) continue;
    if ((cell & kCellSlotMask) == slot)
      cell = 0;
    else if ((cell & kCellSlotMask) > slot)
      --cell;
  }
  for (auto* channel : {&level.density, &level.heat}) {
    const auto first = channel->begin() + static_cast<std::ptrdiff_t>(slot * kFogSamples);
    channel->erase(first, first + kFogSamples);
  }
  const json issue = onlyDeepFinds(pack, {508});
  EXPECT_EQ(issue["detail"], "the brick is empty, and a neighbor holds fog at its edge");
}

}  // namespace
}  // namespace kelp
