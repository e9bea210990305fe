// SPDX-License-Identifier: MIT
// One model written plain, quantized, for meshopt and for Draco: the voxels are the same but for what
// quantization moves. Encoded by the formats' own libraries (variant_writer), or found in pairs among the
// assets.
#include <cmath>

#include "import_scratch.h"
#include "support/assets.h"
#include "variant_writer.h"

namespace kelp::bake::test {
namespace {

struct Baked {
  VoxelGrid grid;
  std::size_t solid = 0;
};

// As kelp-bake goes about it: every variant in the frame of its own box.
Baked bakeGrid(const std::filesystem::path& path, int resolution) {
  const SourceModel model = importFile(path, {});
  const SourcePart& part = model.parts.at(0);
  const Bounds bounds = boundsOf(part);
  const glm::vec3 extent = bounds.high - bounds.low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double voxels = std::floor(extent.y / longest * resolution + 1e-4);
  const Frame frame =
      makeFrame(part.soup, Axis::kPlusY, voxels < 8 ? longest / resolution : extent.y / voxels,
                path.filename().string());
  Baked out{voxelize(model, part, frame, Fill::kAuto, 2, {}).grid, 0};
  for (std::uint8_t solid : out.grid.solid) out.solid += solid;
  return out;
}

// The share of solid voxels that only one of both has.
void expectSameVoxels(const Baked& plain, const Baked& variant, const std::string& what,
                      double color = 0.01) {
  ASSERT_EQ(plain.grid.size, variant.grid.size) << what;
  ASSERT_GT(plain.solid, 1000u) << what;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < plain.grid.solid.size(); ++i)
    differ += plain.grid.solid[i] != variant.grid.solid[i];
  EXPECT_LT(static_cast<double>(differ), 0.01 * static_cast<double>(plain.solid)) << what;
  // Colors where both have a surface.
  double sum = 0;
  std::size_t both = 0, j = 0;
  for (const SurfaceSample& sample : plain.grid.surface) {
    while (j < variant.grid.surface.size() && variant.grid.surface[j].index < sample.index) ++j;
    if (j == variant.grid.surface.size() || variant.grid.surface[j].index != sample.index) continue;
    ++both;
    sum += glm::length(glm::vec3(sample.material.base_color) -
                       glm::vec3(variant.grid.surface[j].material.base_color));
  }
  ASSERT_GT(both, plain.grid.surface.size() / 2) << what;
  EXPECT_LT(sum / static_cast<double>(both), color) << what;
  ::testing::Test::RecordProperty(
      what + "_differ_per_10000",
      static_cast<int>(10000.0 * static_cast<double>(differ) / static_cast<double>(plain.solid)));
}

void expectVariantsAgree(const char* asset, int resolution) {
  KELP_ASSET(path, asset);
  const Scratch scratch;
  const SourceModel model = importFile(path, {});
  const VariantWriter writer(model);
  const Baked plain = bakeGrid(scratch.write("plain.gltf", writer.plain()), resolution);
  {
    // The writer itself changes nothing.
    const Baked source = bakeGrid(path, resolution);
    EXPECT_EQ(source.grid.size, plain.grid.size);
    EXPECT_EQ(source.grid.solid, plain.grid.solid);
  }
  expectSameVoxels(plain, bakeGrid(scratch.write("quantized.gltf", writer.quantized()), resolution),
                   "quantized");
  expectSameVoxels(plain, bakeGrid(scratch.write("meshopt.gltf", writer.meshopt(false)), resolution),
                   "meshopt");
  expectSameVoxels(plain, bakeGrid(scratch.write("meshopt_quantized.gltf", writer.meshopt(true)), resolution),
                   "meshopt_quantized");
  expectSameVoxels(plain, bakeGrid(scratch.write("draco.gltf", writer.draco()), resolution), "draco");
  expectSameVoxels(plain, bakeGrid(scratch.write("draco_sequential.gltf", writer.draco(false)), resolution),
                   "draco_sequential");
}

TEST(ImportVariants, Duck) { expectVariantsAgree("gltf/draco_testdata/Duck.glb", 128); }
TEST(ImportVariants, Truck) {
  expectVariantsAgree("gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf", 96);
}
TEST(ImportVariants, Barrel) { expectVariantsAgree("gltf/plants/barrel.glb", 96); }
TEST(ImportVariants, Bunny) { expectVariantsAgree("gltf/pmndrs/bunny.glb", 128); }
TEST(ImportVariants, VertexColors) { expectVariantsAgree("mesh/draco_testdata/test_pos_color.ply", 64); }

TEST(ImportVariants, PairsAmongTheAssets) {
  KELP_ASSET(folder, "gltf");
  const auto at = [&](const char* name) { return folder.parent_path() / name; };
  expectSameVoxels(bakeGrid(at("gltf/draco_testdata/Box.glb"), 64),
                   bakeGrid(at("gltf/draco_testdata/Box_Draco.glb"), 64), "box");
  // The OBJ names no material that the glTF file shares: colors are not compared.
  expectSameVoxels(bakeGrid(at("mesh/meshopt/pirate.obj"), 128), bakeGrid(at("gltf/meshopt/pirate.glb"), 128),
                   "pirate", 2.0);
}

// A card of a millimeter beside a field of a kilometer: what the field's rounding would explain, the card's
// own does not.
TEST(ImportVariants, RoundingClosesSeamsAndNothingElse) {
  const Scratch scratch;
  GltfMaker maker;
  maker.add(
      bytesOf(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 0, 0, 0, 0, 0, 65535, 0, 65535, 0, 65535, 0}),
      5123, 4, "VEC3");
  maker.floats({0, 0.0005f, 0, 0.001f, 0.0005f, 0, 0, 0.0015f, 0, 0.001f, 0.0015f, 0}, 3);
  maker.indices({0, 2, 1, 1, 2, 3});
  std::string text = maker.text(
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":2}]},{"primitives":[{"attributes":{"POSITION":1},"indices":2}]}],
      "nodes":[{"mesh":0,"scale":[0.0152590,1,0.0152590]},{"mesh":1}])");
  text.replace(text.find(R"("byteLength":32})"), 16, R"("byteLength":32,"byteStride":8})");
  const SourceModel model = importFile(scratch.write("model.gltf", text), {});
  EXPECT_EQ(model.parts.at(0).soup.triangles.size(), 4u);
}

