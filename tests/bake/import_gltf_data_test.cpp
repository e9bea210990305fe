// SPDX-License-Identifier: MIT
// Where the numbers of a glTF file lie and how they are written: accessors, buffers, scenes, transforms.
#include <algorithm>
#include <cmath>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

std::string mesh(const std::string& attributes, const std::string& more = "") {
  return R"("meshes":[{"primitives":[{"attributes":{)" + attributes + "}" + more +
         R"(}]}],"nodes":[{"mesh":0}])";
}

// The same triangle in every type that KHR_mesh_quantization allows for positions.
TEST(ImportGltfData, PositionsOfEveryTypeMeanTheSame) {
  const Scratch scratch;
  struct Case {
    int type;
    std::string bytes;
    bool normalized;
    float largest;
  };
  const std::vector<Case> cases = {
      {5120, bytesOf(std::vector<std::int8_t>{0, 0, 0, 0, 127, 0, 0, 0, 0, -127, 0, 0}), false, 127},
      {5120, bytesOf(std::vector<std::int8_t>{0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0, 0}), true, 1},
      {5121, bytesOf(std::vector<std::uint8_t>{0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}), false, 255},
      {5121, bytesOf(std::vector<std::uint8_t>{0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}), true, 1},
      {5122, bytesOf(std::vector<std::int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 0, -32767, 0, 0}), false, 32767},
      {5122, bytesOf(std::vector<std::int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0}), true, 1},
      {5123, bytesOf(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}), false, 65535},
      {5123, bytesOf(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}), true, 1}};
  for (const Case& c : cases) {
    const int size = c.type < 5122 ? 1 : 2;
    const std::string text =
        R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"buffers":[{"byteLength":)" +
        std::to_string(c.bytes.size()) + R"(,"uri":"data:application/octet-stream;base64,)" +
        base64(c.bytes) + R"("}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(c.bytes.size()) +
        R"(,"byteStride":)" + std::to_string(4 * size) +
        R"(}],"accessors":[{"bufferView":0,"componentType":)" + std::to_string(c.type) +
        R"(,"count":3,"type":"VEC3","normalized":)" + (c.normalized ? "true" : "false") + "}]," +
        mesh(R"("POSITION":0)") + "}";
    const Bounds bounds = boundsOf(importText(scratch, text).parts.at(0));
    EXPECT_EQ(bounds.high.x, c.largest) << c.type << c.normalized;
    EXPECT_EQ(std::max(bounds.high.y, -bounds.low.y), c.largest) << c.type << c.normalized;
  }
}

TEST(ImportGltfData, ColorsAreFloatsOrFractionsOfTheirType) {
  const Scratch scratch;
  const auto color = [&](const std::string& bytes, int type, const char* shape, const std::string& more) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    maker.add(bytes, type, 3, shape, more);
    return importText(scratch, maker.text(mesh(R"("POSITION":0,"COLOR_0":1)")))
        .parts.at(0)
        .soup.colors.at(0)[1];
  };
  EXPECT_EQ(color(bytesOf(std::vector<float>{0, 0, 0, 0.25f, 0.5f, 1, 0, 0, 0}), 5126, "VEC3", ""),
            glm::vec4(0.25f, 0.5f, 1, 1));
  EXPECT_EQ(color(bytesOf(std::vector<std::uint8_t>{0, 0, 0, 0, 51, 102, 255, 255, 0, 0, 0, 0}), 5121, "VEC4",
                  R"("normalized":true)"),
            glm::vec4(0.2f, 0.4f, 1, 1));
  EXPECT_EQ(color(bytesOf(std::vector<std::uint16_t>{0, 0, 0, 0, 13107, 26214, 65535, 65535, 0, 0, 0, 0}),
                  5123, "VEC4", R"("normalized":true)"),
            glm::vec4(0.2f, 0.4f, 1, 1));
  // Left out by exporters: an integer color cannot be meant as it stands.
  EXPECT_EQ(
      color(bytesOf(std::vector<std::uint8_t>{0, 0, 0, 0, 51, 102, 255, 255, 0, 0, 0, 0}), 5121, "VEC4", ""),
      glm::vec4(0.2f, 0.4f, 1, 1));
}

TEST(ImportGltfData, SparseValuesNeedNoBufferBelowThem) {
  const Scratch scratch;
  GltfMaker maker;
  maker.indices({1, 2});  // views 0 and 1
  maker.floats({2, 0, 0, 0, 3, 0}, 3);
  const std::string text = maker.text(mesh(R"("POSITION":2)"));
  const std::string sparse =
      R"(,{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":1}}}],"meshes")";
  const std::size_t at = text.find("],\"meshes\"");
  const Bounds bounds =
      boundsOf(importText(scratch, text.substr(0, at) + sparse + text.substr(at + 10)).parts.at(0));
  EXPECT_EQ(bounds.low, glm::vec3(0));
  EXPECT_EQ(bounds.high, glm::vec3(2, 3, 0));
}

