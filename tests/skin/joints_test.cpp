// SPDX-License-Identifier: MIT
// The joints' keys put every vertex where a second reader of the file does, within 1/100 voxel of 128, at the
// sampled times and between them.
#include "joints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "gltf_truth.h"
#include "kelp/import/gltf/import_gltf.h"
#include "skin_file.h"
#include "support/assets.h"
#include "support/scratch.h"

namespace kelp::bake {
namespace {

using kelp::test::Scratch;
using test::GltfTruth;
using test::SkinFile;

constexpr double kTolerance = 0.01;  // voxels

// The corners of a file's triangles as nodes, and its joints with keys for them.
class Keyed {
 public:
  explicit Keyed(const std::filesystem::path& path, const char* rig = nullptr) : truth_(path) {
    ImportSettings settings;
    if (rig) settings.rig_preset = rig;
    SourceModel model = importGltf(path, settings);
    part_ = std::move(model.parts.at(0));
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (std::size_t t = 0; t < part_.soup.triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c) {
        SkinNode& node = nodes_.emplace_back();
        node.at = glm::dvec3(part_.soup.positions[part_.soup.triangles[t].vertex[c]]);
        low = glm::min(low, node.at);
        high = glm::max(high, node.at);
        const std::uint32_t vertex = part_.soup.skinned[t][c], first = skin().first_influence[vertex];
        for (std::uint32_t i = first; i < skin().first_influence[vertex + 1]; ++i) {
          EXPECT_LT(i - first, 4u);
          node.joints[i - first] = skin().influences[i].joint;
          node.weights[i - first] = static_cast<double>(skin().influences[i].weight);
        }
      }
    voxel_ = std::max({high.x - low.x, high.y - low.y, high.z - low.z}) / 128;
    joints = jointsOfSkin(skin(), nodes_, kTolerance * voxel_, 2);
  }

  const SourceSkin& skin() const { return *part_.skin; }
  double voxel() const { return voxel_; }

  // How far the keys put any corner of these nodes' meshes from where the file does, in voxels.
  double off(const std::vector<int>& nodes, std::size_t clip, double time) const {
    const std::vector<glm::dmat4x3> motions = keyedMotions(joints, clip, time);
    const glm::dmat4x3 to_world(part_.to_object);
    double most = 0;
    std::size_t i = 0;
    for (const int node : nodes)
      for (const glm::dvec3& wanted : truth_.worldCorners(node, static_cast<int>(clip), time)) {
        const SkinNode& its = nodes_.at(i++);
        glm::dvec3 at(0);
        for (std::size_t k = 0; k < 4; ++k)
          at += its.weights[k] * (motions[its.joints[k]] * glm::dvec4(its.at, 1));
        most = std::max(most, glm::distance(to_world * glm::dvec4(at, 1), wanted));
      }
    EXPECT_EQ(i, nodes_.size());
    return most / voxel_;
  }

  // The same at times of all clips: those that were sampled, at most so many, and as many others.
  void expectNear(const std::vector<int>& nodes, std::size_t times = 60) const {
    for (std::size_t c = 0; c < skin().clips.size(); ++c) {
      const SourceSkin::Clip& clip = skin().clips[c];
      const std::size_t step = clip.times.size() / times + 1;
      double sampled = 0, between = 0;
      for (std::size_t t = 0; t < clip.times.size(); t += step) {
        sampled = std::max(sampled, off(nodes, c, static_cast<double>(clip.times[t])));
        if (t + 1 < clip.times.size() && clip.times[t + 1] - clip.times[t] > 2e-4f)
          between = std::max(between, off(nodes, c,
                                          0.37 * static_cast<double>(clip.times[t]) +
                                              0.63 * static_cast<double>(clip.times[t + 1])));
      }
      EXPECT_LE(sampled, 1.01 * kTolerance) << clip.name;
      EXPECT_LE(between, 1.2 * kTolerance) << clip.name;
    }
  }

