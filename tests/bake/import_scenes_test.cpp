// SPDX-License-Identifier: MIT
// Which meshes of a glTF scene are baked, and where: culled surfaces, joints outside of the scene, instances,
// hidden nodes, invisible materials. Files of public bug reports (hunt), and others of their kinds.
#include <cmath>

#include <nlohmann/json.hpp>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

std::filesystem::path hunted(const char* name) { return std::filesystem::path(KELP_HUNT) / name; }

std::size_t trianglesOf(const SourceModel& model) {
  std::size_t count = 0;
  for (const SourcePart& part : model.parts) count += part.soup.triangles.size();
  return count;
}

// Mesh 0 is a box 2 high and 0.2 thick, mesh 1 the same turned inside out. `material`: of both.
std::string meshes(const std::string& material = "") {
  const auto mesh = [&](const char* indices) {
    return std::string(R"({"primitives":[{"attributes":{"POSITION":0},"indices":)") + indices +
           (material.empty() ? "" : R"(,"material":0)") + "}]}";
  };
  return (material.empty() ? "" : R"("materials":[)" + material + "],") + R"("meshes":[)" + mesh("1") + "," +
         mesh("2") + "]";
}

// A scene of these nodes.
std::string boxes(const std::string& nodes, const std::string& material = "") {
  GltfMaker maker;
  maker.addBox();
  maker.indices({0, 1, 2, 1, 3, 2, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5,
                 2, 3, 6, 3, 7, 6, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7});
  std::string roots;
  const auto count = static_cast<int>(nlohmann::json::parse("[" + nodes + "]").size());
  for (int n = 0; n < count; ++n) roots += (n ? "," : "") + std::to_string(n);
  return maker.text(R"("scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" + nodes + "]," + meshes(material));
}

// Around the box, with a tenth to spare at each end.
constexpr const char* kAround = R"({"mesh":1,"scale":[1.5,1.1,1.5],"translation":[0,-0.1,0]})";
constexpr const char* kBox = R"({"mesh":0})";

TEST(Culled, AnOutlineIsLeftOut) {
  const SourceModel model = importFile(hunted("outline_hull.glb"), {});
  EXPECT_EQ(trianglesOf(model), 12u);
  EXPECT_EQ(boundsOf(model.parts[0]).high.y, 2);
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "'outline'")) << model.notices[0];
  const Settings keep = with([](Settings& s) { s.keep_culled = true; });
  EXPECT_EQ(trianglesOf(importFile(hunted("outline_hull.glb"), keep)), 24u);
}

TEST(Culled, OfAnotherNodeTooAndAsAPart) {
  const Scratch scratch;
  const std::string file = boxes(std::string(kBox) + "," + kAround);
  const SourceModel one = importText(scratch, file);
  EXPECT_EQ(trianglesOf(one), 12u);
  EXPECT_EQ(boundsOf(one.parts[0]).low.y, 0);
  const SourceModel parts = importText(scratch, file, with([](Settings& s) { s.parts = Parts::kNodes; }));
  ASSERT_EQ(parts.parts.size(), 1u);
  EXPECT_EQ(parts.parts[0].soup.triangles.size(), 12u);
}

// Flush with the floor, and with three faces and a corner of the box.
TEST(Culled, WhereItTouches) {
  const Scratch scratch;
  for (const char* around : {R"({"mesh":1,"scale":[1.5,1.05,1.5]})",
                             R"({"mesh":1,"scale":[1.5,1.1,1.5],"translation":[0.05,0,0.05]})"})
    EXPECT_EQ(trianglesOf(importText(scratch, boxes(std::string(kBox) + "," + around))), 12u) << around;
}

// The socket is at the end of the box, not of what is around it.
TEST(Culled, SizesNoRig) {
  const Scratch scratch;
  const SourceModel model = importText(
      scratch, boxes(std::string(kBox) + "," + kAround + R"(,{"name":"socket.top","translation":[0,2,0]})"));
  ASSERT_EQ(model.parts[0].rig.sockets.size(), 1u);
  EXPECT_EQ(model.parts[0].rig.sockets[0].at, 1);
}

// A sky around an outline around a box: both are culled.
TEST(Culled, EachOfSeveral) {
  const Scratch scratch;
  const SourceModel model = importText(
      scratch,
      boxes(std::string(kAround) + "," + kBox + R"(,{"mesh":1,"scale":[-50,9,50],"translation":[0,-3,0]})"));
  EXPECT_EQ(trianglesOf(model), 12u);
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "2 closed surfaces"));
}

