// SPDX-License-Identifier: MIT
// Parts that move as the nodes of their file do, and files baked at a moment, against a second reader of the
// same files.
#include <algorithm>
#include <cmath>
#include <map>

#include "baked_asset.h"
#include "gltf_truth.h"
#include "import_scratch.h"
#include "support/assets.h"
#include "support/voxel_points.h"

namespace kelp::bake::test {
namespace {

glm::dmat4 asMatrix(const glm::mat4x3& m) {
  glm::dmat4 out(1);
  for (int c = 0; c < 4; ++c) out[c] = glm::dvec4(glm::dvec3(m[c]), c == 3 ? 1.0 : 0.0);
  return out;
}

// Every corner of every mesh is where the file's nodes take it at that time of the clip. `rest`: the moment
// at which the pack was baked.
struct Rest {
  int animation = -1;
  double time = 0;
};
void expectFollows(const BakedAsset& baked, const GltfTruth& truth, const std::map<std::string, int>& nodes,
                   const std::string& clip, int animation, const std::vector<double>& times, double tolerance,
                   const Rest& rest = {}) {
  const int index = runtime::findClip(baked.asset(), clip).value();
  ASSERT_GE(index, 0) << clip;
  for (const double time : times) {
    runtime::Pose pose = *runtime::Pose::create(baked.asset());
    ASSERT_TRUE(runtime::addClip(baked.asset(), index, time, 1, pose));
    const runtime::Instance instance{&baked.asset(), &pose};
    const Box box = runtime::bounds(instance);
    for (const auto& [name, node] : nodes) {
      const int part = baked.partNamed(name);
      const RawPart& raw = baked.pack().parts[static_cast<std::size_t>(part)];
      const glm::dmat4 to_voxel =
          glm::inverse(asMatrix(raw.to_object)) * truth.world(node, rest.animation, rest.time);
      const glm::dmat4 world = truth.world(node, animation, time);
      double worst = 0, beyond = 0;
      for (const glm::dvec3& corner : truth.corners(node)) {
        const glm::dvec3 voxel(to_voxel * glm::dvec4(corner, 1));
        for (int c = 0; c < 3; ++c) beyond = std::max({beyond, -voxel[c], voxel[c] - raw.size[c]});
        const glm::dvec3 wanted(world * glm::dvec4(corner, 1)),
            got(kelp::test::voxelToWorld(instance, part, glm::vec3(voxel)));
        worst = std::max(worst, glm::length(wanted - got));
        for (int c = 0; c < 3; ++c)
          EXPECT_TRUE(wanted[c] > static_cast<double>(box.min[c]) - tolerance &&
                      wanted[c] < static_cast<double>(box.max[c]) + tolerance)
              << name;
      }
      EXPECT_LT(worst, tolerance) << name << " at " << time;
      EXPECT_LT(beyond, 1e-3) << name << " lies outside of its part's box";
    }
  }
}

TEST(Parts, TheTruckTurnsItsWheels) {
  KELP_ASSET(path, "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf");
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(path, settings, 48);
  ASSERT_EQ(baked.pack().parts.size(), 3u);
  EXPECT_EQ(baked.pack().parts[1].parent, 0);
  EXPECT_EQ(baked.pack().parts[2].parent, 0);
  EXPECT_TRUE(baked.report.notices.empty()) << baked.report.notices[0];
  ASSERT_EQ(baked.pack().clips.size(), 1u);
  EXPECT_EQ(baked.pack().clips[0].duration, 1.25f);
  const std::map<std::string, int> nodes{{"Cesium_Milk_Truck", 0}, {"Wheels", 4}, {"Wheels.2", 2}};
  expectFollows(baked, GltfTruth(path), nodes, "animation 0", 0, {0, 0.1, 0.31, 0.625, 0.9, 1.2}, 1e-5);
}

TEST(Parts, OnePartIsTheDefault) {
  KELP_ASSET(path, "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf");
  const SourceModel model = importFile(path, {});
  EXPECT_EQ(model.parts.size(), 1u);
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "--parts nodes")) << model.notices[0];
}