  std::size_t keys() const {
    std::size_t count = 0;
    for (const SkinJoint& joint : joints)
      for (const RigDescription::Clip& clip : joint.rig.clips)
        for (const RigDescription::Track& track : clip.tracks) count += track.keys.size();
    return count;
  }

  std::vector<SkinJoint> joints;

 private:
  GltfTruth truth_;
  SourcePart part_;
  std::vector<SkinNode> nodes_;
  double voxel_ = 1;
};

TEST(SkinJoints, OfTheFox) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const Keyed keyed(path);
  keyed.expectNear({1}, 12);
  EXPECT_EQ(keyed.joints.size(), 24u);
  EXPECT_LT(keyed.keys(), 2000u);
  std::set<std::string> names;
  for (std::size_t j = 0; j < keyed.joints.size(); ++j) {
    EXPECT_TRUE(names.insert(keyed.joints[j].name).second);
    EXPECT_LT(keyed.joints[j].parent, static_cast<int>(j));
    ASSERT_EQ(keyed.joints[j].rig.clips.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(keyed.joints[j].rig.clips[c].name, keyed.skin().clips[c].name);
      for (const RigDescription::Track& track : keyed.joints[j].rig.clips[c].tracks)
        EXPECT_NE(track.target, Target::kPartScale) << "nothing scales here";
    }
  }
}

TEST(SkinJoints, OfCesiumMan) {
  KELP_ASSET(path, "gltf/skinned/CesiumMan.glb");
  Keyed(path).expectNear({1}, 12);
}

TEST(SkinJoints, OfGreenman) {
  KELP_ASSET(path, "gltf/skinned/greenman.glb");
  Keyed(path).expectNear({12}, 12);
}

TEST(SkinJoints, OfRiggedSimple) {
  KELP_ASSET(path, "gltf/skinned/rigged_simple.gltf");
  Keyed(path).expectNear({2}, 40);
}

// --- files made here: a column of 6 units on three joints, two units apart ------------------------

SkinFile::Vertex ringOf(double y) {
  SkinFile::Vertex vertex;
  const double at = std::clamp(y / 2 - 0.5, 0.0, 2.0);
  const auto low = static_cast<std::uint16_t>(std::min(at, 1.0));
  vertex.joints = {low, static_cast<std::uint16_t>(low + 1), 0, 0};
  const auto share = static_cast<float>(at - low);
  vertex.weights = {1 - share, share, 0, 0};
  return vertex;
}

std::vector<float> turns(const std::vector<glm::dvec4>& axes_and_angles) {
  std::vector<float> out;
  for (const glm::dvec4& turn : axes_and_angles) {
    const glm::dvec3 v = std::sin(turn.w / 2) * glm::normalize(glm::dvec3(turn));
    for (const double number : {v.x, v.y, v.z, std::cos(turn.w / 2)})
      out.push_back(static_cast<float>(number));
  }
  return out;
}

const std::vector<float> kTimes{0, 0.4f, 1.1f, 1.5f};
const std::vector<float> kTurns = turns({{0, 0, 1, 0}, {1, 0, 2, 0.9}, {1, 3, -1, 1.7}, {0, 0, 1, -0.5}});
const std::vector<float> kOtherTurns =
    turns({{1, 0, 0, 0.1}, {0, 1, 2, -1.2}, {1, 1, 0, 0.8}, {1, 0, 0, 0.2}});

glm::dmat4 moved(double x, double y, double z) { return glm::translate(glm::dmat4(1), glm::dvec3(x, y, z)); }

// Three joints below each other, the upper two of which turn; `change` adds to them before the mesh.
struct Column {
  SkinFile file;
  std::vector<int> joints;
  int mesh = -1;