TEST(Culled, WhatIsSeenStays) {
  const Scratch scratch;
  const auto count = [&](const std::string& nodes, const std::string& material = "") {
    return trianglesOf(importText(scratch, boxes(nodes, material)));
  };
  const std::string box = kBox, around = kAround;
  EXPECT_EQ(count(box + "," + around), 12u);
  EXPECT_EQ(count(box + "," + around, R"({"doubleSided":true})"), 24u);
  // Beside the box, not around it.
  EXPECT_EQ(count(box + R"(,{"mesh":1,"translation":[3,0,0]})"), 24u);
  // All of the file is turned inside out.
  EXPECT_EQ(count(R"({"mesh":1},)" + around), 24u);
  EXPECT_EQ(count(around), 12u);
  // The inner face of a wall with something in it, as a bottle has.
  EXPECT_EQ(count(box + "," + around + R"(,{"mesh":0,"scale":[2,1.2,2],"translation":[0,-0.2,0]})"), 36u);
}

// The same skin, whether the scene lists its joints or not.
TEST(Joints, OfNoSceneMoveAllTheSame) {
  const SourceModel inside = importFile(hunted("skeleton_inside.glb"), {}),
                    outside = importFile(hunted("skeleton_outside.glb"), {});
  const SourceSkin &a = inside.parts[0].skin.value(), &b = outside.parts[0].skin.value();
  ASSERT_EQ(a.clips.size(), 1u);
  ASSERT_EQ(b.clips.size(), 1u);
  EXPECT_EQ(a.clips[0].locals, b.clips[0].locals);
  EXPECT_EQ(inside.parts[0].soup.positions, outside.parts[0].soup.positions);
  ASSERT_EQ(b.joints.size(), 2u);
  EXPECT_EQ(b.joints[1].parent, 0);
}

// Joints below a node that only another scene lists. The upper joint is at height 1 in the bind pose; its
// parents put it at (5, 1, 0), where it turns by 90 degrees: the box's top goes from (5, 2, 0) to (4, 1, 0).
TEST(Joints, OfAnotherScene) {
  GltfMaker maker;
  maker.addBox();
  const auto [joints, weights] = maker.addBoxWeights({1, 0}, {0, 1});
  std::vector<float> binds;
  for (const float y : {0.0f, -1.0f})
    binds.insert(binds.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, y, 0, 1});
  const int bind = maker.add(bytesOf(binds), 5126, 2, "MAT4"), times = maker.floats({0, 1}, 1),
            turns = maker.floats({0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f)}, 4);
  const Scratch scratch;
  const SourceModel model = importText(
      scratch,
      maker.text(R"("scene":0,"scenes":[{"nodes":[0]},{"nodes":[1]}],"nodes":[{"mesh":0,"skin":0},)"
                 R"({"translation":[5,0,0],"children":[2]},{"children":[3]},{"translation":[0,1,0]}],)"
                 R"("skins":[{"joints":[2,3],"inverseBindMatrices":)" +
                 std::to_string(bind) +
                 R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":)" +
                 std::to_string(joints) + R"(,"WEIGHTS_0":)" + std::to_string(weights) +
                 R"(},"indices":1}]}],"animations":[{"samplers":[{"input":)" + std::to_string(times) +
                 R"(,"output":)" + std::to_string(turns) +
                 R"(}],"channels":[{"sampler":0,"target":{"node":3,"path":"rotation"}}]}])"));
  EXPECT_NEAR(boundsOf(model.parts[0]).low.x, 4.9, 1e-5);
  const SourceSkin& skin = model.parts[0].skin.value();
  ASSERT_EQ(skin.joints.size(), 2u);
  const glm::dmat4x3 last = skin.motionsAt(skin.clips.at(0), skin.clips[0].times.size() - 1).back();
  const glm::dvec3 top = last * glm::dvec4(5, 2, 0, 1);
  EXPECT_NEAR(glm::distance(top, glm::dvec3(4, 1, 0)), 0, 1e-5);
}

TEST(Joints, BelowThemselvesAreRefused) {
  GltfMaker maker;
  maker.addBox();
  const auto [joints, weights] = maker.addBoxWeights({1, 0}, {0, 1});
  const Scratch scratch;
  const auto path = scratch.write(
      "circle.gltf",
      maker.text(
          R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"skin":0},{"children":[2]},{"children":[1]}],)"
          R"("skins":[{"joints":[1,2]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":)" +
          std::to_string(joints) + R"(,"WEIGHTS_0":)" + std::to_string(weights) + R"(},"indices":1}]}])"));
  EXPECT_TRUE(contains(refusal(path, Exit::kInvalid), "nodes["));
}