// A stand, and a chain of nodes that move one within the other: two without meshes, of which one is stretched
// and one mirrored and turned askew, an arm, a hand that is stretched again and hangs on it, and a plate that
// only the two without meshes move.
class Robot {
 public:
  Robot() {
    maker_.addBox();
    const float c = 0.92388f, s = 0.38268f;
    times_ = maker_.floats({0.25f, 1, 2}, 1);
    steps_ = maker_.floats({0, 0, 0, 1, 0.5f, 0, 3, 0, -1}, 3);
    // the last one by the longer way around, if its sign were taken at its word
    turns_ = maker_.floats({0, 0, 0, 1, s, 0, 0, c, 0, -c, 0, -s}, 4);
    // In, value, out.
    smooth_ = maker_.floats({0, 0,    0, 0, 0, 0, s, c, 0.3f, 0, 0, 0,  //
                             0, 0.5f, 0, 0, 0, s, 0, c, 0,    0, 1, 0,  //
                             0, 0,    0, 1, 0, 0, 0, 1, 0,    0, 0, 0},
                            4);
    sizes_ = maker_.floats({1, 1, 1, 2, 0.5f, 1, 1.5f, 1.5f, 0.25f}, 3);
    places_ = maker_.floats({0.1f, 0, 0, 0, 2, 0, 0, 0, 0.2f,  //
                             0,    0, 0, 1, 2, 0, 0, 1, 0,     //
                             0,    0, 1, 0, 3, 1, 0, 0, 0},
                            3);
  }
  std::string nodes = R"({"name":"stand","mesh":0,"scale":[5,0.1,5]},
      {"name":"base","children":[2],"translation":[1,0,0],"scale":[1,2,0.5]},
      {"name":"shoulder","children":[3,5],"translation":[0,1,0],"rotation":[0.1,0.2,0.3,0.92736],"scale":[-1,1,1]},
      {"name":"arm","mesh":0,"children":[4],"translation":[0,1,0],"rotation":[0.5,0.5,0.5,0.5],"scale":[1.5,1,1]},
      {"name":"hand","mesh":0,"translation":[0,2,0],"scale":[3,0.3,2]},
      {"name":"plate","mesh":0,"translation":[1,0,0],"rotation":[0,0,0.70710678,0.70710678]})";
  std::filesystem::path write(const Scratch& scratch) const {
    const auto sampler = [&](int output, const char* how) {
      return R"({"input":)" + std::to_string(times_) + R"(,"output":)" + std::to_string(output) +
             R"(,"interpolation":")" + how + "\"}";
    };
    const auto channel = [](int at, int node, const char* path) {
      return R"({"sampler":)" + std::to_string(at) + R"(,"target":{"node":)" + std::to_string(node) +
             R"(,"path":")" + path + "\"}}";
    };
    const std::string wave = R"({"name":"wave","samplers":[)" + sampler(steps_, "STEP") + "," +
                             sampler(smooth_, "CUBICSPLINE") + "," + sampler(turns_, "LINEAR") + "," +
                             sampler(sizes_, "LINEAR") + R"(],"channels":[)" + channel(0, 1, "translation") +
                             "," + channel(1, 2, "rotation") + "," + channel(2, 3, "rotation") + "," +
                             channel(3, 3, "scale") + "]}";
    const std::string reach = R"({"name":"reach","samplers":[)" + sampler(places_, "CUBICSPLINE") + "," +
                              sampler(sizes_, "STEP") + R"(],"channels":[)" + channel(0, 3, "translation") +
                              "," + channel(1, 2, "scale") + "]}";
    return scratch.write(
        "robot.gltf", maker_.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0,1]}],"nodes":[)" + nodes +
                                  R"(],"animations":[)" + wave + "," + reach + "]"));
  }

 private:
  GltfMaker maker_;
  int times_, steps_, turns_, smooth_, sizes_, places_;
};

const std::map<std::string, int> kRobot{{"stand", 0}, {"arm", 3}, {"hand", 4}, {"plate", 5}};
const std::vector<double> kTimes{0, 0.25, 0.4, 0.7, 0.999, 1, 1.3, 1.77, 1.999};

// Robot with each node a part, beside what a second reader makes of its file.
struct BakedRobot {
  explicit BakedRobot(const std::optional<Moment>& at = std::nullopt)
      : path(Robot().write(scratch)), truth(path), baked(path, settingsOf(at), 40) {}

  Scratch scratch;
  std::filesystem::path path;
  GltfTruth truth;
  BakedAsset baked;

 private:
  static Settings settingsOf(const std::optional<Moment>& at) {
    Settings settings;
    settings.parts = Parts::kNodes;
    settings.at = at;
    return settings;
  }
};