  explicit Column(const std::vector<glm::dmat4>& binds = {moved(0, 0, 0), moved(0, -2, 0), moved(0, -4, 0)},
                  const nlohmann::json& root = nlohmann::json::object(),
                  const nlohmann::json& middle = {{"translation", {0, 2, 0}}},
                  const nlohmann::json& high = {{"translation", {0, 2, 0}}}) {
    joints.push_back(file.addNode("low", -1, root));
    joints.push_back(file.addNode("middle", joints[0], middle));
    joints.push_back(file.addNode("high", joints[1], high));
    mesh = file.addColumn(file.addSkin(joints, binds), 6, 0.8, ringOf);
    file.animate("turn", joints[1], "rotation", kTimes, kTurns);
    file.animate("turn", joints[2], "rotation", kTimes, kOtherTurns);
  }

  void expectNear(const char* rig = nullptr) const {
    const Scratch scratch;
    Keyed(scratch.write("column.gltf", file.text()), rig).expectNear({mesh});
  }
};

TEST(SkinJoints, ThatTurn) { Column().expectNear(); }

TEST(SkinJoints, WithoutBindMatrices) { Column(std::vector<glm::dmat4>()).expectNear(); }

TEST(SkinJoints, WithBindMatricesThatTurnAndScale) {
  const auto turned = [](double y, double angle, double scale) {
    return glm::inverse(glm::scale(
        glm::rotate(moved(0.1 * y, y, -0.2), angle, glm::normalize(glm::dvec3(1, y, 2))), glm::dvec3(scale)));
  };
  Column({turned(0.1, 0.4, 2), turned(2.2, 1.4, 0.5), turned(3.9, -2.0, 3)}).expectNear();
  Column({turned(0.1, 0.4, 100), turned(2.2, 1.4, 100), turned(3.9, -2.0, 100)},
         {{"scale", {100, 100, 100}}, {"rotation", {0, 0.6, 0, 0.8}}}, {{"translation", {0, 0.02, 0}}},
         {{"translation", {0, 0.02, 0}}})
      .expectNear();
}

TEST(SkinJoints, OfUnevenScale) {
  Column column;
  column.file.animate("turn", column.joints[0], "scale", {0, 1.5f}, {1, 1, 1, 1, 2, 0.4f});
  column.file.animate("turn", column.joints[1], "scale", kTimes, {1, 1, 1, 2, 0.5f, 1, 0.3f, 1, 3, 1, 1, 1});
  column.expectNear();
  // In the bind pose already.
  const glm::dmat4 low = glm::scale(glm::dmat4(1), glm::dvec3(1, 2, 0.5));
  Column stretched(
      {glm::inverse(low), glm::inverse(low * moved(0, 1, 0)), glm::inverse(low * moved(0, 3, 0))},
      {{"scale", {1, 2, 0.5}}}, {{"translation", {0, 1, 0}}});
  stretched.expectNear();
}

TEST(SkinJoints, OfScaleToNothing) {
  for (const std::size_t which : {0u, 1u, 2u}) {
    Column column;
    column.file.animate("turn", column.joints[which], "scale", kTimes, {1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2});
    column.expectNear();
    Column flat;
    flat.file.animate("turn", flat.joints[which], "scale", kTimes, {1, 1, 1, 1, 0, 1, 1, 0, 0, 1, -1, 2});
    flat.expectNear();
  }
}

TEST(SkinJoints, ThatMirror) {
  const glm::dmat4 mirror = glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1));
  Column({mirror, mirror * moved(0, -2, 0), mirror * moved(0, -4, 0)}, {{"scale", {-1, 1, 1}}}).expectNear();
  // Only now, not in the bind pose.
  Column({moved(0, 0, 0), moved(0, -2, 0), moved(0, -4, 0)}, nlohmann::json::object(),
         {{"translation", {0, 2, 0}}, {"scale", {1, 1, -1}}})
      .expectNear();
}