// A .drc file on its own is the mesh that its glTF sibling holds, with its colors.
TEST(ImportVariants, DracoFilesOnTheirOwn) {
  for (const char* asset : {"mesh/draco_testdata/test_pos_color.ply", "mesh/common3d/spot.obj"}) {
    KELP_ASSET(path, asset);
    const Scratch scratch;
    const VariantWriter writer(importFile(path, {}));
    for (bool metadata : {false, true})
      expectSameVoxels(bakeGrid(path, 96), bakeGrid(scratch.write("mesh.drc", writer.drc(metadata)), 96),
                       asset, std::string(asset).find("color") != std::string::npos ? 0.01 : 2.0);
  }
}

// Of twenty views of 64 KiB, sixteen fill a mebibyte.
TEST(ImportVariants, WhatIsUnpackedIsCounted) {
  const Scratch scratch;
  const std::string packed = encodeMeshoptVertices(std::string(65536, '\0'), 16);
  std::string views;
  for (int i = 0; i < 20; ++i)
    views +=
        (i ? "," : "") +
        std::string(
            R"({"buffer":1,"byteLength":65536,"byteStride":16,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteLength":)") +
        std::to_string(packed.size()) + R"(,"byteStride":16,"count":4096,"mode":"ATTRIBUTES"}}})";
  const auto path = scratch.write(
      "often.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" +
                        std::to_string(packed.size()) + R"(,"uri":"data:application/octet-stream;base64,)" +
                        base64(packed) + R"("},{"byteLength":65536}],"bufferViews":[)" + views + "]}");
  EXPECT_TRUE(importFile(path, {}).parts.empty());
  const std::string said =
      refusal(path, Exit::kRuntime, with([](Settings& s) { s.max_memory = std::uint64_t{1} << 20; }));
  EXPECT_TRUE(contains(said, "bufferViews[15].EXT_meshopt_compression: ") && contains(said, "--max-memory"))
      << said;
}

}  // namespace
}  // namespace kelp::bake::test