TEST(Instances, StandWhereTheFileSays) {
  const SourceModel model = importFile(hunted("instancing_used.glb"), {});
  EXPECT_EQ(trianglesOf(model), 144u);
  const Bounds bounds = boundsOf(model.parts[0]);
  EXPECT_NEAR(bounds.high.x - bounds.low.x, 5.1, 1e-5);
  EXPECT_TRUE(model.notices.empty());
}

// Of a box below a moved node: one lies along -x, from a turn in 16 bits, one is three times as large and
// mirrored. The child stands once.
TEST(Instances, TurnAndScaleAndTheirChildrenStandOnce) {
  GltfMaker maker;
  maker.addBox();
  const std::vector<std::int16_t> half{0, 0, 23170, 23170, 0, 0, 0, 32767};
  const int turns = maker.add(bytesOf(half), 5122, 2, "VEC4", R"("normalized":true)"),
            scales = maker.floats({1, 1, 1, -3, 3, 3}, 3);
  const Scratch scratch;
  const SourceModel model = importText(
      scratch, maker.text(R"("extensionsUsed":["EXT_mesh_gpu_instancing"],)"
                          R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"scenes":[{"nodes":[0]}],)"
                          R"("nodes":[{"translation":[10,0,0],"children":[1]},{"mesh":0,"children":[2],)"
                          R"("extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"ROTATION":)" +
                          std::to_string(turns) + R"(,"SCALE":)" + std::to_string(scales) +
                          R"(,"_ID":0}}}},{"mesh":0,"translation":[0,0,7]}],)" + GltfMaker::boxMesh()));
  ASSERT_EQ(trianglesOf(model), 36u);
  const Bounds bounds = boundsOf(model.parts[0]);
  EXPECT_NEAR(bounds.low.x, 8, 1e-3);      // the one that lies: 2 long
  EXPECT_NEAR(bounds.high.x, 10.3, 1e-5);  // the large one: 0.6 thick
  EXPECT_NEAR(bounds.high.y, 6, 1e-5);
  EXPECT_NEAR(bounds.high.z, 7.1, 1e-5);  // the child
  // 0.08 each, the large one 27 times, all wound outward.
  EXPECT_NEAR(signedVolume(model.parts[0]), 29 * 0.08, 1e-4);
}

TEST(Instances, DamagedOnesAreRefused) {
  const Scratch scratch;
  const auto refused = [&](const std::string& attributes, GltfMaker& maker, Exit code = Exit::kInvalid) {
    return refusal(
        scratch.write("bad.gltf", maker.text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"extensions":)"
                                             R"({"EXT_mesh_gpu_instancing":{"attributes":)" +
                                             attributes + "}}}]," + GltfMaker::boxMesh())),
        code);
  };
  const auto made = [](const std::function<void(GltfMaker&)>& change) {
    GltfMaker maker;
    maker.addBox();
    change(maker);
    return maker;
  };
  GltfMaker infinite = made([](GltfMaker& m) { m.floats({1, 1, std::nanf("")}, 3); });
  EXPECT_TRUE(contains(refused(R"({"SCALE":2})", infinite), "SCALE"));
  GltfMaker uneven = made([](GltfMaker& m) {
    m.floats({1, 1, 1}, 3);
    m.floats({1, 1, 1, 2, 2, 2}, 3);
  });
  EXPECT_TRUE(contains(refused(R"({"SCALE":2,"TRANSLATION":3})", uneven), "2 and of 1"));
  EXPECT_TRUE(contains(refused(R"({"ROTATION":2})", uneven), "components"));
  EXPECT_TRUE(contains(refused(R"({"TRANSLATION":99})", uneven), "accessor 99"));
  EXPECT_TRUE(contains(refused(R"({"TRANSLATION":"a"})", uneven), "TRANSLATION"));
  EXPECT_TRUE(contains(refused("[1]", uneven), "no object"));
  // Without data an accessor is zeros, so that a few bytes ask for anything.
  for (const char* count : {"4000000000", "60000000"}) {
    GltfMaker maker = made([](GltfMaker&) {});
    std::string text = maker.text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"extensions":)"
                                  R"({"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}],)" +
                                  GltfMaker::boxMesh());
    const std::string end = "],\"scenes\"";
    text.replace(text.find(end), end.size(),
                 R"(,{"componentType":5126,"count":)" + std::string(count) + R"(,"type":"VEC3"})" + end);
    refusal(scratch.write("many.gltf", text), Exit::kInvalid);
  }
}

