// SPDX-License-Identifier: MIT
// Rigs inside glTF: extras.kelp, and empties knot.0 .. knot.n in the shape in which Blender exports them.
#include <cmath>

#include "import_scratch.h"

namespace kelp::bake::test {
namespace {

constexpr float kHalf = 0.70710678f;

// A reed of length 2 with three empties along it. Accessors: 0, 1 the box; 2 times {0, 1}; 3 knot.2's places;
// 4 knot.1's turns (90 degrees about z); 5 the reed's own places; 6 its turns (90 degrees about y).
class Reed {
 public:
  Reed() {
    maker_.addBox();
    maker_.floats({0, 1}, 1);
    maker_.floats({0, 2, 0, 0.4f, 2.2f, 0}, 3);
    maker_.floats({0, 0, 0, 1, 0, 0, kHalf, kHalf}, 4);
    maker_.floats({1, 0, 0, 1, 3, 0}, 3);
    maker_.floats({0, 0, 0, 1, 0, kHalf, 0, kHalf}, 4);
  }
  std::string knots =
      R"({"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.2","translation":[0,2,0]})";
  std::string reed = R"("name":"Reed","mesh":0,"children":[1,2,3])";
  std::string animations = R"([{"name":"sway","samplers":[{"input":2,"output":3},{"input":2,"output":4}],
      "channels":[{"sampler":0,"target":{"node":3,"path":"translation"}},{"sampler":1,"target":{"node":2,"path":"rotation"}}]}])";
  std::string text() const {
    return maker_.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0]}],"nodes":[{)" + reed + "}," +
                       knots + R"(],"animations":)" + animations);
  }
  SourceModel import(const Settings& settings = {}) const {
    return importFile(scratch_.write("reed.gltf", text()), settings);
  }
  const Scratch& scratch() const { return scratch_; }

 private:
  Scratch scratch_;
  GltfMaker maker_;
};

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
}

TEST(ImportKnots, StraightEmptiesAreExactlyAStraightRig) {
  const SourceModel model = Reed().import();
  ASSERT_EQ(model.parts.size(), 1u);
  const SourcePart& part = model.parts[0];
  EXPECT_EQ(part.name, "Reed");
  EXPECT_EQ(part.rig.axis, Axis::kPlusY);
  ASSERT_EQ(part.rig.knots.size(), 3u);
  const float at[] = {0, 0.5f, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(part.rig.knots[i].at, at[i]);
    EXPECT_EQ(part.rig.knots[i].offset, glm::vec3(0));
    EXPECT_FALSE(part.rig.knots[i].tangent) << "automatic";
  }
  EXPECT_TRUE(contains(part.rig_origin, "3 knot empties")) << part.rig_origin;
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
}

TEST(ImportKnots, KeysBecomeAClipInUnitsOfTheExtent) {
  const SourceModel model = Reed().import();
  const auto& clips = model.parts[0].rig.clips;
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].name, "sway");
  EXPECT_EQ(clips[0].duration, 1.0f);
  ASSERT_EQ(clips[0].tracks.size(), 2u);
  for (const auto& track : clips[0].tracks) {
    if (track.target == Target::kKnotOffset) {
      EXPECT_EQ(track.knot, 2);
      ASSERT_EQ(track.keys.size(), 2u);
      expectNear(glm::vec3(track.keys[0].value), {0, 0, 0});
      expectNear(glm::vec3(track.keys[1].value), {0.2f, 0.1f, 0});  // (0.4, 0.2, 0) over an extent of 2
    } else {
      EXPECT_EQ(track.target, Target::kKnotTangent);
      EXPECT_EQ(track.knot, 1);
      ASSERT_GE(track.keys.size(), 30u);
      // the tangent (-sin, cos, 0) of a turn at constant speed, minus (0, 1, 0)
      for (const auto& key : track.keys) {
        const float angle = key.time * 1.57079633f;
        expectNear(glm::vec3(key.value), {-std::sin(angle), std::cos(angle) - 1, 0}, 1e-5f);
      }
    }
  }
}

