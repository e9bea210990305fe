// SPDX-License-Identifier: MIT
// glTF against the files' own numbers and against closed forms.
#include <cmath>

#include "import_scratch.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

// Numbers from the files' JSON: 12636 indices; the bounds of POSITION times the matrix of node 2 (scale
// 0.01).
TEST(ImportGltf, DuckHasItsTrianglesAndStandsUpright) {
  KELP_ASSET(path, "gltf/draco_testdata/Duck.glb");
  const SourceModel model = importFile(path, {});
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 4212u);
  EXPECT_EQ(model.parts[0].name, "Duck");
  const Bounds bounds = boundsOf(model.parts[0]);
  EXPECT_NEAR(bounds.low.y, 0.0992937, 1e-5);
  EXPECT_NEAR(bounds.high.y, 1.6397, 1e-4);
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images[0].width, 512);
  EXPECT_EQ(model.parts[0].soup.uvs.size(), 4212u);
  EXPECT_GT(signedVolume(model.parts[0]), 0);
}

// The bind pose of the skin is the mesh as modeled: the accessor's own min and max, in its own axes, which
// the rest pose of the joints keeps.
TEST(ImportGltf, FoxStandsWhereItsBindPoseSays) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const SourceModel model = importFile(path, {});
  ASSERT_EQ(model.parts[0].soup.triangles.size(), 576u);
  const Bounds bounds = boundsOf(model.parts[0]);
  // accessors[0]
  const glm::vec3 low(-12.592718f, -0.121743f, -88.095001f), high(12.592718f, 78.907219f, 66.624917f);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(bounds.low[c], low[c], 0.02);
    EXPECT_NEAR(bounds.high[c], high[c], 0.02);
  }
  ASSERT_TRUE(model.parts[0].skin);
  EXPECT_EQ(model.parts[0].skin->clips.size(), 3u);
  ImportSettings plain;
  plain.rig_preset = "none";
  EXPECT_TRUE(anyContains(importFile(path, plain).notices, "'Run'"));
}

TEST(ImportGltf, TruckInstancesItsWheels) {
  KELP_ASSET(path, "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf");
  FilesUsed used;
  const SourceModel model = importFile(path, {}, &used);
  // the wheels twice
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 5232u / 3 + 168u / 3 + 864u / 3 + 2u * 2304u / 3);
  EXPECT_EQ(used.read.size(), 3u);
}

TEST(ImportGltf, EveryPrimitiveModeAndIndexTypeMakesTheSameSquare) {
  KELP_ASSET(folder, "gltf/assimp/Mesh_PrimitiveMode");
  for (int i : {4, 5, 6, 11, 12, 13, 14, 15}) {
    const std::string name =
        "Mesh_PrimitiveMode_" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".gltf";
    const SourceModel model = importFile(folder / name, {});
    ASSERT_EQ(model.parts[0].soup.triangles.size(), 2u) << name;
    double area = 0;
    for (const auto& t : model.parts[0].soup.triangles) {
      const auto& p = model.parts[0].soup.positions;
      area += glm::cross(p[t.vertex[1]] - p[t.vertex[0]], p[t.vertex[2]] - p[t.vertex[0]]).z / 2;
    }
    EXPECT_NEAR(area, 1.0, 1e-6) << name;  // positive: both triangles face +z
  }
  EXPECT_TRUE(
      contains(refusal(folder / "Mesh_PrimitiveMode_00.gltf", Exit::kUnsupported), "points or lines"));
}

TEST(ImportGltf, SparseAccessorMovesItsThreeVertices) {
  KELP_ASSET(path, "gltf/draco_testdata/SimpleSparseAccessor/SimpleSparseAccessor.gltf");
  const Bounds bounds = boundsOf(importFile(path, {}).parts[0]);
  EXPECT_EQ(bounds.high.y, 4.0f);  // 1 without the sparse values
}

TEST(ImportGltf, MirroredNodesKeepTheirOutsideOutside) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string scene = R"(,"scenes":[{"nodes":[0]}])";
  for (const std::string node : {R"({"mesh":0})", R"({"mesh":0,"scale":[-1,1,1]})",
                                 R"({"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,-1,0, 5,0,0,1]})"}) {
    const SourceModel model =
        importText(scratch, maker.text(GltfMaker::boxMesh() + R"(,"nodes":[)" + node + "]" + scene));
    EXPECT_NEAR(signedVolume(model.parts[0]), 0.2 * 2 * 0.2, 1e-5) << node;
  }
}

// The lower end of a box follows one joint, the upper end another that stands 3 to the side; the mesh's own
// node must not matter.
TEST(ImportGltf, SkinsPlaceTheirVerticesAtRest) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  maker.addBoxWeights({1, 0}, {0, 1});
  const SourceModel model = importText(
      scratch,
      maker.text(
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1}]}],"skins":[{"joints":[1,2]}],
      "nodes":[{"mesh":0,"skin":0,"translation":[100,0,0]},{"name":"root","children":[2]},{"name":"tip","translation":[3,0,0]}])"));
  for (const glm::vec3& p : model.parts[0].soup.positions) EXPECT_NEAR(p.x, p.y > 1 ? 3 : 0, 0.11) << p.y;
  EXPECT_NEAR(boundsOf(model.parts[0]).high.x, 3.1, 1e-5);
}

