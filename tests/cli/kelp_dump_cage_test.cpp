// SPDX-License-Identifier: MIT
// kelp-dump on packs with cages: what info says, what the deep check finds, and what differs.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../formats/tiny_cage_pack.h"
#include "process.h"
#include "support/json_schema.h"
#include "support/random_pack.h"

namespace kelp {
namespace {

using nlohmann::json;

class KelpDumpCage : public testing::Test {
 protected:
  // A comb with three cages, and a block with an inside.
  static RawPack sound() {
    RawPack pack = test::makeTinyCagePack();
    pack.parts.erase(pack.parts.begin(), pack.parts.begin() + 2);
    pack.parts[1].parent = 0;
    test::addInfluences(pack.parts[1], 1, 2, 1);
    pack.clips.clear();
    pack.sockets.clear();
    return pack;
  }
  std::string write(const std::string& name, const RawPack& pack) const {
    return folder_.write(name, std::span<const std::byte>(test::writeToMemory(pack)));
  }
  // As JSON, checked against the schema.
  json run(std::vector<std::string> arguments, int exit) const {
    arguments.insert(arguments.begin(), KELP_DUMP);
    arguments.insert(arguments.end(), {"--format", "json"});
    const test::ProcessResult result = test::runProcess(arguments);
    EXPECT_EQ(result.exit, exit) << result.out << result.err;
    const json out = json::parse(result.out, nullptr, false);
    EXPECT_EQ(schema_.check(out), "") << result.out;
    return out;
  }
  // The deep check, and only it, finds a cage that does not fit its voxels, in this level.
  void expectDeepFinds(const RawPack& pack, int part, int level, const json& voxel) const {
    const std::string path = write("wrong.kelp", pack);
    run({"verify", path}, 0);
    const json report = run({"verify", path, "--deep"}, 3);
    ASSERT_GE(report["issues"].size(), 1u);
    for (const json& issue : report["issues"]) EXPECT_EQ(issue["id"], 510) << report;
    EXPECT_EQ(report["issues"][0]["part"], part);
    EXPECT_EQ(report["issues"][0]["level"], level);
    EXPECT_EQ(report["issues"][0]["voxel"], voxel);
  }