TEST(SkinJoints, BelowNodesThatMoveButAreNoJoints) {
  for (const bool stretches : {false, true}) {
    SkinFile file;
    const int armature = file.addNode("armature", -1, {{"translation", {1, 0, 0}}}),
              low = file.addNode("low", armature),
              between = file.addNode("between", low, {{"translation", {0, 1, 0}}}),
              middle = file.addNode("middle", between, {{"translation", {0, 1, 0}}}),
              high = file.addNode("high", middle, {{"translation", {0, 2, 0}}}),
              mesh = file.addColumn(
                  file.addSkin({low, middle, high}, {moved(0, 0, 0), moved(0, -2, 0), moved(0, -4, 0)}), 6,
                  0.8, ringOf);
    file.animate("go", armature, "translation", {0, 1.5f}, {1, 0, 0, 5, 1, 2});
    file.animate("go", armature, "rotation", kTimes, kOtherTurns);
    file.animate("go", low, "rotation", kTimes, kTurns);
    file.animate("go", between, "rotation", kTimes, kTurns);
    file.animate("go", middle, "rotation", kTimes, kOtherTurns);
    if (stretches) {
      file.animate("go", armature, "scale", {0, 1.5f}, {1, 1, 1, 1, 2, 0.5f});
      file.animate("go", between, "scale", kTimes, {1, 1, 1, 2, 1, 1, 1, 3, 1, 1, 1, 0.2f});
    }
    const Scratch scratch;
    const Keyed keyed(scratch.write("between.gltf", file.text()));
    keyed.expectNear({mesh});
    EXPECT_EQ(keyed.joints.size(), stretches ? 5u : 3u);
    EXPECT_EQ(keyed.joints.back().name, "high");
  }
}

TEST(SkinJoints, OfTwoSkinsThatBindThemDifferently) {
  SkinFile file;
  const int low = file.addNode("low", -1), middle = file.addNode("middle", low, {{"translation", {0, 2, 0}}}),
            high = file.addNode("high", middle, {{"translation", {0, 2, 0}}});
  const std::vector<int> joints{low, middle, high};
  const glm::dmat4 other =
      glm::rotate(glm::scale(moved(0.3, 0.5, 0), glm::dvec3(1.5)), 0.7, glm::dvec3(0, 1, 0));
  const int first = file.addColumn(file.addSkin(joints, {moved(0, 0, 0), moved(0, -2, 0), moved(0, -4, 0)}),
                                   6, 0.8, ringOf),
            second = file.addColumn(
                file.addSkin(joints, {moved(1, 0, 0), other * moved(1, -2, 0), moved(1, -4.5, 0) * other}), 6,
                0.5, ringOf);
  file.animate("turn", low, "translation", kTimes, {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  file.animate("turn", middle, "rotation", kTimes, kTurns);
  file.animate("turn", high, "rotation", kTimes, kOtherTurns);
  const Scratch scratch;
  const Keyed keyed(scratch.write("two.gltf", file.text()));
  keyed.expectNear({first, second});
  // Each is placed so that the uppermost joint binds it alike.
  std::set<std::string> names;
  for (const SkinJoint& joint : keyed.joints) names.insert(joint.name);
  EXPECT_EQ(names, (std::set<std::string>{"low", "middle", "middle.2", "high", "high.2"}));
}

TEST(SkinJoints, ThatFollowCurvesAndSteps) {
  Column column;
  std::vector<float> cubic;  // slope before, value, slope after
  for (const std::array<float, 3>& y : {std::array<float, 3>{0, 0, 9}, {-5, 2, -5}, {0, 1, 0}, {3, 0, 0}})
    for (const float number : y) cubic.insert(cubic.end(), {0.5f * number, number, 0});
  column.file.animate("turn", column.joints[0], "translation", kTimes, cubic, "CUBICSPLINE");
  column.expectNear();
  Column step;
  step.file.animate("turn", step.joints[0], "translation", kTimes, {0, 0, 0, 1, 2, 3, -1, 0, 0, 2, 0, 1},
                    "STEP");
  step.expectNear();
}

}  // namespace
}  // namespace kelp::bake