TEST(ImportGltfData, IndicesMayBeSparse) {
  const Scratch scratch;
  GltfMaker maker;
  maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 5, 0}, 3);
  maker.indices({2});
  maker.indices({3});
  maker.add(
      bytesOf(std::vector<std::uint16_t>{0, 1, 2}), 5123, 3, "SCALAR",
      R"("sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}})");
  EXPECT_EQ(boundsOf(importText(scratch, maker.text(mesh(R"("POSITION":0)", R"(,"indices":3)"))).parts.at(0))
                .high.y,
            5);
}

TEST(ImportGltfData, DataUrisAreBase64OrPercentEncoded) {
  const Scratch scratch;
  const std::string bytes = bytesOf(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  std::string percent;
  for (unsigned char byte : bytes) {
    char digits[4];
    std::snprintf(digits, sizeof digits, "%%%02X", byte);
    percent += digits;
  }
  const SourceModel model = importText(
      scratch,
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:application/gltf-buffer,)" +
          percent +
          R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)" +
          mesh(R"("POSITION":0)") + "}");
  EXPECT_EQ(boundsOf(model.parts.at(0)).high, glm::vec3(1, 1, 0));
  EXPECT_TRUE(model.notices.empty());
}

// A buffer is read when something needs it.
TEST(ImportGltfData, WhatIsAbsentMattersToItsReadersAlone) {
  const Scratch scratch;
  const auto text = [](int buffer, const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
           base64(bytesOf(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})) + R"("},{"byteLength":36,"uri":")" +
           uri + R"("}],"bufferViews":[{"buffer":)" + std::to_string(buffer) +
           R"(,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)" +
           mesh(R"("POSITION":0)") + "}";
  };
  for (const char* uri : {"absent.bin", "http://example.com/x.bin", "../x.bin", "data:"}) {
    SCOPED_TRACE(uri);
    FilesUsed used;
    EXPECT_EQ(importFile(scratch.write("m.gltf", text(0, uri)), {}, &used).parts.size(), 1u);
    EXPECT_EQ(used.read.size(), 1u);
    for (const auto& missing : used.missing)  // a rig beside the file, no buffer
      EXPECT_TRUE(contains(missing, "rig.json")) << missing;
    const bool absent = uri == std::string("absent.bin");
    const std::string said =
        refusal(scratch.write("m.gltf", text(1, uri)), absent ? Exit::kIo : Exit::kInvalid);
    EXPECT_TRUE(contains(said, "m.gltf: buffers[1]: ")) << said;
  }
}

TEST(ImportGltfData, ScenesAreChosenByNameOrIndex) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string text = maker.text(
      GltfMaker::boxMesh() +
      R"(,"nodes":[{"mesh":0},{"mesh":0,"translation":[3,0,0]},{"mesh":0,"translation":[6,0,0]}],"scene":0,
      "scenes":[{"name":"first","nodes":[0]},{"name":"2","nodes":[1]},{"name":"7","nodes":[2]}])");
  const auto low = [&](const std::optional<std::string>& scene) {
    Settings settings;
    settings.scene = scene;
    return boundsOf(importText(scratch, text, settings).parts.at(0)).low.x;
  };
  EXPECT_NEAR(low(std::nullopt), -0.1, 1e-6);
  EXPECT_NEAR(low("first"), -0.1, 1e-6);
  EXPECT_NEAR(low("1"), 2.9, 1e-6);
  EXPECT_NEAR(low("2"), 5.9, 1e-6) << "an index comes before a name";
  EXPECT_NEAR(low("7"), 5.9, 1e-6) << "what is no index may be a name";
  Settings settings;
  for (const char* none : {"third", "3", "-1", "1x", ""}) {
    settings.scene = none;
    EXPECT_TRUE(contains(refusal(scratch.write("model.gltf", text), Exit::kUsage, settings),
                         "the file has 0 'first', 1 '2', 2 '7'"))
        << none;
  }
  settings.scene = "first";
  refusal(scratch.write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Exit::kUsage, settings);
}