TEST(ImportKnots, TheMeshNodesOwnMotionIsRelativeToItsRest) {
  Reed reed;
  reed.reed =
      R"("name":"Reed","mesh":0,"children":[1,2,3],"translation":[1,0,0],"rotation":[0,0.70710678,0,0.70710678],"scale":[2,2,2])";
  reed.animations = R"([{"name":"walk","samplers":[{"input":2,"output":5},{"input":2,"output":6}],
      "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},{"sampler":1,"target":{"node":0,"path":"rotation"}}]}])";
  const SourceModel model = reed.import();
  const SourcePart& part = model.parts[0];
  // World = T(t) R(t) S0 must equal pivot D(t) pivot^-1 World(0).
  const auto& tracks = part.rig.clips.at(0).tracks;
  ASSERT_EQ(tracks.size(), 2u);
  expectNear(part.pivot[3], {1, 0, 0});
  expectNear(part.pivot * glm::vec4(0, 0, 1, 0), {1, 0, 0});  // turned by 90 degrees about y
  expectNear(part.to_object * glm::vec4(0, 2, 0, 1), {1, 4, 0});
  expectNear(glm::vec3(tracks[0].keys[1].value), {0, 3, 0});
  // From no turn to the rest's turn: relative to rest, from -90 degrees to none.
  EXPECT_NEAR(tracks[1].keys[0].value.y, -kHalf, 1e-5);
  EXPECT_NEAR(tracks[1].keys[0].value.w, kHalf, 1e-5);
  EXPECT_NEAR(tracks[1].keys[1].value.w, 1, 1e-5);
}

TEST(ImportKnots, AFishAlongXNeedsNoTurnedEmpties) {
  Reed reed;
  reed.knots =
      R"({"name":"knot_0","translation":[0.1,1,0]},{"name":"knot_1","translation":[0,1,0]},{"name":"knot_2","translation":[-0.1,1,0]})";
  reed.animations = "[]";
  const SourceModel model = reed.import();
  const auto& rig = model.parts[0].rig;
  EXPECT_EQ(rig.axis, Axis::kMinusX);
  ASSERT_EQ(rig.knots.size(), 3u);
  EXPECT_NEAR(rig.knots[1].at, 0.5f, 1e-6);
  EXPECT_FALSE(rig.knots[1].tangent) << "automatic";
  EXPECT_TRUE(anyContains(model.notices, "+Y axis does not point along"));
}

// Half a turn: knot.1 points to the side, knot.2 hangs down beside the root.
constexpr char kHook[] =
    R"({"name":"knot.0"},{"name":"knot.1","translation":[0.6,0.6,0],"rotation":[0,0,-0.70710678,0.70710678]},
       {"name":"knot.2","translation":[1.2,0,0],"rotation":[0,0,1,0]})";

TEST(ImportKnots, OfASweptPartTheyMayTurnBack) {
  Reed reed;
  reed.knots = kHook;
  reed.animations = "[]";
  const auto check = [&](const SourceModel& model, float roll) {
    const RigDescription& rig = model.parts.at(0).rig;
    EXPECT_EQ(rig.bend, Bend::kSweep);
    EXPECT_EQ(rig.roll, roll);
    ASSERT_EQ(rig.knots.size(), 3u);
    EXPECT_NEAR(rig.knots[1].at, 0.5f, 1e-6);
    expectNear(rig.knots[1].offset, {0.3f, -0.2f, 0});
    expectNear(rig.knots[1].tangent.value(), {1, 0, 0});
    EXPECT_EQ(rig.knots[2].at, 1);
    expectNear(rig.knots[2].offset, {0.6f, -1, 0});
    expectNear(rig.knots[2].tangent.value(), {0, -1, 0});
    EXPECT_FALSE(rig.knots[0].tangent);
    // 2 x 0.6 sqrt(2) of a reed of length 2
    EXPECT_TRUE(anyContains(model.notices, "are 85 % of the mesh's length"));
  };
  Settings swept;
  swept.bend = Bend::kSweep;
  check(reed.import(swept), 0);
  reed.reed += R"(,"extras":{"kelp":{"kelp":1,"bend":"sweep","roll":30}})";
  check(reed.import(), rollOfDegrees(30));
  EXPECT_EQ(reed.import().parts.at(0).rig_origin,
            "3 knot empties of node 'Reed', which bend as extras.kelp of node 'Reed' says");
}

