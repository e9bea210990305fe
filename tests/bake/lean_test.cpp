// SPDX-License-Identifier: MIT
// From the file to the posed pack: a column whose knots only move leans as a straight line, whether a rig
// file, a clip or knot empties of glTF move them, at 128 and at 256 voxels alike. Truth: the line.
#include <cmath>
#include <tuple>

#include "import_scratch.h"
#include "kelp/runtime/instance.h"
#include "support/test_pack.h"

namespace kelp::bake::test {
namespace {

constexpr float kHeight = 2;  // meters, of GltfMaker's box

class Posed {
 public:
  Posed(const std::filesystem::path& path, int resolution, const Settings& given = {}) {
    Settings settings = given;
    settings.resolution = resolution;
    settings.resolution_given = true;
    settings.threads = 2;
    Report report;
    bytes_ = kelp::test::bytesOf(bake::bake(path, settings, report));
    source_.emplace(bytes_);
    auto opened = runtime::Asset::open(source_->source());
    EXPECT_TRUE(opened && (*opened)->loadAll());
    asset_ = *std::move(opened);
    pose_ = *runtime::Pose::create(*asset_);
  }
  const runtime::Asset& asset() const { return *asset_; }
  runtime::Pose& pose() { return pose_; }
  runtime::Instance instance() const { return {asset_.get(), &pose_}; }

 private:
  std::vector<std::byte> bytes_;
  std::optional<MemorySource> source_;
  std::unique_ptr<runtime::Asset> asset_;
  runtime::Pose pose_;
};

// Where the middle of the column is, by toWorld and by rays from both sides, and where the line is.
void expectLine(const runtime::Instance& instance, double slope) {
  const Part& part = instance.asset->pack().parts()[0];
  const double voxel = double{glm::length(part.to_object[1])};
  EXPECT_NEAR(voxel * part.size.y, kHeight, 1e-6) << "a height of the rig is the model's";
  for (int layer = 0; layer < part.size.y; layer += 3) {
    const float y = static_cast<float>((layer + 0.5) * voxel);
    const glm::dvec3 wanted(slope * double{y}, y, 0);
    EXPECT_LT(glm::distance(glm::dvec3(runtime::toWorld(instance, 0, {0, y, 0}).value()), wanted),
              0.01 * voxel);
    const auto left = runtime::raycast(instance, {{-20, y, 0.01f}, {1, 0, 0}}),
               right = runtime::raycast(instance, {{20, y, 0.01f}, {-1, 0, 0}});
    ASSERT_TRUE(left && right) << layer;
    EXPECT_NEAR(0.5 * (double{left->position.x} + double{right->position.x}), wanted.x, 0.5 * voxel) << layer;
  }
}

// GltfMaker's box, without a rig.
std::filesystem::path writeBox(const Scratch& scratch) {
  GltfMaker maker;
  maker.addBox();
  return scratch.write(
      "box.gltf", maker.text(GltfMaker::boxMesh() + R"(,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}])"));
}

TEST(Lean, OfARigFileIsStraightAtRestAndInItsClips) {
  const Scratch scratch;
  const std::filesystem::path box = writeBox(scratch);
  for (int degrees = 10; degrees <= 70; degrees += 10) {
    SCOPED_TRACE(degrees);
    const double slope = std::tan(glm::radians(static_cast<double>(degrees)));
    const std::string whole = std::to_string(slope), half = std::to_string(0.5 * slope);
    Settings settings;
    settings.rig_file = scratch.write(
        "lean.rig.json",
        R"({"kelp":1,"knots":[{"at":0},{"at":0.5,"offset":[)" + half + R"(,0,0]},{"at":1,"offset":[)" +
            whole + R"(,0,0]}],"clips":{"back":{"waves":[{"knot":1,"offset":[-)" + half +
            R"(,0,0],"period":4},{"knot":2,"offset":[-)" + whole + R"(,0,0],"period":4}]},)" +
            R"("on":{"keys":[{"time":0,"knot":1,"offset":[0,0,0]},{"time":2,"knot":1,"offset":[)" + half +
            R"(,0,0]},{"time":0,"knot":2,"offset":[0,0,0]},{"time":2,"knot":2,"offset":[)" + whole +
            R"(,0,0]}]}}})");
    Posed column(box, 128, settings);
    expectLine({&column.asset(), nullptr}, slope);
    // Back to upright and beyond, and on to twice the slope.
    for (const double seconds : {0.5, 1.0, 3.0}) {
      column.pose().reset();
      ASSERT_TRUE(runtime::addClip(column.asset(), runtime::findClip(column.asset(), "back").value(), seconds,
                                   1, column.pose()));
      expectLine(column.instance(), slope * (1 - std::sin(glm::radians(90 * seconds))));
    }
    column.pose().reset();
    ASSERT_TRUE(runtime::addClip(column.asset(), runtime::findClip(column.asset(), "on").value(), 1, 1,
                                 column.pose()));
    expectLine(column.instance(), slope * 1.5);
  }
}

// `tangent` in a rig file is not automatic; a clip's wave or keys override an automatic one.
TEST(Lean, ATangentThatIsGivenBendsTheColumn) {
  const Scratch scratch;
  const std::filesystem::path box = writeBox(scratch);
  Settings settings;
  settings.rig_file =
      scratch.write("bend.rig.json", R"({"kelp":1,"knots":[{"at":0,"tangent":[0,1,0]},{"at":1}],"clips":{
        "bend":{"waves":[{"knot":1,"offset":[0.3,0,0],"period":4}]},
        "wave":{"waves":[{"knot":1,"offset":[0.3,0,0],"period":4},{"knot":1,"tangent":[0,0,0],"period":4}]},
        "keys":{"waves":[{"knot":1,"offset":[0.3,0,0],"period":4}],"keys":[{"time":0,"knot":1,"tangent":[0,0,0]}]}}})");
  Posed column(box, 128, settings);
  for (const char* what : {"move", "bend", "wave", "keys"}) {
    SCOPED_TRACE(what);
    column.pose().reset();
    if (const Result<int> clip = runtime::findClip(column.asset(), what))
      ASSERT_TRUE(runtime::addClip(column.asset(), *clip, 1, 1, column.pose()));
    else
      ASSERT_TRUE(column.pose().move(0, 1, {0.3f, 0, 0}));
    const bool follows = what == std::string("move") || what == std::string("bend");
    for (double y = 0; y <= 1; y += 0.01) {
      // Hermite: from 0 upright to 0.3 with the slope 0.3, or upright too.
      const double x = 0.3 * y * y * (follows ? 2 - y : 3 - 2 * y);
      const glm::vec3 at =
          runtime::toWorld(column.instance(), 0, {0, kHeight * static_cast<float>(y), 0}).value();
      EXPECT_NEAR(at.x, kHeight * x, 0.01 * kHeight / 128) << y;
    }
  }
}