TEST(ImportGltf, MorphTargetsHaveTheirDefaultWeights) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  std::vector<float> up;
  for (int i = 0; i < 8; ++i) up.insert(up.end(), {0, i & 2 ? 2.0f : 0.0f, 0});
  maker.floats(up, 3);
  const std::string mesh =
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":2}]}],"weights":[0.5]}],"nodes":[{"mesh":0)";
  EXPECT_NEAR(boundsOf(importText(scratch, maker.text(mesh + "}]")).parts[0]).high.y, 3, 1e-5);
  EXPECT_NEAR(boundsOf(importText(scratch, maker.text(mesh + R"(,"weights":[0.25]}])")).parts[0]).high.y, 2.5,
              1e-5);
}

TEST(ImportGltf, WithoutAScenesAllRootsAreBakedAndTheDefaultSceneWins) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string nodes =
      GltfMaker::boxMesh() + R"(,"nodes":[{"mesh":0},{"mesh":0,"translation":[3,0,0]}])";
  EXPECT_EQ(importText(scratch, maker.text(nodes)).parts[0].soup.triangles.size(), 24u);
  const SourceModel second =
      importText(scratch, maker.text(nodes + R"(,"scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1)"));
  EXPECT_EQ(second.parts[0].soup.triangles.size(), 12u);
  EXPECT_NEAR(boundsOf(second.parts[0]).low.x, 2.9, 1e-6);
}

TEST(ImportGltf, MaterialsAreLinearFactorsAndMissingImagesANotice) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const SourceModel model = importText(
      scratch,
      maker.text(
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],
      "images":[{"uri":"absent.png"}],"textures":[{"source":0}],
      "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.4,0.6,0.5],"metallicFactor":0.25,"roughnessFactor":0.75,"baseColorTexture":{"index":0}},
      "emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":2.0}}}])"));
  ASSERT_EQ(model.materials.size(), 2u);
  EXPECT_EQ(model.materials[0].base_color, glm::vec4(0.2f, 0.4f, 0.6f, 1));  // alphaMode OPAQUE
  EXPECT_EQ(model.materials[0].emissive, glm::vec3(2, 1, 0));
  EXPECT_EQ(model.materials[0].metallic, 0.25f);
  EXPECT_EQ(model.materials[0].roughness, 0.75f);
  EXPECT_EQ(model.materials[0].texture, -1);
  EXPECT_TRUE(anyContains(model.notices, "absent.png"));
}

TEST(ImportGltf, UnlitMaterialsAreNoMetal) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  // A file without factors means white metal, of which an unlit material shows nothing.
  const SourceModel model = importText(
      scratch,
      maker.text(
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],
      "materials":[{"extensions":{"KHR_materials_unlit":{}}}])"));
  EXPECT_EQ(model.materials[0].metallic, 0.0f);
}

TEST(ImportGltf, PercentEncodedNamesAreFound) {
  const Scratch scratch;
  scratch.write("sub folder/ein \xc3\xa4pfel.bin", bytesOf(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const SourceModel model = importText(
      scratch,
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"sub%20folder/ein%20%C3%A4pfel.bin"}],
      "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})");
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 1u);
}

TEST(ImportGltf, NothingOutsideTheFolderIsRead) {
  const Scratch scratch;
  scratch.write("secret.bin", std::string(36, 'x'));
  for (const std::string uri :
       {"../secret.bin", "%2e%2e/secret.bin", "a/../../secret.bin", "/etc/passwd", "%2Fetc%2Fpasswd",
        "file:///etc/passwd", "http://x/y.bin", "..%5Csecret.bin", ".", ""}) {
    const auto path = scratch.write(
        "inner/model.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
                                R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})");
    EXPECT_THROW(importFile(path, {}), ToolError) << uri;
  }
}

TEST(ImportGltf, UnknownRequiredExtensionIsNamed) {
  const Scratch scratch;
  const auto path =
      scratch.write("m.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["ACME_hologram"]})");
  EXPECT_TRUE(contains(refusal(path, Exit::kUnsupported), "ACME_hologram"));
}

TEST(ImportGltf, DeepJsonIsRefused) {
  const Scratch scratch;
  const std::string deep(200000, '[');
  EXPECT_TRUE(contains(refusal(scratch.write("a.gltf", R"({"asset":{"version":"2.0"},"extras":)" + deep +
                                                           std::string(200000, ']') + "}"),
                               Exit::kInvalid),
                       "nested"));
  refusal(scratch.write("b.gltf", R"({"asset":)" + deep), Exit::kInvalid);
  // 64 levels, brackets in strings not counted.
  const auto nested = [](int levels) {
    const auto depth = static_cast<std::size_t>(levels - 1);
    return R"({"asset":{"version":"2.0"},"extras":)" + std::string(depth - 1, '[') + R"("\"[[{{[[\\",[])" +
           std::string(depth - 1, ']') + "}";
  };
  EXPECT_TRUE(importFile(scratch.write("c.gltf", nested(64)), {}).parts.empty());
  EXPECT_TRUE(contains(refusal(scratch.write("d.gltf", nested(66)), Exit::kInvalid), "nested"));
}