TEST(Parts, ChainsOfStretchedMirroredAndTurningNodesAreExact) {
  const BakedRobot robot;
  const BakedAsset& baked = robot.baked;
  EXPECT_TRUE(baked.report.notices.empty()) << baked.report.notices[0];
  ASSERT_EQ(baked.pack().parts.size(), 6u);  // with two that hold no voxels
  const auto& parts = baked.pack().parts;
  const auto parentOf = [&](const std::string& name) {
    return parts[static_cast<std::size_t>(parts[static_cast<std::size_t>(baked.partNamed(name))].parent)]
        .name;
  };
  EXPECT_EQ(parentOf("hand"), "arm");
  EXPECT_EQ(parentOf("arm"), "shoulder");
  EXPECT_EQ(parentOf("plate"), "shoulder");
  EXPECT_EQ(parentOf("shoulder"), "base");
  ASSERT_EQ(baked.pack().clips.size(), 2u);
  expectFollows(baked, robot.truth, kRobot, "wave", 0, kTimes, 4e-5);
  expectFollows(baked, robot.truth, kRobot, "reach", 1, kTimes, 4e-5);
}

TEST(Parts, ClipsStartFromTheMomentThatIsBaked) {
  const BakedRobot robot(Moment{"wave", 0.7});
  expectFollows(robot.baked, robot.truth, kRobot, "wave", 0, kTimes, 4e-5, {0, 0.7});
}

// A node without a mesh that moves but one part, or several that do not move by themselves, needs no part of
// its own.
TEST(Parts, OneMoverNeedsNoPartOfItsOwn) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), turns = maker.floats({0, 0, 0, 1, 0, 0.6f, 0, 0.8f}, 4);
  const auto path = scratch.write(
      "m.gltf",
      maker.text(GltfMaker::boxMesh() +
                 R"(,"nodes":[{"name":"spin","children":[1,2],"translation":[4,0,0]},{"name":"a","mesh":0},
      {"name":"b","mesh":0,"translation":[1,0,0],"children":[3]},{"name":"c","mesh":0,"translation":[0,2,0]}],"animations":[{"name":"spinAction","samplers":[{"input":)" +
                 std::to_string(times) + R"(,"output":)" + std::to_string(turns) +
                 R"(}],"channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}])"));
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(path, settings, 16);
  EXPECT_EQ(baked.pack().parts.size(), 3u);
  expectFollows(baked, GltfTruth(path), {{"a", 1}, {"b", 2}, {"c", 3}}, "spin", 0, {0, 0.3, 0.99}, 1e-5);
}

// A mesh with two joints whose root turns: the joints do not move against each other, so the mesh moves as a
// whole, wherever its own node is.
TEST(Parts, SkinsFollowTheNodeThatAllTheirJointsHangOn) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto [j, w] = maker.addBoxWeights({1, 0}, {0.25f, 0.75f});
  const int times = maker.floats({0, 1}, 1), turns = maker.floats({0, 0, 0, 1, 0, 0.6f, 0, 0.8f}, 4);
  const std::string file =
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":)" + std::to_string(j) +
      R"(,"WEIGHTS_0":)" + std::to_string(w) +
      R"(},"indices":1}]}],"skins":[{"joints":[2,3]}],"nodes":[{"name":"body","mesh":0,"skin":0,"translation":[50,0,0]},{"name":"root","children":[2,3],"translation":[1,0,0]},
      {"name":"hip","translation":[0,1,0]},{"name":"head","translation":[0,2,0]}],"animations":[{"name":"turn","samplers":[{"input":)" +
      std::to_string(times) + R"(,"output":)" + std::to_string(turns) +
      R"(}],"channels":[{"sampler":0,"target":{"node":1,"path":"rotation"}}]}])";
  const auto path = scratch.write("m.gltf", maker.text(file));
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(path, settings, 16);
  ASSERT_EQ(baked.pack().parts.size(), 1u);
  EXPECT_FALSE(anyContains(baked.report.notices, "'turn'"));
  const GltfTruth truth(path);
  const std::vector<glm::dvec3> rest = truth.worldCorners(0, -1, 0);
  for (const double time : {0.2, 0.9}) {
    runtime::Pose pose = *runtime::Pose::create(baked.asset());
    ASSERT_TRUE(runtime::addClip(baked.asset(), 0, time, 1, pose));
    const std::vector<glm::dvec3> wanted = truth.worldCorners(0, 0, time);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const glm::vec3 voxel(glm::inverse(asMatrix(baked.pack().parts[0].to_object)) * glm::dvec4(rest[i], 1));
      EXPECT_LT(
          glm::length(wanted[i] - glm::dvec3(kelp::test::voxelToWorld({&baked.asset(), &pose}, 0, voxel))),
          1e-5);
    }
  }
}

// The second "take" moves what the first one does: it is a clip of its own for every node that it moves.
TEST(Parts, AnimationsOfOneNameAreToldApartForAllNodesAlike) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), places = maker.floats({0, 0, 0, 0, 3, 0}, 3);
  const std::string sampler =
      R"("samplers":[{"input":)" + std::to_string(times) + R"(,"output":)" + std::to_string(places) + "}]";
  const std::string a = R"({"sampler":0,"target":{"node":0,"path":"translation"}})",
                    b = R"({"sampler":0,"target":{"node":1,"path":"translation"}})";
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(
      scratch.write(
          "m.gltf",
          maker.text(
              GltfMaker::boxMesh() +
              R"(,"nodes":[{"name":"a","mesh":0},{"name":"b","mesh":0}],"animations":[{"name":"take",)" +
              sampler + R"(,"channels":[)" + a + R"(]},{"name":"take",)" + sampler + R"(,"channels":[)" + a +
              "," + b + "]}]")),
      settings, 8);
  ASSERT_EQ(baked.pack().clips.size(), 2u);
  EXPECT_EQ(baked.pack().clips[0].name, "take");
  EXPECT_EQ(baked.pack().clips[0].tracks.size(), 1u);
  EXPECT_EQ(baked.pack().clips[1].name, "take.2");
  EXPECT_EQ(baked.pack().clips[1].tracks.size(), 2u);
}