// Arrows that point aside mean nothing to a sheared part, nor to a swept one whose first was never turned.
TEST(ImportKnots, EmptiesThatWereNeverTurnedAreStraight) {
  Reed reed;
  reed.animations = "[]";
  const std::string aside = R"(,"rotation":[0,0,-0.70710678,0.70710678]})";
  reed.knots =
      R"({"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.2","translation":[0,2,0])" +
      aside;
  EXPECT_FALSE(reed.import().parts.at(0).rig.knots.at(2).tangent);
  Settings swept;
  swept.bend = Bend::kSweep;
  EXPECT_TRUE(reed.import(swept).parts.at(0).rig.knots.at(2).tangent);
  reed.knots = R"({"name":"knot.0")" + aside + R"(,{"name":"knot.1","translation":[0,1,0])" + aside +
               R"(,{"name":"knot.2","translation":[0,2,0])" + aside;
  const SourceModel model = reed.import(swept);
  for (const RigDescription::Knot& knot : model.parts.at(0).rig.knots) {
    EXPECT_FALSE(knot.tangent);
    expectNear(knot.offset, {0, 0, 0});
  }
}

TEST(ImportKnots, BlendersActionNamesJoinIntoOneClip) {
  Reed reed;
  reed.knots =
      R"({"name":"knot.0"},{"name":"knot.1.002","translation":[0,1,0]},{"name":"knot.2.001","translation":[0,2,0]})";
  reed.animations =
      R"([{"name":"knot.2.001Action","samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"node":3,"path":"translation"}}]},
      {"name":"knot.1.002Action.001","samplers":[{"input":2,"output":4}],"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}]}])";
  const SourceModel model = reed.import();
  ASSERT_EQ(model.parts[0].rig.clips.size(), 1u);
  EXPECT_EQ(model.parts[0].rig.clips[0].name, "Reed");
  EXPECT_EQ(model.parts[0].rig.clips[0].tracks.size(), 2u);
}

TEST(ImportKnots, GapsDoublesAndDisorderMakeANoticeAndNoRig) {
  for (
      const std::string knots :
      {R"({"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.3","translation":[0,2,0]})",
       R"({"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.1.001","translation":[0,2,0]})",
       R"({"name":"knot.0"},{"name":"knot.1","translation":[0,2.5,0]},{"name":"knot.2","translation":[0,2,0]})"}) {
    Reed reed;
    reed.knots = knots;
    const SourceModel model = reed.import();
    EXPECT_TRUE(model.parts[0].rig.knots.empty());
    EXPECT_TRUE(anyContains(model.notices, "no rig is made")) << knots;
  }
}

TEST(ImportKnots, KnotsAwayFromTheEndsAreTakenThereWithANotice) {
  Reed reed;
  reed.knots =
      R"({"name":"knot.0","translation":[0,0.3,0]},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.2","translation":[0,2,0]})";
  const SourceModel model = reed.import();
  EXPECT_EQ(model.parts[0].rig.knots[0].at, 0.0f);
  EXPECT_TRUE(anyContains(model.notices, "knot.0 of node 'Reed' lies 15 %"));
}

