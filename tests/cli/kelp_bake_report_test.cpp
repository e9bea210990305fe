// SPDX-License-Identifier: MIT
// kelp-bake --report: its published schema, and its numbers against meshes whose faults are known by
// construction.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "process.h"
#include "support/assets.h"
#include "support/json_schema.h"

namespace kelp::test {
namespace {

using nlohmann::json;

// A cube of eight corners and twelve triangles, wound outward; face `i` is two of them.
const std::vector<std::array<int, 3>> kCube = {{1, 4, 3}, {1, 3, 2}, {5, 6, 7}, {5, 7, 8},
                                               {1, 2, 6}, {1, 6, 5}, {4, 8, 7}, {4, 7, 3},
                                               {1, 5, 8}, {1, 8, 4}, {2, 3, 7}, {2, 7, 6}};
const char* const kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";

std::string objOf(const std::vector<std::array<int, 3>>& faces, const std::string& more = "") {
  std::string text = kCorners + more;
  for (const auto& f : faces)
    text += "f " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  return text;
}

class KelpBakeReport : public testing::Test {
 protected:
  // The report of a bake that must succeed, checked against the schema.
  json report(const std::string& input, const std::vector<std::string>& more = {}) {
    return reportAtOwnResolution(input, more, {"--resolution", "32"});
  }
  json reportAtOwnResolution(const std::string& input, const std::vector<std::string>& more = {},
                             const std::vector<std::string>& resolution = {}) {
    std::vector<std::string> arguments{
        KELP_BAKE, input, "-o", folder_ / "out.kelp", "--report", folder_ / "report.json"};
    arguments.insert(arguments.end(), resolution.begin(), resolution.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = runProcess(arguments);
    EXPECT_EQ(result.exit, 0) << result.err;
    said_ = result.err;
    const json read = json::parse(readWhole(folder_ / "report.json"), nullptr, false);
    EXPECT_EQ(schema_.check(read), "") << read.dump(1);
    return read;
  }
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  Scratch folder_;
  std::string said_;
  JsonSchema schema_{std::string(KELP_SOURCE_DIR) + "/tools/kelp-bake/kelp-bake-report.schema.json"};
};

TEST_F(KelpBakeReport, ASoundCubeHasNothingToRepair) {
  const std::string path = write("cube.obj", objOf(kCube));
  const json read = report(path);
  const json& part = read["parts"][0];
  EXPECT_FALSE(part["fog"]);
  EXPECT_EQ(
      part["mesh"],
      json::parse(
          R"({"vertices":8,"triangles":12,"boundary_edges":0,"boundaries":0,"non_manifold_edges":0,"dropped_triangles":0})"));
  EXPECT_EQ(
      part["repairs"],
      json::parse(
          R"({"components":1,"closed_components":1,"capped_components":0,"sheets":0,"walls":0,"doubled_triangles":0,"turned_triangles":0,
      "cap_triangles":0,"kept_voxels":0,
      "open_edges":0,"split_edges":0,"split_vertices":0,"cut_edges":0,"holes":0})"));
  EXPECT_EQ(part["solid_voxels"], 32 * 32 * 32);
  EXPECT_EQ(read["files"][0], json({{"name", path}, {"bytes", std::filesystem::file_size(path)}}));
  EXPECT_EQ(read["pack_bytes"], std::filesystem::file_size(folder_ / "out.kelp"));
  double last = 0;
  for (const json& stage : read["stages"]) {
    EXPECT_GE(stage["peak_bytes"], last);
    last = stage["peak_bytes"];
  }
  EXPECT_GT(last, 1e6);
  EXPECT_LT(last, read["estimated_bytes"].get<double>() * 8);  // whatever the libraries take
}

TEST_F(KelpBakeReport, FaultsAreCounted) {
  std::vector<std::array<int, 3>> faces = kCube;
  std::swap(faces[2][1], faces[2][2]);  // wound against its neighbors
  faces.push_back(faces[5]);            // twice
  faces.push_back({1, 1, 2});           // no area
  faces.erase(faces.begin() + 1);       // a hole of three edges
  // A fin on the edge from corner 7 to corner 8, which two triangles have already.
  faces.push_back({7, 8, 9});
  const json part = report(write("faulty.obj", objOf(faces, "v 0.5 2 1\n")))["parts"][0];
  EXPECT_EQ(part["mesh"]["vertices"], 9);
  EXPECT_EQ(part["mesh"]["triangles"], 13);  // 12 - the hole + the double + the fin
  EXPECT_EQ(part["mesh"]["dropped_triangles"], 1);
  EXPECT_EQ(part["mesh"]["boundary_edges"], 3 + 2);
  EXPECT_EQ(part["mesh"]["boundaries"], 2);
  // the fin's edge, and those of the triangle that is there twice
  EXPECT_EQ(part["mesh"]["non_manifold_edges"], 1 + 3);
  EXPECT_EQ(part["repairs"]["doubled_triangles"], 1);
  EXPECT_EQ(part["repairs"]["turned_triangles"], 1);
  EXPECT_NE(
      said_.find("5 boundary edges in 2 loops, 4 edges of more than two triangles, 2 vertices split where "
                 "parts touch, 1 triangle turned, 2 triangles dropped"),
      std::string::npos)
      << said_;
}

// The faults that the half-edge meshes of the components show, after welding and without doubled faces.
TEST_F(KelpBakeReport, EdgesOfThreeTrianglesBowTiesAndMoebiusStripsAreTold) {
  const auto diagnosis = [](const json& from) {
    return std::array<int, 5>{from["open_edges"], from["split_edges"], from["split_vertices"],
                              from["cut_edges"], from["holes"]};
  };
  using Five = std::array<int, 5>;
  std::vector<std::array<int, 3>> faces = kCube;
  faces.push_back({7, 8, 9});
  json part = report(write("fin.obj", objOf(faces, "v 0.5 2 1\n")))["parts"][0];
  EXPECT_EQ(diagnosis(part["repairs"]), (Five{2, 1, 2, 0, 1}));
  ASSERT_EQ(part["components"].size(), 1u);
  EXPECT_EQ(diagnosis(part["components"][0]), (Five{2, 1, 2, 0, 1}));
  EXPECT_TRUE(part["components"][0]["solid"]);
  EXPECT_NE(said_.find("1 edge of more than two triangles, 2 vertices split where parts touch"),
            std::string::npos)
      << said_;

  // Every face twice, once for each side: the cube again.
  faces = kCube;
  for (const auto& f : kCube) faces.push_back({f[0], f[2], f[1]});
  part = report(write("doubled.obj", objOf(faces)))["parts"][0];
  EXPECT_EQ(diagnosis(part["repairs"]), Five{});
  EXPECT_EQ(part["repairs"]["doubled_triangles"], 12);
  EXPECT_EQ(part["repairs"]["closed_components"], 1);
  EXPECT_EQ(part["solid_voxels"], 32 * 32 * 32);

  // Without two triangles of one corner that have no edge in common.
  const auto cornerOf = [](const std::array<int, 3>& f) { return std::count(f.begin(), f.end(), 1) > 0; };
  faces = kCube;
  const auto first = std::find_if(faces.begin(), faces.end(), cornerOf);
  const std::array<int, 3> gone = *first;
  faces.erase(first);
  const auto second = std::find_if(faces.begin(), faces.end(), [&](const std::array<int, 3>& f) {
    return cornerOf(f) && std::count_if(f.begin(), f.end(), [&](int v) {
                            return std::count(gone.begin(), gone.end(), v) > 0;
                          }) == 1;
  });
  ASSERT_NE(second, faces.end());
  faces.erase(second);
  part = report(write("bow_tie.obj", objOf(faces)))["parts"][0];
  EXPECT_EQ(diagnosis(part["repairs"]), (Five{6, 0, 1, 0, 2}));
  EXPECT_EQ(part["mesh"]["boundaries"], 1);  // they touch

  std::string strip;
  constexpr int kSteps = 12;
  for (int i = 0; i < kSteps; ++i) {
    const double a = 2 * std::numbers::pi * i / kSteps;
    for (const double side : {-0.4, 0.4}) {
      const double r = 2 + side * std::cos(a / 2);
      strip += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(side * std::sin(a / 2)) + " " +
               std::to_string(r * std::sin(a)) + "\n";
    }
  }
  for (int i = 0; i < kSteps; ++i) {
    const int a = 2 * i + 1, b = a + 1, c = i + 1 < kSteps ? a + 2 : 2, d = i + 1 < kSteps ? a + 3 : 1;
    for (const auto& f : {std::array{a, b, c}, std::array{c, b, d}})
      strip += "f " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  }
  part = report(write("moebius.obj", strip))["parts"][0];
  const Five cut = diagnosis(part["repairs"]);
  EXPECT_EQ(cut[0], 2 * kSteps);
  EXPECT_EQ(cut[3], 1);
  EXPECT_EQ(part["repairs"]["sheets"], 1);
  EXPECT_GT(part["solid_voxels"], 0);
  EXPECT_NE(said_.find("a surface with one side cut along 1 edge"), std::string::npos) << said_;
}

TEST_F(KelpBakeReport, HolesAreCappedAndSheetsKept) {
  std::vector<std::array<int, 3>> open(kCube.begin(), kCube.end() - 1);
  json part = report(write("hole.obj", objOf(open)))["parts"][0];
  EXPECT_EQ(part["repairs"]["capped_components"], 1);
  EXPECT_EQ(part["repairs"]["cap_triangles"], 3);
  EXPECT_FALSE(part["closed"]);
  part = report(write("sheet.obj", objOf({kCube[0], kCube[1]})))["parts"][0];
  EXPECT_EQ(part["repairs"]["sheets"], 1);
  EXPECT_EQ(part["repairs"]["kept_voxels"], part["solid_voxels"]);
  EXPECT_EQ(part["mesh"]["boundary_edges"], 4);
}

TEST_F(KelpBakeReport, PartsAndClipsOfATruck) {
  KELP_ASSET(path, "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf");
  const json read = report(path.string(), {"--parts", "nodes"});
  ASSERT_EQ(read["parts"].size(), 3u);
  EXPECT_EQ(read["parts"][0]["parent"], nullptr);
  EXPECT_EQ(read["parts"][1]["parent"], "Cesium_Milk_Truck");
  EXPECT_EQ(read["files"].size(), 3u);
  EXPECT_EQ(read["materials"], 4);
  EXPECT_EQ(read["images"], 1);
  ASSERT_EQ(read["clips"].size(), 2u);
  EXPECT_TRUE(read["clips"][0]["moves"]);
  EXPECT_FALSE(read["clips"][0]["bends"]);
  EXPECT_EQ(read["clips"][0]["fit"], nullptr);
  EXPECT_NE(said_.find("clip 'animation 0': 1.25 s, moves 2 parts"), std::string::npos) << said_;
  EXPECT_EQ(said_.find("skin:"), std::string::npos) << said_;
}

TEST_F(KelpBakeReport, HowWellASkinFits) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  const json read = report(path.string());
  ASSERT_GE(read["clips"].size(), 2u);
  for (const json& clip : read["clips"]) {
    EXPECT_EQ(clip["fit"], read["clips"][0]["fit"]);
    EXPECT_GT(clip["fit"]["mean"], 0.01);
    EXPECT_LT(clip["fit"]["p95"], 2);
    EXPECT_EQ(clip["fit"]["joint"].get<std::string>().rfind("node ", 0), 0u);
  }
  EXPECT_NE(said_.find("skin: the cage is 0."), std::string::npos) << said_;
  const json cell = read["parts"][0]["cell"];
  EXPECT_TRUE(cell == 2 || cell == 4 || cell == 8 || cell == 16);
  EXPECT_TRUE(read["parts"][1]["cell"].is_null());
}

// A block of 5 x 4 x 3 densities within 20 x 16 x 12, as fog and as a solid.
TEST_F(KelpBakeReport, FogHasVoxelsButNoSurface) {
  std::string densities(20 * 16 * 12, '\0');
  for (std::size_t z = 4; z < 7; ++z)
    for (std::size_t y = 6; y < 10; ++y) densities.replace(8 + 20 * (y + 16 * z), 5, "\x20\x40\x60\x7f\x30");
  write("block.raw.json", R"({"size": [20, 16, 12], "type": "u8"})");
  const std::string path = write("block.raw", densities);
  json part = reportAtOwnResolution(path)["parts"][0];
  EXPECT_EQ(part["fog"], true);
  EXPECT_EQ(part["fog_voxels"], 5 * 4 * 3);
  EXPECT_EQ(part["solid_voxels"], 0);
  EXPECT_EQ(part["surface_voxels"], 0);
  EXPECT_EQ(part["bricks"], 1);
  EXPECT_NE(said_.find("60 voxels of fog"), std::string::npos) << said_;
  EXPECT_EQ(said_.find("surface voxel"), std::string::npos) << said_;
  part = reportAtOwnResolution(path, {"--isovalue", "16"})["parts"][0];
  EXPECT_EQ(part["fog"], false);
  EXPECT_EQ(part["fog_voxels"], 0);
  EXPECT_EQ(part["solid_voxels"], 5 * 4 * 3);
  EXPECT_NE(said_.find("surface voxels, in"), std::string::npos) << said_;
  EXPECT_EQ(said_.find("of fog"), std::string::npos) << said_;
}

TEST_F(KelpBakeReport, AVolumeHasNoMesh) {
  KELP_ASSET(path, "vdb/gaffer_sphere.vdb");
  EXPECT_EQ(report(path.string())["parts"][0]["mesh"]["triangles"], 0);
}

}  // namespace
}  // namespace kelp::test