// A reed with a rig, a leaf that is still, and a bird on it that moves: the leaf bends with the reed, the
// bird is a part of its own.
TEST(Parts, RigsKeepWhatTheyBendAndLetGoOfWhatMoves) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), places = maker.floats({0, 2, 0, 0, 3, 0}, 3);
  const auto path = scratch.write(
      "m.gltf",
      maker.text(
          GltfMaker::boxMesh() +
          R"(,"nodes":[{"name":"reed","mesh":0,"children":[1,2],"extras":{"kelp":{"kelp":1,"clips":{"go":{"waves":
      [{"knot":1,"offset":[0.1,0,0],"period":1}]}}}}},{"name":"leaf","mesh":0,"translation":[0,1,0],"rotation":[0,0,0.70710678,0.70710678]},
      {"name":"bird","mesh":0,"translation":[0,2,0],"scale":[0.5,0.1,0.5]}],"animations":[{"name":"go","samplers":[{"input":)" +
          std::to_string(times) + R"(,"output":)" + std::to_string(places) +
          R"(}],"channels":[{"sampler":0,"target":{"node":2,"path":"translation"}}]}])"));
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(path, settings, 32);
  ASSERT_EQ(baked.pack().parts.size(), 2u);
  EXPECT_EQ(baked.report.parts[0].triangles, 24u);
  EXPECT_EQ(baked.pack().parts[1].parent, 0);
  ASSERT_EQ(baked.pack().clips.size(), 1u);  // bends and moves in one
  EXPECT_EQ(baked.pack().clips[0].waves.size(), 1u);
  EXPECT_EQ(baked.pack().clips[0].tracks.size(), 1u);
  expectFollows(baked, GltfTruth(path), {{"bird", 2}}, "go", 0, {0, 0.5}, 1e-5);
}

// The knots stand at the top of the scene: what they bend stays where it is while the bird flies.
TEST(Parts, TheScenesOwnRigFollowsNoNode) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), places = maker.floats({0, 2, 0, 0, 3, 0}, 3);
  const auto path = scratch.write(
      "m.gltf",
      maker.text(GltfMaker::boxMesh() +
                 R"(,"scenes":[{"nodes":[0,2,3,4]}],"nodes":[{"name":"reed","mesh":0,"children":[1]},
      {"name":"bird","mesh":0,"translation":[0,2,0],"scale":[0.5,0.1,0.5]},{"name":"knot.0"},{"name":"knot.1","translation":[0,0.5,0]},{"name":"knot.2","translation":[0,1,0]}],
      "animations":[{"name":"go","samplers":[{"input":)" +
                 std::to_string(times) + R"(,"output":)" + std::to_string(places) +
                 R"(}],"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}]}])"));
  Settings settings;
  settings.parts = Parts::kNodes;
  const BakedAsset baked(path, settings, 32);
  ASSERT_EQ(baked.pack().parts.size(), 2u);
  for (const RawPart& part : baked.pack().parts) EXPECT_EQ(part.parent, -1) << part.name;
  const int bird = baked.partNamed("bird");
  ASSERT_EQ(baked.pack().clips.size(), 1u);
  for (const auto& track : baked.pack().clips[0].tracks) EXPECT_EQ(track.part, bird);
  expectFollows(baked, GltfTruth(path), {{"bird", 1}}, "go", 0, {0, 0.5}, 1e-5);
}