TEST(ImportKnots, ExtrasMakePartsAndNestedPartsHaveParents) {
  Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string rig = R"("extras":{"kelp":{"kelp":1}})";
  const SourceModel model = importFile(scratch.write("herd.gltf",
                                                     maker.text(GltfMaker::boxMesh() + R"(,"nodes":[
      {"name":"Stone","mesh":0},
      {"name":"Stem","mesh":0,"translation":[5,0,0],"children":[2,3],)" +
                                                                rig + R"(},
      {"name":"Leaf","mesh":0,"translation":[0,2,0],)" + rig + R"(},
      {"name":"Bud","mesh":0,"translation":[0,2,1]}],"scenes":[{"nodes":[0,1]}])")),
                                       {});
  ASSERT_EQ(model.parts.size(), 3u);
  EXPECT_EQ(model.parts[0].name, "herd");
  EXPECT_EQ(model.parts[0].parent, -1);
  EXPECT_EQ(model.parts[0].soup.triangles.size(), 12u);
  EXPECT_EQ(model.parts[1].name, "Stem");
  EXPECT_EQ(model.parts[1].parent, -1);
  EXPECT_EQ(model.parts[1].soup.triangles.size(), 24u);  // with the bud
  EXPECT_EQ(model.parts[2].name, "Leaf");
  EXPECT_EQ(model.parts[2].parent, 1);
  expectNear(model.parts[2].to_object[3], {5, 2, 0});
  EXPECT_TRUE(contains(model.parts[2].rig_origin, "extras.kelp of node 'Leaf'"));
}

// The box as a node beside `others`, with `rest` as further members of the file.
SourceModel importBox(const Scratch& scratch, const std::string& box, const std::string& others = "",
                      const std::string& rest = "") {
  GltfMaker maker;
  maker.addBox();
  return importFile(
      scratch.write("box.gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":[{"name":"Box","mesh":0)" +
                                           box + "}" + others + "]" + rest)),
      {});
}

constexpr const char* kLooseKnots =
    R"(,{"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.2","translation":[0,2,0]})";

TEST(ImportKnots, KnotsThatNobodyParentedBendTheOnlyModel) {
  Reed reed;
  reed.reed = R"("name":"Reed","mesh":0)";
  const std::string text = reed.text();
  const std::string all = R"("scenes":[{"nodes":[0,1,2,3]}])", one = R"("scenes":[{"nodes":[0]}])";
  const SourceModel model = importFile(
      reed.scratch().write("loose.gltf", std::string(text).replace(text.find(one), one.size(), all)), {});
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].rig_origin, "3 knot empties of the scene");
  ASSERT_EQ(model.parts[0].rig.knots.size(), 3u);
  EXPECT_EQ(model.parts[0].rig.knots[1].at, 0.5f);
  // Their keys move them as though they were the mesh's.
  const std::vector<RigDescription::Clip> owned = Reed().import().parts[0].rig.clips;
  EXPECT_EQ(model.parts[0].rig.clips, owned);
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
}

TEST(ImportKnots, KnotsThatNobodyParentedAreNeverPassedOverInSilence) {
  const Scratch scratch;
  // Two models: whose knots are they?
  SourceModel model = importBox(
      scratch, "", std::string(kLooseKnots) + R"(,{"name":"Other","mesh":0,"translation":[3,0,0]})");
  EXPECT_TRUE(model.parts[0].rig.knots.empty());
  EXPECT_TRUE(anyContains(model.notices, "parent them to the mesh")) << model.notices.size();
  // Another rig in the file.
  model = importBox(scratch, R"(,"extras":{"kelp":{"kelp":1}})", kLooseKnots);
  EXPECT_EQ(model.parts.at(0).rig_origin, "extras.kelp of node 'Box'");
  EXPECT_TRUE(anyContains(model.notices, "parent them to the mesh"));
  // Far away from the mesh.
  model = importBox(scratch, R"(,"translation":[9,0,0])", kLooseKnots);
  EXPECT_TRUE(model.parts[0].rig.knots.empty());
  EXPECT_TRUE(anyContains(model.notices, "parent them to it"));
  // Below an empty of their own.
  model = importBox(
      scratch, "",
      R"(,{"name":"Rig","children":[2,3]},{"name":"knot.0"},{"name":"knot.1","translation":[0,2,0]})");
  EXPECT_TRUE(anyContains(model.notices, "parent the knots to the mesh"));
  // A mesh of that name is no empty.
  model = importBox(scratch, "", R"(,{"name":"knot.0","mesh":0})");
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
}