TEST(ImportGltfData, ChannelsThatPointAreToldOnce) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string channel =
      R"({"sampler":0,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/0/pbrMetallicRoughness/roughnessFactor"}}}})";
  const int times = maker.floats({0, 1}, 1), values = maker.floats({0, 1}, 1);
  const SourceModel model = importText(
      scratch,
      maker.text(
          GltfMaker::boxMesh() +
          R"(,"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"extensionsUsed":["KHR_animation_pointer"],"materials":[{}],
      "animations":[{"samplers":[{"input":)" +
          std::to_string(times) + R"(,"output":)" + std::to_string(values) + R"(}],"channels":[)" + channel +
          "," + channel + "]}]"));
  EXPECT_EQ(std::count_if(model.notices.begin(), model.notices.end(),
                          [](const std::string& line) { return contains(line, "KHR_animation_pointer"); }),
            1);
  EXPECT_EQ(model.notices.size(), 1u);
}

TEST(ImportGltfData, AFileWithoutAMeshIsSoundAndHoldsNothing) {
  const Scratch scratch;
  EXPECT_TRUE(importText(scratch, R"({"asset":{"version":"2.0"}})").parts.empty());
  EXPECT_TRUE(
      importText(scratch, R"({"asset":{"version":"2.0"},"nodes":[{"translation":[1,2,3]}]})").parts.empty());
  EXPECT_TRUE(importText(scratch, R"({"asset":{"version":"2.0"},"accessors":[]})").parts.empty());
}

// A flat mirror of a body is still a body's surface; one without any extent has none and takes nothing else
// with it.
TEST(ImportGltfData, SingularTransformsFlattenWhatTheyHold) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto import = [&](const std::string& nodes) {
    return importText(scratch, maker.text(GltfMaker::boxMesh() + ",\"nodes\":[" + nodes + "]"));
  };
  const Bounds flat = boundsOf(import(R"({"mesh":0,"scale":[1,0,1]})").parts.at(0));
  EXPECT_EQ(flat.low.y, 0);
  EXPECT_EQ(flat.high.y, 0);
  EXPECT_NEAR(flat.high.x, 0.1, 1e-6);
  const SourceModel hidden = import(R"({"mesh":0},{"mesh":0,"scale":[0,0,0],"translation":[50,0,0]})");
  EXPECT_EQ(hidden.parts.at(0).soup.triangles.size(), 12u);
  EXPECT_NEAR(boundsOf(hidden.parts[0]).high.x, 0.1, 1e-6);
  // Mirrored twice over two levels is not mirrored.
  EXPECT_GT(
      signedVolume(import(R"({"children":[1],"scale":[-1,1,1]},{"mesh":0,"scale":[1,1,-1]})").parts.at(0)),
      0);
  EXPECT_GT(
      signedVolume(
          import(R"({"children":[1],"scale":[-1,1,1]},{"mesh":0,"rotation":[0,0.6,0,0.8]})").parts.at(0)),
      0);
}

TEST(ImportGltfData, FilesThatNeedANewerReaderAreRefused) {
  const Scratch scratch;
  const auto file = [&](const std::string& asset) {
    return scratch.write("m.gltf", R"({"asset":{)" + asset + "}}");
  };
  for (const char* version : {"2.1", "2.9", "2.10", "3.0", "99999999999.0"})
    EXPECT_TRUE(contains(
        refusal(file(R"("version":"2.0","minVersion":")" + std::string(version) + "\""), Exit::kUnsupported),
        "minVersion"))
        << version;
  for (const char* version : {"2.0", "2", "1.9", ""})
    EXPECT_TRUE(
        importFile(file(R"("version":"2.1","minVersion":")" + std::string(version) + "\""), {}).parts.empty())
        << version;
}

TEST(ImportGltfData, ExtensionsThatAreNotKnownAreNamedOnce) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto notices = [&](const std::string& nodes, const std::string& used) {
    return importText(scratch, maker.text(GltfMaker::boxMesh() + R"(,"nodes":[)" + nodes +
                                          R"(],"extensionsUsed":[)" + used + "]"))
        .notices;
  };
  const std::string node = R"({"mesh":0,"extensions":{"ACME_a":{"attributes":{}}}})";
  const std::vector<std::string> lines =
      notices(node + "," + node, R"("ACME_a","KHR_materials_ior","ACME_b")");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(contains(lines[0], "ACME_a, ACME_b;")) << lines[0];
  EXPECT_TRUE(
      notices(R"({"mesh":0,"extensions":{"KHR_lights_punctual":{}},"extras":{"extensions":{"ACME_own":{}}}})",
              R"("KHR_lights_punctual","KHR_texture_transform")")
          .empty());
  std::string many;
  for (int i = 10; i < 30; ++i) many += (many.empty() ? "\"ACME_" : ",\"ACME_") + std::to_string(i) + "\"";
  EXPECT_TRUE(contains(notices(R"({"mesh":0})", many).at(0), "ACME_17 and 12 more;"));
}

// Both are optional: matrices of a skin are the identity then, and a channel's target is an extension's.
TEST(ImportGltfData, SkinsNeedNoMatricesAndChannelsNoNode) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  maker.joints(std::vector<std::uint16_t>(32, 0));
  std::vector<float> weights;
  for (int i = 0; i < 8; ++i) weights.insert(weights.end(), {1, 0, 0, 0});
  maker.floats(weights, 4);
  maker.floats({0, 1}, 1);
  maker.floats({0, 0, 0, 9, 9, 9}, 3);
  const SourceModel model = importText(
      scratch,
      maker.text(
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1}]}],"nodes":[{"mesh":0,"skin":0},{"translation":[5,0,0]}],"skins":[{"joints":[1]}],
        "animations":[{"channels":[{"sampler":0,"target":{"path":"translation"}},{"sampler":0,"target":{"path":"translation"}}],"samplers":[{"input":4,"output":5}]}])"));
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
  EXPECT_NEAR(boundsOf(model.parts.at(0)).low.x, 4.9, 1e-6);
}

}  // namespace
}  // namespace kelp::bake::test