TEST(Parts, WhatNoPartCanFollowIsSaid) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), places = maker.floats({0, 0, 0, 0, 3, 0}, 3),
            sizes = maker.floats({0, 0, 0, 1, 1, 1}, 3);
  const std::string samplers = R"("samplers":[{"input":)" + std::to_string(times) + R"(,"output":)" +
                               std::to_string(places) + R"(},{"input":)" + std::to_string(times) +
                               R"(,"output":)" + std::to_string(sizes) + "}]";
  const auto notices = [&](const std::string& nodes, const std::string& channel) {
    Settings settings;
    settings.parts = Parts::kNodes;
    return importFile(scratch.write("m.gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":[)" + nodes +
                                                         R"(],"animations":[{)" + samplers +
                                                         R"(,"channels":[)" + channel + "]}]")),
                      settings)
        .notices;
  };
  // Flat at rest: a factor leads nowhere.
  EXPECT_TRUE(anyContains(notices(R"({"name":"Pop","mesh":0,"scale":[1,0,1]})",
                                  R"({"sampler":1,"target":{"node":0,"path":"scale"}})"),
                          "node 'Pop' has a scale of zero at rest"));
  EXPECT_TRUE(anyContains(notices(R"({"children":[1],"scale":[1,0,1]},{"name":"Kid","mesh":0})",
                                  R"({"sampler":0,"target":{"node":1,"path":"translation"}})"),
                          "node 'Kid' is animated below a scale of zero"));
  EXPECT_TRUE(
      anyContains(notices(R"({"name":"Askew","mesh":0,"matrix":[1,0,0,0, 0.5,1,0,0, 0,0,1,0, 0,0,0,1]})",
                          R"({"sampler":0,"target":{"node":0,"path":"translation"}})"),
                  "node 'Askew' is animated and has a matrix with shear"));
}

TEST(Parts, ARigFromOutsideAndNodesDoNotGoTogether) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  Settings settings;
  settings.parts = Parts::kNodes;
  settings.rig_preset = "sway";
  EXPECT_TRUE(
      contains(refusal(scratch.write("m.gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":[{"mesh":0}])")),
                       Exit::kUsage, settings),
               "--parts nodes"));
}

// Names that many nodes share must not cost the square of their number, and packs that nobody reads are not
// made.
TEST(Parts, ManyNodesOfOneNameAreToldApartAndTooManyAreRefused) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const auto write = [&](int count) {
    std::string nodes = R"({"name":"n","mesh":0})";
    for (int i = 1; i < count; ++i) nodes += R"(,{"name":"n","mesh":0})";
    return scratch.write("m.gltf", maker.text(GltfMaker::boxMesh() + R"(,"nodes":[)" + nodes + "]"));
  };
  Settings settings;
  settings.parts = Parts::kNodes;
  const SourceModel model = importFile(write(4096), settings);
  ASSERT_EQ(model.parts.size(), 4096u);
  EXPECT_EQ(model.parts[4095].name, "n.4096");
  EXPECT_TRUE(contains(refusal(write(4097), Exit::kUnsupported, settings), "4097 parts"));
}

// --- a moment ------------------------------------------------------------------------------------

void expectCorners(const SourceModel& model, const std::vector<glm::dvec3>& wanted, double tolerance) {
  const SourcePart& part = model.parts.at(0);
  ASSERT_EQ(part.soup.triangles.size() * 3, wanted.size());
  double worst = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const glm::vec3 got =
        part.to_object * glm::vec4(part.soup.positions[part.soup.triangles[i / 3].vertex[i % 3]], 1);
    worst = std::max(worst, glm::length(wanted[i] - glm::dvec3(got)));
  }
  EXPECT_LT(worst, tolerance);
}