TEST(ImportKnots, ExtrasOfAMeshAreTheRigOfItsOnlyNode) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const std::string mesh =
      R"("meshes":[{"name":"Blade","primitives":[{"attributes":{"POSITION":0},"indices":1}],"extras":{"kelp":"{\"kelp\":1,\"axis\":\"-y\"}"}}],"nodes":[{"name":"Box","mesh":0)";
  const auto import = [&](const std::string& nodes) {
    return importFile(scratch.write("blade.gltf", maker.text(mesh + nodes)), {});
  };
  SourceModel model = import("}]");
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].rig_origin, "extras.kelp of mesh 'Blade'");
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kMinusY);
  EXPECT_EQ(model.parts[0].name, "Box");
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
  model = import(R"(},{"mesh":0,"translation":[1,0,0]}])");
  EXPECT_FALSE(model.parts[0].rig.axis);
  EXPECT_TRUE(anyContains(model.notices, "mesh 'Blade': 2 nodes use the mesh: no rig is made of it"));
  model = import(R"(,"extras":{"kelp":{"kelp":1,"axis":"+x"}}}])");
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kPlusX);
  EXPECT_TRUE(anyContains(model.notices, "the node's is the rig"));
}

TEST(ImportKnots, ExtrasOfTheSceneOrTheFileAreTheRigOfAllThatHasNone) {
  const Scratch scratch;
  const std::string rig = R"("extras":{"kelp":{"kelp":1,"axis":"+z"}})",
                    scene = R"(,"scenes":[{"name":"Scene","nodes":[0,1],)" + rig + "}]";
  const std::string other =
                        R"(,{"name":"Other","mesh":0,"translation":[3,0,0],"extras":{"kelp":{"kelp":1}}})",
                    plain = R"(,{"mesh":0,"translation":[3,0,0]})";
  SourceModel model = importBox(scratch, "", plain, scene);
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].rig_origin, "extras.kelp of scene 'Scene'");
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kPlusZ);
  EXPECT_TRUE(model.notices.empty()) << model.notices[0];
  model = importBox(scratch, "", other, scene);
  ASSERT_EQ(model.parts.size(), 2u);
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kPlusZ);
  EXPECT_FALSE(model.parts[1].rig.axis);
  model = importBox(scratch, "", plain, "," + rig);
  EXPECT_EQ(model.parts[0].rig_origin, "extras.kelp of the file's top");
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kPlusZ);
  model = importBox(scratch, R"(,"extras":{"kelp":{"kelp":1}})", "", "," + rig);
  EXPECT_TRUE(anyContains(model.notices, "extras.kelp of the file's top bends nothing"));
}

TEST(ImportKnots, ExtrasThatAreTheRigOfNothingAreNamed) {
  const Scratch scratch;
  const std::string rig = R"("extras":{"kelp":{"kelp":1}})";
  const SourceModel model = importBox(scratch, "", R"(,{"name":"Hidden","mesh":0,)" + rig + "}",
                                      R"(,"scenes":[{"nodes":[0]},{"nodes":[1],)" + rig + R"(}],"scene":0)");
  for (const char* place : {"nodes[1].extras.kelp", "scenes[1].extras.kelp"})
    EXPECT_TRUE(anyContains(model.notices, place)) << place;
}

