// SPDX-License-Identifier: MIT
// Skins that are damaged or of no use: an error or a notice, and nothing hangs.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "import_scratch.h"
#include "kelp/bake/bake.h"

namespace kelp::bake {
namespace {

using namespace test;

// A box whose lower corners follow joint 1 and whose upper ones joint 2, a joint that turns.
struct BoxSkin {
  std::uint16_t upper = 1;  // the joint of the upper corners, in the skin
  float weight = 1;         // of all of them
  float turn = 0.6f;        // x of the last key's quaternion
  std::string more;         // nodes
  std::string joints = "1,2", children = R"("children":[2],)", node = R"("mesh":0,"skin":0)";
  bool animated = true;
  float bind = 0;  // x where the inverse bind matrices move the joints
  float last_time = 1;
  std::string tip = "[0,0.1,0]";  // where joint 2 is at rest; without matrices it is at 0 in the bind pose

  std::string text() const {
    GltfMaker maker;
    maker.addBox();
    std::vector<std::uint16_t> of_corner;
    std::vector<float> weights;
    for (int corner = 0; corner < 8; ++corner) {
      of_corner.insert(of_corner.end(), {(corner & 2) == 0 ? std::uint16_t{0} : upper, 0, 0, 0});
      weights.insert(weights.end(), {weight, 0, 0, 0});
    }
    maker.joints(of_corner);
    maker.floats(weights, 4);
    maker.floats(last_time > 0 ? std::vector<float>{0, last_time} : std::vector<float>{0}, 1);
    std::vector<float> turns{0, 0, 0, 1, turn, 0, 0, 0.8f};
    if (!(last_time > 0)) turns = {turn, 0, 0, 0.8f};
    maker.floats(turns, 4);
    const std::vector<float> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, bind, 0, 0, 1};
    std::vector<float> matrices = matrix;
    matrices.insert(matrices.end(), matrix.begin(), matrix.end());
    if (bind != 0) maker.add(bytesOf(matrices), 5126, 2, "MAT4");
    return maker.text(
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1}]}],"skins":[{"joints":[)" +
        joints + "]" + (bind != 0 ? R"(,"inverseBindMatrices":6)" : "") + R"(}],"nodes":[{)" + node +
        R"(},{"name":"root",)" + children + R"("translation":[0,0,0]},{"name":"tip","translation":)" + tip +
        "}" + more + "]" +
        (animated
             ? std::string(
                   R"(,"animations":[{"name":"turn","samplers":[{"input":4,"output":5}],"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}]}])")
             : std::string()));
  }
};

class BadSkins : public ::testing::Test {
 protected:
  RawPack baked(const BoxSkin& skin, const char* rig = nullptr) {
    report = {};
    Settings settings;
    settings.resolution = 32;
    settings.threads = 1;
    if (rig) settings.rig_preset = rig;
    return bake(scratch.write("m.gltf", skin.text()), settings, report);
  }
  Exit errorOf(const BoxSkin& skin, const char* rig = nullptr) {
    try {
      baked(skin, rig);
    } catch (const ToolError& error) {
      message = error.what();
      return error.exit;
    }
    return Exit::kOk;
  }
  bool noted(const std::string& words) const { return anyContains(report.notices, words); }

  Scratch scratch;
  Report report;
  std::string message;
};

TEST_F(BadSkins, ASoundOneHasAPartForEachJoint) {
  const RawPack pack = baked({});
  EXPECT_EQ(pack.parts.size(), 3u);
  EXPECT_FALSE(pack.parts[0].influences.empty());
  ASSERT_EQ(pack.clips.size(), 1u);
  EXPECT_EQ(pack.clips[0].name, "turn");
  EXPECT_EQ(pack.clips[0].duration, 1.0f);
  EXPECT_TRUE(report.notices.empty()) << report.notices[0];
}