TEST(Visibility, HidesANodeAndAllBelowIt) {
  GltfMaker maker;
  maker.addBox();
  const Scratch scratch;
  const auto read = [&](const std::string& visible) {
    return importText(
        scratch, maker.text(R"("extensionsUsed":["KHR_node_visibility"],"scenes":[{"nodes":[0,1]}],)"
                            R"("nodes":[{"mesh":0},{"children":[2],"extensions":{"KHR_node_visibility":)" +
                            visible + R"(}},{"mesh":0,"translation":[5,0,0]}],)" + GltfMaker::boxMesh()));
  };
  const SourceModel hidden = read(R"({"visible":false})");
  EXPECT_EQ(trianglesOf(hidden), 12u);
  EXPECT_EQ(hidden.notices.size(), 1u);
  for (const char* shown : {R"({"visible":true})", "{}"}) EXPECT_EQ(trianglesOf(read(shown)), 24u);
  // Of all that there is, the notice is the reason.
  const SourceModel none = importText(
      scratch,
      maker.text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"extensions":{"KHR_node_visibility":)"
                 R"({"visible":false}}}],)" +
                 GltfMaker::boxMesh()));
  EXPECT_TRUE(none.parts.empty());
  EXPECT_TRUE(contains(none.notices.back(), "KHR_node_visibility"));
}

TEST(Vrm, IsAGlb) {
  const Scratch scratch;
  const auto path = scratch.write(
      "avatar.vrm", R"({"extensionsUsed":["VRMC_vrm","VRMC_materials_mtoon"],)" + boxes(kBox).substr(1));
  const SourceModel model = importFile(path, {});
  EXPECT_EQ(trianglesOf(model), 12u);
  EXPECT_TRUE(model.notices.empty());
  const auto binary = scratch.write("binary.vrm", contentOf(hunted("instancing_used.glb")));
  EXPECT_EQ(trianglesOf(importFile(binary, {})), 144u);
}

// Vertex colors: alpha 0 at all corners is not there, and neither is a material with that alpha.
TEST(Invisible, IsLeftOutWithANotice) {
  const Scratch scratch;
  const auto read = [&](const std::string& material, float upper) {
    GltfMaker maker;
    maker.addBox();
    std::vector<float> colors;
    for (int i = 0; i < 8; ++i) colors.insert(colors.end(), {1, 1, 1, i & 2 ? upper : 0.0f});
    const int color = maker.floats(colors, 4);
    return importText(
        scratch, maker.text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"materials":[{)" + material +
                            R"(},{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}],"meshes":[)"
                            R"({"primitives":[{"attributes":{"POSITION":0,"COLOR_0":)" +
                            std::to_string(color) +
                            R"(},"indices":1,"material":0},)"
                            R"({"attributes":{"POSITION":0},"indices":1,"material":1}]}])"));
  };
  const std::string none = R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0]})";
  for (const char* mode : {"BLEND", "MASK"}) {
    const SourceModel model = read(none + R"(,"alphaMode":")" + mode + "\"", 1);
    EXPECT_EQ(trianglesOf(model), 12u) << mode;
    EXPECT_EQ(model.notices.size(), 1u) << mode;
  }
  EXPECT_EQ(trianglesOf(read(none, 1)), 24u);  // OPAQUE: alpha means nothing
  // The two triangles of the lower end have alpha 0 alone; other triangles touch the upper end.
  const SourceModel some = read(R"("alphaMode":"BLEND")", 1);
  EXPECT_EQ(trianglesOf(some), 22u);
  EXPECT_TRUE(anyContains(some.notices, "2 of its triangles"));
  EXPECT_EQ(trianglesOf(read(R"("alphaMode":"BLEND")", 0)), 12u);
}

TEST(VertexColors, OtherSetsMakeANotice) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int color = maker.floats(std::vector<float>(24, 0.5f), 3);
  for (const char* name : {"COLOR_1", "_COLOR_0", "_Color"}) {
    const SourceModel model = importText(
        scratch, maker.text(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
                            R"({"attributes":{"POSITION":0,")" +
                            std::string(name) + "\":" + std::to_string(color) + R"(},"indices":1}]}])"));
    EXPECT_TRUE(anyContains(model.notices, name));
    EXPECT_TRUE(model.parts[0].soup.colors.empty());
  }
}

}  // namespace
}  // namespace kelp::bake::test