TEST(ImportKnots, BrokenExtrasNameTheNode) {
  Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto path = scratch.write(
      "m.gltf", maker.text(GltfMaker::boxMesh() +
                           R"(,"nodes":[{"name":"Stem","mesh":0,"extras":{"kelp":{"kelp":1,"knobs":[]}}}])"));
  const std::string message = refusal(path, Exit::kInvalid);
  EXPECT_TRUE(contains(message, "Stem") && contains(message, "knobs")) << message;
}

TEST(ImportRig, FileBeatsPresetBeatsNeighborBeatsKnots) {
  Reed reed;
  const auto rig = reed.scratch().write("mine.rig.json", R"({"kelp":1,"axis":"+z"})");
  Settings settings;
  EXPECT_TRUE(contains(reed.import(settings).parts[0].rig_origin, "knot empties"));
  reed.scratch().write("reed.rig.json", R"({"kelp":1,"axis":"-z"})");
  SourceModel model = reed.import(settings);
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kMinusZ);
  EXPECT_EQ(model.parts[0].rig_origin, "reed.rig.json beside the input");
  EXPECT_FALSE(anyContains(model.notices, "reed.rig.json")) << "said twice";
  settings.rig_preset = "sway";
  EXPECT_EQ(reed.import(settings).parts[0].rig_origin, "preset 'sway', not reed.rig.json beside the input");
  settings.rig_file = rig;
  model = reed.import(settings);
  EXPECT_EQ(model.parts[0].rig_origin, "rig file mine.rig.json");
  EXPECT_EQ(model.parts[0].rig.axis, Axis::kPlusZ);
  EXPECT_EQ(model.parts[0].name, "reed");
  settings.rig_file.reset();
  settings.rig_preset = "jump";
  refusal(reed.scratch().folder() / "reed.gltf", Exit::kUsage, settings);
  settings.rig_file = "swya";  // what a typing error in a preset's name comes out as
  const std::string message = refusal(reed.scratch().folder() / "reed.gltf", Exit::kIo, settings);
  EXPECT_TRUE(contains(message, "swya: ") && contains(message, "none, sway, swim, breathe, twist"))
      << message;
}

TEST(ImportRig, AnAxisIsForRigsThatNameNone) {
  Reed reed;
  const std::filesystem::path gltf = reed.scratch().write("reed.gltf", reed.text());
  Settings settings;
  settings.axis = Axis::kPlusX;
  settings.rig_file = reed.scratch().write("none.rig.json", R"({"kelp":1})");
  EXPECT_EQ(importFile(gltf, settings).parts[0].rig.axis, Axis::kPlusX);
  settings.rig_file = reed.scratch().write("same.rig.json", R"({"kelp":1,"axis":"+x"})");
  EXPECT_EQ(importFile(gltf, settings).parts[0].rig.axis, Axis::kPlusX);
  settings.rig_file = reed.scratch().write("other.rig.json", R"({"kelp":1,"axis":"-z"})");
  std::string message = refusal(gltf, Exit::kUsage, settings);
  EXPECT_TRUE(contains(message, "--axis +x: the rig (rig file other.rig.json) names the axis -z itself; "))
      << message;
  settings.rig_file.reset();
  reed.scratch().write("reed.rig.json", R"({"kelp":1,"axis":"+y"})");
  message = refusal(gltf, Exit::kUsage, settings);
  EXPECT_TRUE(contains(message, "reed.rig.json")) << message;
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  message = refusal(
      scratch.write(
          "own.gltf",
          maker.text(GltfMaker::boxMesh() +
                     R"(,"nodes":[{"name":"Stem","mesh":0,"extras":{"kelp":{"kelp":1,"axis":"+y"}}}])")),
      Exit::kUsage, settings);
  EXPECT_TRUE(contains(message, "extras.kelp of node 'Stem'")) << message;
}

}  // namespace
}  // namespace kelp::bake::test