TEST_F(BadSkins, ASoundOneHasTheVoxelsOfTheModelAtRest) {
  BoxSkin skin;
  skin.tip = "[0,0,0]";
  const RawPack pack = baked(skin), plain = baked(skin, "none");
  ASSERT_EQ(plain.parts.size(), 1u);
  EXPECT_EQ(pack.parts[0].to_object, plain.parts[0].to_object);
  ASSERT_EQ(pack.parts[0].levels.size(), plain.parts[0].levels.size());
  for (std::size_t i = 0; i < plain.parts[0].levels.size(); ++i) {
    EXPECT_EQ(pack.parts[0].levels[i].cells, plain.parts[0].levels[i].cells);
    EXPECT_EQ(pack.parts[0].levels[i].codes, plain.parts[0].levels[i].codes);
    EXPECT_EQ(pack.parts[0].levels[i].attributes, plain.parts[0].levels[i].attributes);
  }
}

TEST_F(BadSkins, WeightsThatDoNotSumToOne) {
  BoxSkin skin;
  for (const float weight : {0.5f, 3.0f, 0.0f}) {
    skin.weight = weight;
    const RawPack pack = baked(skin);
    EXPECT_TRUE(noted("do not sum to one")) << weight;
    EXPECT_GE(pack.parts.size(), 1u);
  }
}

TEST_F(BadSkins, JointsThatAreNotThere) {
  BoxSkin skin;
  skin.upper = 7;
  EXPECT_EQ(errorOf(skin), Exit::kInvalid);
  EXPECT_NE(message.find("names a joint which its skin does not have"), std::string::npos) << message;
  BoxSkin far;
  far.joints = "1,99";
  EXPECT_EQ(errorOf(far), Exit::kInvalid);
}

// Joints outside of the scene, below nodes that are each other's children.
TEST_F(BadSkins, Circles) {
  BoxSkin skin;
  skin.children = "";
  skin.more = R"(,{"children":[2,4]},{"children":[3]})";
  EXPECT_EQ(errorOf(skin, kSkinRig), Exit::kInvalid);
  EXPECT_NE(message.find("below itself"), std::string::npos) << message;
  skin.children = R"("children":[1,2],)";
  skin.more = "";
  EXPECT_EQ(errorOf(skin, kSkinRig), Exit::kInvalid);
}

TEST_F(BadSkins, NumbersThatAreNone) {
  BoxSkin skin;
  skin.weight = std::numeric_limits<float>::quiet_NaN();
  EXPECT_GE(baked(skin).parts.size(), 1u);
  EXPECT_TRUE(noted("do not sum to one"));
  BoxSkin keys;
  keys.turn = std::numeric_limits<float>::infinity();
  EXPECT_EQ(errorOf(keys), Exit::kInvalid) << message;
  BoxSkin matrices;
  matrices.bind = 0.05f;
  EXPECT_EQ(errorOf(matrices), Exit::kOk) << message;
  matrices.bind = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(errorOf(matrices), Exit::kInvalid);
  EXPECT_NE(message.find("inverse bind matrix"), std::string::npos) << message;
}

TEST_F(BadSkins, AnAnimationWithoutALengthIsAPose) {
  BoxSkin skin;
  skin.last_time = 0;
  const RawPack pack = baked(skin);
  ASSERT_EQ(pack.clips.size(), 1u);
  EXPECT_GT(pack.clips[0].duration, 0.0f);
}

TEST_F(BadSkins, WithoutMotionOrMeshThereIsNothingToDivide) {
  BoxSkin still;
  still.animated = false;
  EXPECT_EQ(baked(still).parts.size(), 1u);
  EXPECT_EQ(baked(still, kSkinRig).parts.size(), 3u);  // a part for each joint all the same
  EXPECT_EQ(baked({}, "none").parts.size(), 1u);
  EXPECT_TRUE(noted("'turn'"));
  BoxSkin unused;
  unused.node = R"("mesh":0)";
  EXPECT_EQ(baked(unused).parts.size(), 1u);
  EXPECT_EQ(errorOf(unused, kSkinRig), Exit::kUsage);
  EXPECT_NE(message.find("no mesh that bends by joints"), std::string::npos) << message;
}

TEST_F(BadSkins, OtherFormatsHaveNone) {
  Settings settings;
  settings.rig_preset = kSkinRig;
  try {
    bake(scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), settings, report);
    FAIL();
  } catch (const ToolError& error) {
    EXPECT_EQ(error.exit, Exit::kUsage);
    EXPECT_NE(std::string(error.what()).find("have no skins"), std::string::npos);
  }
}

}  // namespace
}  // namespace kelp::bake
