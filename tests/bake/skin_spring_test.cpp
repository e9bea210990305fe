// SPDX-License-Identifier: MIT
// A skinned fox beside a player: it gives way, and nothing tears.
#include <algorithm>
#include <utility>

#include "baked_asset.h"
#include "kelp/runtime/soft_body.h"
#include "kelp/runtime/spring.h"
#include "support/assets.h"

namespace kelp::bake::test {
namespace {

class WalkingFox {
 public:
  explicit WalkingFox(const std::filesystem::path& path)
      : baked_(path, {}, 96), edges(runtime::nodeEdges(baked_.asset(), 0).value()) {}

  const runtime::Asset& asset() const { return baked_.asset(); }
  runtime::Pose walking(double seconds) const {
    runtime::Pose pose = *runtime::Pose::create(asset());
    addClip(asset(), runtime::findClip(asset(), "Walk").value(), seconds, 1, pose).value();
    return pose;
  }
  // Where the box of the fox has this place, 0 to 1.
  glm::vec3 at(const runtime::Pose& pose, const glm::vec3& place) const {
    const Box box = bounds(runtime::Instance{&asset(), &pose});
    return box.min + place * (box.max - box.min);
  }
  // Of the edges between nodes, by their lengths before: the shortest and the longest.
  std::pair<float, float> stretch(const runtime::Pose& before, const runtime::Pose& after) const {
    const std::span<const glm::vec3> from = before.nodes(0), to = after.nodes(0);
    std::pair<float, float> all(1, 1);
    for (const auto& [a, b] : edges.span()) {
      const float by = glm::distance(to[a], to[b]) / glm::distance(from[a], from[b]);
      all = {std::min(all.first, by), std::max(all.second, by)};
    }
    return all;
  }
  // A player who comes near, in four steps. Voxels are 1/96 of the fox.
  runtime::Pose beside(const runtime::Pose& pose, runtime::Spring& spring, const glm::vec3& from,
                       const glm::vec3& to, float radius) const {
    for (const float way : {0.25f, 0.5f, 0.75f, 1.0f}) {
      spring.step(1 / 60.0f).value();
      spring.pushAway({&asset(), &pose}, glm::mix(from, to, way), radius).value();
    }
    runtime::Pose with = *runtime::Pose::create(asset());
    with.assign(pose).value();
    spring.addTo(with).value();
    EXPECT_TRUE(with.check());
    return with;
  }

 private:
  BakedAsset baked_;

 public:
  const Buffer<runtime::NodeEdge> edges;
};

TEST(SkinSpring, AFoxGivesWayBesideAPlayer) {
  KELP_ASSET(path, "gltf/draco_testdata/Fox/Fox.gltf");
  const WalkingFox fox(path);
  const Part& body = fox.asset().pack().parts()[0];
  const float voxel = glm::length(body.to_object[0]);
  std::vector<int> tail;
  for (std::size_t i = 0; i < fox.asset().pack().parts().size(); ++i)
    if (fox.asset().pack().parts()[i].name.find("Tail") != std::string_view::npos)
      tail.push_back(static_cast<int>(i));
  ASSERT_EQ(tail.size(), 3u);
  for (const double seconds : {0.0, 0.2, 0.5}) {
    SCOPED_TRACE(seconds);
    const runtime::Pose pose = fox.walking(seconds);
    runtime::Spring whole = *runtime::Spring::create(fox.asset(), {1, 0.2f, 0.5f, true});
    const runtime::Pose pushed = fox.beside(pose, whole, fox.at(pose, {1.6f, 0.6f, 0.5f}),
                                            fox.at(pose, {1.15f, 0.6f, 0.5f}), 13 * voxel);
    const auto [least, most] = fox.stretch(pose, pushed);
    EXPECT_GT(least, 0.4f);
    EXPECT_LT(most, 1.6f);
    EXPECT_NE(least, 1);
    // Empty joints stay where the clip puts them.
    for (int part = 1; part < pose.parts(); ++part) EXPECT_EQ(*pose.motion(part), *pushed.motion(part));

    runtime::SpringOptions options{1, 0.2f, 0.5f, true};
    options.parts = tail;
    runtime::Spring only_tail = *runtime::Spring::create(fox.asset(), options);
    const glm::vec3 at_tail = fox.at(pose, {0.5f, 0.55f, 0.12f});
    const runtime::Pose wagged = fox.beside(pose, only_tail, at_tail + glm::vec3(20 * voxel, 0, 0),
                                            at_tail + glm::vec3(11 * voxel, 0, 0), 13 * voxel);
    int moved = 0;
    float farthest = 0;
    for (std::uint32_t i = 0; i < body.cages[0].nodes(); ++i) {
      const Influences& its = body.cages[0].influences[i];
      bool follows = false;
      for (int k = 0; k < 4; ++k)
        follows |= its.weights[k] > 0 && std::find(tail.begin(), tail.end(), its.parts[k]) != tail.end();
      const float way = glm::distance(pose.nodes(0)[i], wagged.nodes(0)[i]);
      if (!follows) {
        EXPECT_EQ(way, 0) << i;
      }
      moved += way > 0;
      farthest = std::max(farthest, way);
    }
    EXPECT_GT(moved, 50);
    EXPECT_GT(farthest, 3);
    EXPECT_GT(fox.stretch(pose, wagged).first, 0.3f);
    EXPECT_LT(fox.stretch(pose, wagged).second, 1.8f);
  }
}

}  // namespace
}  // namespace kelp::bake::test
