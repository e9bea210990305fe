// SPDX-License-Identifier: MIT
// kelp-dump as a user runs it: packs that are sound, packs with every kind of damage, and files that are no
// packs.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "../formats/pack_surgeon.h"
#include "kelp/fields/fields.h"
#include "kelp/formats/raw_pack.h"
#include "kelp/rig/rig_file.h"
#include "process.h"
#include "support/json_schema.h"
#include "support/random_pack.h"
#include "support/surface_above.h"

namespace kelp {
namespace {

using nlohmann::json;
using test::ProcessResult;

ProcessResult dump(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KELP_DUMP);
  return test::runProcess(arguments);
}

void write(const std::string& path, const std::vector<std::byte>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

// A blob with a hole and an antenna, off the corner of its volume, so that there are empty bricks, inner
// voxels and thin things.
fields::Occupancy blob() {
  fields::Occupancy volume{{45, 62, 38}, {}};
  volume.solid.resize(45 * 62 * 38);
  for (int z = 0; z < 38; ++z) {
    for (int y = 0; y < 62; ++y) {
      for (int x = 0; x < 45; ++x) {
        const int d = (x - 17) * (x - 17) + (y - 20) * (y - 20) + (z - 18) * (z - 18);
        const bool hole = (x - 17) * (x - 17) + (z - 18) * (z - 18) < 9;
        const bool antenna = x == 17 && z == 30 && y > 20 && y < 60;
        volume.solid[volume.index({x, y, z})] = (d < 15 * 15 && !hole) || antenna;
      }
    }
  }
  return volume;
}

std::vector<fields::SurfaceVoxel> withAttributes(const std::vector<std::uint64_t>& indices) {
  std::vector<fields::SurfaceVoxel> surface;
  for (const std::uint64_t i : indices)
    surface.push_back({i, makeAttribute(static_cast<std::uint8_t>(i % 3),
                                        encodeNormal({1, static_cast<float>(i % 7), 0}))});
  return surface;
}

// Chooses each level's voxels and surface; the tests tamper with either.
struct Level {
  fields::Occupancy occupancy;
  std::vector<std::uint64_t> surface;
};

std::vector<Level> levelsOf(const fields::Occupancy& volume, int count) {
  std::vector<Level> levels{{volume, fields::surfaceVoxels(volume, 1)}};
  while (static_cast<int>(levels.size()) < count) {
    const Level& finer = levels.back();
    Level next{fields::coarser(finer.occupancy), {}};
    next.surface = test::surfaceAbove(finer.surface, finer.occupancy.size);
    levels.push_back(next);
  }
  return levels;
}

RawPart partOf(const std::vector<Level>& levels, const RigDescription& rig, const std::string& name) {
  RawPart part;
  part.name = name;
  part.size = levels[0].occupancy.size;
  part.to_object =
      glm::mat4x3(glm::vec3(0.01f, 0, 0), glm::vec3(0, 0.01f, 0), glm::vec3(0, 0, 0.01f), glm::vec3(0, 0, 0));
  part.knots = realizeKnots(rig);
  part.automatic_tangents = automaticTangents(rig);
  for (const Level& level : levels)
    part.levels.push_back(fields::buildLevel(level.occupancy, withAttributes(level.surface), 1));
  return part;
}

RawPack packOf(const std::vector<Level>& levels) {
  const RigDescription rig = *presetRig("sway");
  RawPack pack;
  pack.info_json =
      R"({"tool": "kelp-bake 0.1.0", "source": {"name": "blob.glb", "format": "glTF 2.0"}, "options": {"resolution": 64}})";
  pack.palette.resize(3);
  pack.palette[0].base_color = {1, 0, 0, 1};
  pack.palette[1].base_color = {0, 0.2158605f, 0, 1};
  pack.parts = {partOf(levels, rig, "blob"), partOf(levelsOf(blob(), 2), rig, "twin")};
  pack.clips = realizeClips(rig, 0);
  return pack;
}

class KelpDump : public testing::Test {
 protected:
  std::string path() const { return folder_ / "blob.kelp"; }
  void writePack(const RawPack& pack) { write(path(), test::writeToMemory(pack)); }

  // verify as JSON, checked against the schema; expects the exit code.
  json verify(bool deep, int exit) {
    std::vector<std::string> arguments{"verify", path(), "--format", "json"};
    if (deep) arguments.push_back("--deep");
    const ProcessResult result = dump(arguments);
    EXPECT_EQ(result.exit, exit) << result.out << result.err;
    EXPECT_EQ(result.err, "");
    const json report = json::parse(result.out, nullptr, false);
    EXPECT_EQ(schema_.check(report), "") << result.out;
    return report;
  }
  // The deep check, and only it, finds exactly this.
  json onlyDeepFinds(const RawPack& pack, const std::vector<int>& ids) {
    writePack(pack);
    EXPECT_TRUE(verify(false, 0).at("sound").get<bool>());
    const json report = verify(true, 3);
    std::vector<int> found;
    for (const json& issue : report.at("issues")) found.push_back(issue.at("id"));
    EXPECT_EQ(found, ids) << report.dump(1);
    return report.at("issues").at(0);
  }

  test::Scratch folder_;
  test::JsonSchema schema_{std::string(KELP_SOURCE_DIR) + "/tools/kelp-dump/kelp-dump.schema.json"};
};

TEST_F(KelpDump, InfoCountsWhatIsThere) {
  const auto levels = levelsOf(blob(), 3);
  writePack(packOf(levels));
  const ProcessResult result = dump({"info", path(), "--count", "--format", "json"});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json info = json::parse(result.out);
  EXPECT_EQ(schema_.check(info), "");
  EXPECT_EQ(info["schema"], "kelp-dump/1");
  EXPECT_EQ(info["file_bytes"], std::filesystem::file_size(path()));
  EXPECT_EQ(info["info"]["source"]["name"], "blob.glb");
  ASSERT_EQ(info["parts"].size(), 2u);
  const json& part = info["parts"][0];
  EXPECT_EQ(part["name"], "blob");
  EXPECT_EQ(part["size"], json({45, 62, 38}));
  EXPECT_NEAR(part["voxel_metres"][1].get<double>(), 0.01, 1e-6);
  EXPECT_EQ(part["knots"].size(), 2u);
  ASSERT_EQ(part["levels"].size(), 3u);
  std::uint64_t palette[3] = {};
  for (std::size_t l = 0; l < 3; ++l) {
    const auto& solid = levels[l].occupancy.solid;
    EXPECT_EQ(part["levels"][l]["solid_voxels"], std::count(solid.begin(), solid.end(), 1));
    EXPECT_EQ(part["levels"][l]["surface_voxels"], levels[l].surface.size());
  }
  for (const std::uint64_t i : levels[0].surface) palette[i % 3] += 2;  // the twin has the same level 0
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(info["palette"][i]["surface_voxels"], palette[i]);
  EXPECT_EQ(info["palette"][0]["hex"], "#ff0000");
  EXPECT_EQ(info["palette"][1]["hex"], "#008000");
  EXPECT_EQ(info["clips"][0]["name"], "sway");
  EXPECT_EQ(info["clips"][0]["duration"], 15);
  EXPECT_EQ(info["clips"][0]["parts"], json::array({0}));
  std::uint64_t stored = 0;
  for (const json& chunk : info["chunks"]) stored += chunk["stored_bytes"].get<std::uint64_t>();
  EXPECT_EQ(stored, info["file_bytes"]);
  // Pages are frames of their own: decoded, they hold 512 codes a brick and 4 bytes a surface voxel.
  std::uint64_t pages = 0;
  for (const json& some : info["parts"]) {
    for (const json& level : some["levels"])
      pages += 512 * level["bricks"].get<std::uint64_t>() + 4 * level["surface_voxels"].get<std::uint64_t>();
  }
  for (const json& chunk : info["chunks"]) {
    if (chunk["kind"] == "BRCK") {
      EXPECT_EQ(chunk["decoded_bytes"], pages);
    }
  }
}

TEST_F(KelpDump, InfoTextFitsAScreenAndHasNoColorOffATerminal) {
  writePack(packOf(levelsOf(blob(), 3)));
  const ProcessResult result = dump({"info", path()});
  EXPECT_EQ(result.exit, 0) << result.err;
  for (const char* words : {"blob.kelp", "kelp-bake 0.1.0", "name blob.glb", "45 x 62 x 38 voxels of 10 mm",
                            "sway", "15 s", "#ff0000", "BRCK", "GRID", "total"})
    EXPECT_NE(result.out.find(words), std::string::npos) << "'" << words << "' is not in:\n" << result.out;
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
  EXPECT_LT(std::count(result.out.begin(), result.out.end(), '\n'), 40);
}

TEST_F(KelpDump, InfoLeavesOutWhatSaysNothing) {
  RawPack pack = packOf(levelsOf(blob(), 3));
  pack.info_json =
      R"({"tool": "t", "skin": {"rigs": []}, "files": {}, "options": {"list": [], "nothing": null}})";
  writePack(pack);
  const std::string out = dump({"info", path()}).out;
  for (const char* words : {"rigs []", "  skin", "  files", "list"})
    EXPECT_EQ(out.find(words), std::string::npos) << words;
  EXPECT_NE(out.find("  options  nothing null\n"), std::string::npos) << out;
}

TEST_F(KelpDump, NamesFromAPackDoNotReachTheTerminalRaw) {
  RawPack pack = packOf(levelsOf(blob(), 1));
  pack.info_json = "{\"tool\": \"evil \\u001b[2J \xc2\x9b 31m\", \"deep\": " + std::string(5000, '[') +
                   std::string(5000, ']') + "}";
  writePack(pack);
  ProcessResult result = dump({"info", path()});
  EXPECT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.out.find("evil"), std::string::npos);  // nested too deeply to be shown at all
  pack.info_json = "{\"tool\": \"evil\"";
  for (int i = 0; i < 200000; ++i) pack.info_json += ",\"k" + std::to_string(i) + "\":0";
  pack.info_json += "}";
  writePack(pack);
  result = dump({"info", path()});
  EXPECT_EQ(result.exit, 0) << result.err;
  // nor where it has more keys than can be looked through
  EXPECT_EQ(result.out.find("evil"), std::string::npos);
  pack.info_json = "{\"tool\": \"evil \\u001b[2J \xc2\x9b 31m\"}";
  writePack(pack);
  result = dump({"info", path()});
  EXPECT_NE(result.out.find("evil ?[2J ? 31m"), std::string::npos) << result.out;
  pack.info_json = "no JSON at all";
  writePack(pack);
  EXPECT_EQ(dump({"info", path()}).exit, 0);
  EXPECT_EQ(json::parse(dump({"info", path(), "--format", "json"}).out)["info"], json(nullptr));
}

TEST_F(KelpDump, NamesOfFilesDoNotReachTheTerminalRaw) {
  writePack(packOf(levelsOf(blob(), 1)));
  const std::filesystem::path evil = std::filesystem::path(path()).replace_filename("t\x1b[31m\xc2\x9b.kelp");
  std::filesystem::copy_file(path(), evil);
  for (const std::vector<std::string>& command : {std::vector<std::string>{"info", evil.string()},
                                                  {"verify", evil.string()},
                                                  {"diff", evil.string(), evil.string()},
                                                  {"rig", evil.string()},
                                                  {"info", evil.string() + ".none"}}) {
    const ProcessResult result = dump(command);
    EXPECT_EQ(result.exit, command[1] == evil.string() ? 0 : 2) << result.err;
    EXPECT_EQ((result.out + result.err).find_first_of("\x1b\x9b"), std::string::npos) << result.out;
  }
}

TEST_F(KelpDump, RigPrintsWhatTheBakerReads) {
  writePack(packOf(levelsOf(blob(), 1)));
  ProcessResult result = dump({"rig", path()});
  EXPECT_EQ(result.exit, 0);
  EXPECT_EQ(result.err, "");
  const RigFile file = parseRigFile(result.out);
  ASSERT_EQ(file.parts.size(), 2u);
  EXPECT_EQ(file.parts[0].name, "blob");
  EXPECT_EQ(file.parts[1].name, "twin");
  result = dump({"rig", path(), "--axis", "+y"});
  EXPECT_NE(result.err.find("has 2 parts, this is part 0 'blob'"), std::string::npos) << result.err;
  const RigDescription rig = parseRig(result.out);
  EXPECT_EQ(file.parts[0].rig, rig);
  ASSERT_EQ(rig.clips.size(), 1u);
  EXPECT_EQ(rig.clips[0].waves.size(), 5u);
  EXPECT_FLOAT_EQ(rig.clips[0].waves[0].amplitude.x, 0.11f);
  for (const char* name : {"twin", "1"}) {
    result = dump({"rig", path(), "--part", name});
    EXPECT_EQ(result.err, "");
    EXPECT_TRUE(parseRig(result.out).clips.empty());
  }
  result = dump({"rig", path(), "--part", "tail"});
  EXPECT_EQ(result.exit, 1);
  EXPECT_NE(result.err.find("0 'blob', 1 'twin'"), std::string::npos) << result.err;
}

TEST_F(KelpDump, VerifyAcceptsSoundPacks) {
  writePack(packOf(levelsOf(blob(), 4)));
  EXPECT_EQ(verify(false, 0)["errors"], 0);
  const json report = verify(true, 0);
  EXPECT_TRUE(report["sound"].get<bool>());
  EXPECT_EQ(report["parts"], 2);
  EXPECT_EQ(report["levels"], 6);
  const ProcessResult text = dump({"verify", path(), "--deep"});
  EXPECT_EQ(text.exit, 0);
  EXPECT_NE(text.out.find("blob.kelp: sound (2 parts, 6 levels, clearances and levels recomputed)"),
            std::string::npos)
      << text.out;
}

// One voxel more would be kept if it could be; one less is true but not the best.
TEST_F(KelpDump, DeepFindsClearancesThatAreOneOff) {
  const auto levels = levelsOf(blob(), 3);
  for (const int change : {1, -1}) {
    RawPack pack = packOf(levels);
    auto& cells = pack.parts[1].levels[0].cells;
    const auto empty = std::find_if(cells.begin(), cells.end(), [&](std::uint32_t cell) {
      return !(cell & kCellSolid) && cellClearance(cell) > 0 && cellClearance(cell) < 127;
    });
    ASSERT_NE(empty, cells.end());
    const int right = cellClearance(*empty);
    *empty += static_cast<std::uint32_t>(change) << kCellClearanceShift;
    const json issue = onlyDeepFinds(pack, {change > 0 ? 500 : 501});
    const auto index = static_cast<int>(empty - cells.begin());
    const glm::ivec3 grid = brickGrid({45, 62, 38});
    EXPECT_EQ(issue["brick"], json({index % grid.x, index / grid.x % grid.y, index / grid.x / grid.y}));
    EXPECT_FALSE(issue.contains("voxel"));
    EXPECT_EQ(issue["part"], 1);
    EXPECT_EQ(issue["part_name"], "twin");
    EXPECT_EQ(issue["level"], 0);
    EXPECT_EQ(issue["count"], 1);
    const std::string detail =
        "clearance of " + std::to_string(right + change) + " stored, " + std::to_string(right) + " is right";
    EXPECT_EQ(issue["detail"], detail);
    const ProcessResult text = dump({"verify", path(), "--deep"});
    EXPECT_EQ(text.out.find(path() + (change > 0 ? ": error 500" : ": error 501") +
                            ": part 1 'twin', level 0, brick ("),
              0u)
        << text.out;
    EXPECT_NE(text.out.find(detail + ". A cell promises"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("1 error"), std::string::npos) << text.out;
  }
}

// A full block has bricks that are inside, 27 of them in the finest level and one in the next.
TEST_F(KelpDump, DeepFindsBricksThatAreInsideOfOneLevelAlone) {
  const fields::Occupancy block{glm::ivec3(40), std::vector<std::uint8_t>(40 * 40 * 40, 1)};
  const RawPack sound = packOf(levelsOf(block, 2));
  ASSERT_EQ(
      std::count(sound.parts[0].levels[0].cells.begin(), sound.parts[0].levels[0].cells.end(), kCellInside),
      27);
  ASSERT_EQ(sound.parts[0].levels[1].cells[13], kCellInside);
  writePack(sound);
  verify(true, 0);
  const auto found = [&](const RawPack& pack, int id) {
    writePack(pack);
    verify(false, 0);
    const json issues = verify(true, 3)["issues"];
    for (const json& issue : issues)
      if (issue["id"] == id) return issue;
    ADD_FAILURE() << issues.dump(1);
    return json();
  };
  RawPack pack = sound;
  pack.parts[0].levels[1].cells[13] = 0;  // empty
  json issue = found(pack, 502);
  EXPECT_EQ(issue["level"], 1);
  EXPECT_EQ(issue["count"], 512);
  EXPECT_EQ(issue["voxel"], json({8, 8, 8}));
  pack = sound;
  for (int i = 0; i < 8; ++i)  // the eight below it
    pack.parts[0]
        .levels[0]
        .cells[static_cast<std::size_t>(2 + i % 2 + 5 * (2 + i / 2 % 2) + 25 * (2 + i / 4))] = 0;
  issue = found(pack, 503);
  EXPECT_EQ(issue["level"], 1);
  EXPECT_EQ(issue["count"], 512);
  issue = found(pack, 504);  // what is around the hole has become surface
  EXPECT_EQ(issue["level"], 0);
}

TEST_F(KelpDump, DeepFindsASurfaceVoxelThatIsNone) {
  auto levels = levelsOf(blob(), 2);
  Level& finest = levels[0];
  const glm::ivec3 size = finest.occupancy.size;
  std::size_t inner = 0;  // beside surface: the coarser level knows of no other
  while (!finest.occupancy.solid[inner] ||
         std::binary_search(finest.surface.begin(), finest.surface.end(), inner) ||
         !std::binary_search(levels[1].surface.begin(), levels[1].surface.end(),
                             denseIndex(levelSize(size, 1), voxelAt(size, inner) / 2)))
    ASSERT_LT(++inner, finest.occupancy.solid.size());
  finest.surface.insert(std::lower_bound(finest.surface.begin(), finest.surface.end(), inner), inner);
  const json issue = onlyDeepFinds(packOf(levels), {505});
  EXPECT_EQ(issue["level"], 0);
  EXPECT_EQ(issue["count"], 1);
  const glm::ivec3 voxel = voxelAt(size, inner);
  EXPECT_EQ(issue["voxel"], json({voxel.x, voxel.y, voxel.z}));
}

TEST_F(KelpDump, VerifySaysWhichKnotFolds) {
  test::PackSurgeon surgeon(test::writeToMemory(packOf(levelsOf(blob(), 2))));
  test::Bytes& rigs = surgeon.content("RIGS");
  test::set(rigs, 8 + 24 + 16, std::uint32_t{1});            // the second part is swept,
  test::set(rigs, 8 + 2 * 24 + 3 * 28 + 12 + 4 + 4, -1.0f);  // and its second tangent points back
  write(path(), surgeon.build());
  const json issue = verify(false, 3)["issues"][0];
  EXPECT_EQ(issue["id"], 302);
  EXPECT_EQ(issue["part"], 1);
  EXPECT_EQ(issue["knot"], 0);
  const ProcessResult text = dump({"verify", path()});
  EXPECT_NE(text.out.find("part 1, knot 0: "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("too sharply"), std::string::npos) << text.out;
}

TEST_F(KelpDump, EveryFlippedByteIsFound) {
  const auto bytes = test::writeToMemory(packOf(levelsOf(blob(), 2)));
  int found = 0;
  for (std::size_t i = 0; i < bytes.size(); i += i < 64 ? 3 : std::max<std::size_t>(1, bytes.size() / 60)) {
    auto flipped = bytes;
    flipped[i] ^= std::byte{1};
    write(path(), flipped);
    const ProcessResult result = dump({"verify", path()});
    EXPECT_TRUE(result.exit == 3 || result.exit == 5) << i << ": " << result.exit << result.out << result.err;
    EXPECT_NE(result.out.find("error "), std::string::npos) << result.out;
    ++found;
  }
  EXPECT_GT(found, 60);
}

TEST_F(KelpDump, ADamagedPageIsFoundByWhatReadsIt) {
  auto bytes = test::writeToMemory(packOf(levelsOf(blob(), 2)));
  bytes[bytes.size() - 70] ^= std::byte{1};  // in the last page of bricks
  write(path(), bytes);
  EXPECT_EQ(dump({"info", path()}).exit, 0);  // which does not look there
  const ProcessResult result = dump({"info", path(), "--count"});
  EXPECT_EQ(result.exit, 3);
  for (const char* words : {"part 1 'twin', level 0", "byte ", "checksum", "copy or bake it again"})
    EXPECT_NE(result.err.find(words), std::string::npos) << "'" << words << "' is not in: " << result.err;
}

}  // namespace
}  // namespace kelp