constexpr int kFox = 1;  // the node of the skinned mesh

TEST(Moment, TheFoxStandsAsItsJointsDo) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const GltfTruth truth(path);
  for (const auto& [name, animation, time] :
       {std::tuple("Walk", 1, 0.3), std::tuple("Run", 2, 0.41), std::tuple("Survey", 0, 3.3)}) {
    Settings settings;
    settings.at = Moment{name, time};
    const SourceModel model = importFile(path, settings);
    EXPECT_TRUE(model.notices.empty()) << model.notices[0];
    expectCorners(model, truth.worldCorners(kFox, animation, time), 1e-3);  // a fox 150 long
  }
}

TEST(Moment, MorphTargetsStandAsTheirWeightsDo) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  std::vector<float> up, wide;
  for (int i = 0; i < 8; ++i) {
    up.insert(up.end(), {0, i & 2 ? 2.0f : 0.0f, 0});
    wide.insert(wide.end(), {i & 1 ? 1.0f : -1.0f, 0, 0});
  }
  const int first = maker.floats(up, 3), second = maker.floats(wide, 3), times = maker.floats({0, 1, 3}, 1);
  const int line = maker.floats({0, 1, 1, 0, 0.5f, 0.25f}, 1),
            curve = maker.floats({0, 0, 0, 1, 1, 0, 0, 2, 1, 0, 0, -1, -0.5f, 0.3f, 0.5f, 0.25f, 0, 0}, 1);
  for (const auto& [output, how] :
       {std::pair(line, "LINEAR"), std::pair(line, "STEP"), std::pair(curve, "CUBICSPLINE")}) {
    const auto path = scratch.write(
        "m.gltf",
        maker.text(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"targets":[{"POSITION":)" +
            std::to_string(first) + R"(},{"POSITION":)" + std::to_string(second) +
            R"(}]}],"weights":[0.5,0]}],"nodes":[{"mesh":0,"translation":[1,0,0]}],"animations":[{"name":"grow","samplers":[{"input":)" +
            std::to_string(times) + R"(,"output":)" + std::to_string(output) + R"(,"interpolation":")" + how +
            R"("}],"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}])"));
    const GltfTruth truth(path);
    expectCorners(importFile(path, {}), truth.worldCorners(0, -1, 0), 1e-6);
    for (const double time : {0.0, 0.4, 1.0, 2.2, 3.0, 9.0}) {
      Settings settings;
      settings.at = Moment{"grow", time};
      const SourceModel model = importFile(path, settings);
      expectCorners(model, truth.worldCorners(0, 0, time), 1e-5);
      EXPECT_EQ(anyContains(model.notices, "ends at 3 s"), time > 3);
    }
  }
}

TEST(Moment, NodesOfOnePartStandAsTheyDoThen) {
  const Scratch scratch;
  const auto path = Robot().write(scratch);
  const GltfTruth truth(path);
  Settings settings;
  settings.at = Moment{"wave", 1.3};
  std::vector<glm::dvec3> wanted;
  for (const int node : {0, 5, 3, 4}) {  // breadth first
    const std::vector<glm::dvec3> corners = truth.worldCorners(node, 0, 1.3);
    wanted.insert(wanted.end(), corners.begin(), corners.end());
  }
  const SourceModel model = importFile(path, settings);
  ASSERT_EQ(model.parts.size(), 1u);
  // Mirrored nodes wind the other way: compared as sets.
  for (const glm::dvec3& corner : wanted) {
    double nearest = 1e30;
    for (const glm::vec3& p : model.parts[0].soup.positions)
      nearest = std::min(nearest, glm::length(glm::dvec3(p) - corner));
    EXPECT_LT(nearest, 1e-5);
  }
  EXPECT_EQ(model.parts[0].soup.triangles.size() * 3, wanted.size());
}

TEST(Moment, UnknownNamesListThoseThereAre) {
  const Scratch scratch;
  Settings settings;
  settings.at = Moment{"dance", 1};
  const std::string message = refusal(Robot().write(scratch), Exit::kUsage, settings);
  EXPECT_TRUE(contains(message, "'dance'") && contains(message, "'wave'") && contains(message, "'reach'"))
      << message;
  const auto plain = scratch.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  Report report;
  EXPECT_THROW(bake::bake(plain, settings, report), ToolError);
}

}  // namespace
}  // namespace kelp::bake::test