  test::Scratch folder_;
  test::JsonSchema schema_{std::string(KELP_SOURCE_DIR) + "/tools/kelp-dump/kelp-dump.schema.json"};
};

TEST_F(KelpDumpCage, TellsOfMorphTargets) {
  RawPack pack = test::makeTinyMorphPack();
  const std::string path = write("morphs.kelp", pack);
  const json info = run({"info", path}, 0);
  EXPECT_EQ(info["parts"][2]["cage"]["morphs"],
            json::array({{{"part", 3}, {"nodes", pack.parts[2].morphs[0].nodes.size()}},
                         {{"part", 4}, {"nodes", pack.parts[2].morphs[1].nodes.size()}}}));
  EXPECT_EQ(info["parts"][5]["cage"]["sections"], 4);
  run({"verify", path}, 0);
  pack.parts[2].morphs[1].offsets.back().z += 1;
  const json difference = run({"diff", path, write("other.kelp", pack)}, 7);
  EXPECT_EQ(difference["differences"][0]["text"], "cage: morph targets move other nodes, or otherwise");
}

TEST_F(KelpDumpCage, InfoSaysWhatThereIs) {
  const std::string path = write("sound.kelp", sound());
  const json info = run({"info", path}, 0);
  EXPECT_EQ(info["format"]["minor"], 3);
  const json& comb = info["parts"][0];
  EXPECT_EQ(comb["bend"], "cage");
  EXPECT_EQ(comb["cage"]["cell"], 4);
  EXPECT_EQ(comb["cage"]["spline"], "sweep");
  ASSERT_EQ(comb["cage"]["cages"].size(), 3u);
  EXPECT_FALSE(comb["cage"].contains("follows") || comb["cage"].contains("morphs"));
  EXPECT_EQ(info["parts"][1]["cage"]["follows"], json::array({0}));
  const test::NaiveCage naive({22, 13, 3}, 4, 1, test::isComb);
  const json& second = comb["cage"]["cages"][1];
  EXPECT_EQ(second["level"], 1);
  EXPECT_EQ(second["cell"], 8);
  EXPECT_EQ(second["cells"], naive.cells.size());
  EXPECT_EQ(second["nodes"], naive.nodes.size());
  EXPECT_EQ(second["pieces"], naive.raw.masks.size() / 8);
  EXPECT_GT(second["faces"], 0);
  EXPECT_GT(second["memory_bytes"], 48 * naive.cells.size());
  const test::ProcessResult text = test::runProcess({KELP_DUMP, "info", path});
  EXPECT_NE(text.out.find("; cells of 4; swept"), std::string::npos) << text.out;
}

TEST_F(KelpDumpCage, DeepFindsCagesThatDoNotFitTheVoxels) {
  run({"verify", write("sound.kelp", sound()), "--deep"}, 0);
  RawPack pack = sound();  // a cube less: its neighbors have boundary faces there
  pack.parts[1] = test::makeCagedPart({10, 10, 10}, 1, 2, [](const glm::ivec3& v) {
    return test::isBlock(v) && v / 2 != glm::ivec3(4, 3, 2);
  });
  pack.parts[1].levels = sound().parts[1].levels;
  expectDeepFinds(pack, 1, 0, {8, 6, 4});
  pack = sound();  // an inside that is hollow
  pack.parts[1].levels = test::levelsOf(
      {10, 10, 10}, 1, [](const glm::ivec3& v) { return test::isBlock(v) && v != glm::ivec3(4, 5, 4); });
  expectDeepFinds(pack, 1, 0, {4, 5, 4});
  pack = sound();  // a voxel of no piece, at level 1
  for (std::size_t bit = 0;; ++bit) {
    std::uint8_t& byte = pack.parts[0].cages[1].masks[bit / 8];
    if (!(byte >> bit % 8 & 1)) continue;
    byte = static_cast<std::uint8_t>(byte & ~(1u << bit % 8));
    break;
  }
  const std::string path = write("wrong.kelp", pack);
  const json report = run({"verify", path, "--deep"}, 3);
  ASSERT_EQ(report["issues"].size(), 1u);
  EXPECT_EQ(report["issues"][0]["level"], 1);
  EXPECT_EQ(report["issues"][0]["detail"], "a solid voxel is of no piece");
}

TEST_F(KelpDumpCage, DiffSaysWhichCagesDiffer) {
  const std::string path = write("a.kelp", sound());
  EXPECT_TRUE(run({"diff", path, path}, 0)["same"]);
  RawPack pack = sound();
  pack.parts[1].cages.clear();
  pack.parts[1].cell = 0;
  pack.parts[1].influences.clear();
  json found = run({"diff", path, write("b.kelp", pack)}, 7)["differences"];
  ASSERT_EQ(found.size(), 1u) << found;
  EXPECT_EQ(found[0]["kind"], "cage");
  EXPECT_EQ(found[0]["name"], "block");
  EXPECT_EQ(found[0]["b"], "no cage");
  pack = sound();
  pack.parts[0].cages[1].follows[0] ^= 1;
  found = run({"diff", path, write("c.kelp", pack)}, 7)["differences"];
  ASSERT_EQ(found.size(), 1u) << found;
  EXPECT_EQ(found[0]["text"], "cage: other cells, pieces or nodes for level 1");
  pack = sound();
  pack.parts[1].influences.clear();
  found = run({"diff", path, write("d.kelp", pack)}, 7)["differences"];
  ASSERT_EQ(found.size(), 1u) << found;
  EXPECT_EQ(found[0]["text"], "cage: nodes follow other parts, or by other weights");
}

}  // namespace
}  // namespace kelp