TEST(ImportGltf, GraphsThatAreNoTreesAreRefused) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  for (const std::string nodes :
       {R"([{"mesh":0,"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}])",
        R"([{"mesh":0,"children":[0]}],"scenes":[{"nodes":[0]}])",
        R"([{"children":[2]},{"children":[2]},{"mesh":0}])", R"([{"mesh":7}])",
        R"([{"mesh":0,"children":[9]}])", R"([{"mesh":0,"skin":0}])", R"([{"mesh":0,"scale":[1,1]}])"})
    refusal(scratch.write("m.gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":)" + nodes)),
            Exit::kInvalid);
}

TEST(ImportGltf, RangesAreChecked) {
  const Scratch scratch;
  const auto with = [&](const std::string& view, const std::string& accessor, const std::string& primitive) {
    return scratch.write(
        "m.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:;base64,)" +
                      base64(std::string(36, '\1')) + R"("}],"bufferViews":[)" + view + R"(],"accessors":[)" +
                      accessor + R"(],"meshes":[{"primitives":[)" + primitive +
                      R"(]}],"nodes":[{"mesh":0}]})");
  };
  const std::string view = R"({"buffer":0,"byteLength":36})",
                    accessor = R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})",
                    primitive = R"({"attributes":{"POSITION":0}})";
  refusal(with(R"({"buffer":1,"byteLength":36})", accessor, primitive), Exit::kInvalid);
  refusal(with(R"({"buffer":0,"byteLength":37})", accessor, primitive), Exit::kInvalid);
  refusal(with(R"({"buffer":0,"byteOffset":18446744073709551615,"byteLength":36})", accessor, primitive),
          Exit::kInvalid);
  refusal(with(view, R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})", primitive),
          Exit::kInvalid);
  refusal(with(view, R"({"bufferView":0,"componentType":5126,"count":4294967295,"type":"VEC3"})", primitive),
          Exit::kInvalid);
  refusal(with(view, R"({"componentType":5126,"count":4294967295,"type":"VEC3"})", primitive),
          Exit::kInvalid);
  refusal(
      with(
          view,
          R"({"bufferView":0,"byteOffset":18446744073709551612,"componentType":5126,"count":3,"type":"VEC3"})",
          primitive),
      Exit::kInvalid);
  refusal(
      with(
          view,
          R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":-1,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0}}})",
          primitive),
      Exit::kInvalid);
  refusal(with(view, accessor, R"({"attributes":{"POSITION":5}})"), Exit::kInvalid);
  refusal(with(view, accessor, R"({"attributes":{"POSITION":0},"material":3})"), Exit::kInvalid);
  refusal(with(view, accessor, R"({"attributes":{"POSITION":0,"COLOR_0":0},"indices":0})"), Exit::kInvalid);
}

// 61 bytes that ask for 3.4 GB, after the layout of Draco's header: sequential, 286 million faces.
TEST(ImportGltf, DracoStreamsThatLieAboutTheirSizeAreRefused) {
  const Scratch scratch;
  std::string stream("DRACO\x02\x02\x01\x00\x00\x00", 11);
  stream += std::string("\xff\xff\xff\x88\x01\xff\xff\xff\x88\x01", 10) + std::string(40, '\0');
  const std::string text =
      R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],"buffers":[{"byteLength":61,"uri":"data:;base64,)" +
      base64(stream) +
      R"("}],"bufferViews":[{"buffer":0,"byteLength":61}],"accessors":[{"componentType":5126,"count":3,"type":"VEC3"},{"componentType":5125,"count":3,"type":"SCALAR"}],
                           "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}],"nodes":[{"mesh":0}]})";
  EXPECT_TRUE(contains(refusal(scratch.write("m.gltf", text), Exit::kInvalid), "61 bytes"));
}

TEST(ImportGltf, GlassIsBakedOpaqueAndThatIsSaid) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto notices = [&](const std::string& material) {
    return importText(
               scratch,
               maker.text(
                   R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],"materials":[{"name":"Pane",)" +
                   material + "}]"))
        .notices;
  };
  const char* const said = "materials[0] 'Pane': is transparent; it is baked opaque";
  EXPECT_TRUE(anyContains(
      notices(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}})"), said));
  EXPECT_TRUE(anyContains(
      notices(R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.3]})"), said));
  EXPECT_TRUE(notices(R"("alphaMode":"BLEND","extensions":{"KHR_materials_transmission":{}})").empty());
  EXPECT_TRUE(notices(R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.3]})").empty());
}

}  // namespace
}  // namespace kelp::bake::test