// The preset holds the foot's tangent, which would follow the top.
TEST(Lean, ASwayingPlantStandsUprightOnItsFoot) {
  const Scratch scratch;
  const std::filesystem::path box = writeBox(scratch);
  Settings settings;
  settings.rig_preset = "sway";
  Posed plant(box, 64, settings);
  for (const double seconds : {0.5, 1.9, 7.0}) {
    plant.pose().reset();
    ASSERT_TRUE(runtime::addClip(plant.asset(), 0, seconds, 1, plant.pose()));
    EXPECT_EQ(plant.pose().knots(0)[0].tangent, glm::vec3(0, 1, 0));
    EXPECT_GT(
        glm::length(glm::vec2(plant.pose().knots(0)[1].position.x, plant.pose().knots(0)[1].position.z)),
        0.03f);
  }
}

// Empties that move without turning. Blender's exporter also writes the turns and sizes that stand still.
TEST(Lean, OfKnotEmptiesIsStraight) {
  const Scratch scratch;
  GltfMaker maker;
  maker.addBox();
  const int times = maker.floats({0, 1}, 1), turns = maker.floats({0, 0, 0, 1, 0, 0, 0, 1}, 4),
            sizes = maker.floats({1, 1, 1, 1, 1, 1}, 3);
  std::string animations;
  for (int degrees = 10; degrees <= 70; degrees += 10) {
    const float across = kHeight * std::tan(glm::radians(static_cast<float>(degrees)));
    const int middle = maker.floats({0, 1, 0, 0.5f * across, 1, 0}, 3),
              top = maker.floats({0, 2, 0, across, 2, 0}, 3);
    std::string samplers, channels;
    int sampler = 0;
    for (const auto& [node, path, output] :
         {std::tuple(2, "translation", middle), std::tuple(3, "translation", top),
          std::tuple(1, "rotation", turns), std::tuple(2, "rotation", turns),
          std::tuple(3, "rotation", turns), std::tuple(2, "scale", sizes)}) {
      const std::string comma = samplers.empty() ? "" : ",";
      samplers +=
          comma + R"({"input":)" + std::to_string(times) + R"(,"output":)" + std::to_string(output) + "}";
      channels += comma + R"({"sampler":)" + std::to_string(sampler++) + R"(,"target":{"node":)" +
                  std::to_string(node) + R"(,"path":")" + path + R"("}})";
    }
    animations += std::string(animations.empty() ? "" : ",") + R"({"name":"lean)" + std::to_string(degrees) +
                  R"(","samplers":[)" + samplers + R"(],"channels":[)" + channels + "]}";
  }
  const auto path = scratch.write(
      "reed.gltf",
      maker.text(
          GltfMaker::boxMesh() +
          R"(,"scenes":[{"nodes":[0]}],"nodes":[{"name":"Reed","mesh":0,"children":[1,2,3]},)"
          R"({"name":"knot.0"},{"name":"knot.1","translation":[0,1,0]},{"name":"knot.2","translation":[0,2,0]}],)"
          R"("animations":[)" +
          animations + "]"));
  for (const int resolution : {128, 256}) {
    SCOPED_TRACE(resolution);
    Posed reed(path, resolution);
    ASSERT_EQ(reed.asset().pack().clips().size(), 7u);
    for (int degrees = 10; degrees <= 70; degrees += 10) {
      SCOPED_TRACE(degrees);
      const double slope = std::tan(glm::radians(static_cast<double>(degrees)));
      const int clip = runtime::findClip(reed.asset(), "lean" + std::to_string(degrees)).value();
      for (const double share : {0.3, std::nextafter(1.0, 0.0)}) {
        reed.pose().reset();
        ASSERT_TRUE(runtime::addClip(reed.asset(), clip, share, 1, reed.pose()));
        expectLine(reed.instance(), share * slope);
      }
    }
  }
}

}  // namespace
}  // namespace kelp::bake::test
