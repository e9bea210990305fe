// SPDX-License-Identifier: MIT
// A solver asks for the volume that nodes carry, and for their neighbors.
#include "kelp/runtime/soft_body.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "caged_instance.h"
#include "support/short_memory.h"

namespace kelp::runtime {
namespace {

std::vector<float> volumesOf(const CagedAsset& asset) {
  std::vector<float> volumes(asset.part().cages[0].nodes());
  nodeVolumes(*asset, 0, volumes).value();
  return volumes;
}

TEST(SoftBody, VolumesSumUpToTheSolid) {
  int middles = 0;
  for (const fields::Occupancy& volume : {twoLegs({40, 50, 30}), test::hollowBlock()})
    for (const int side : {2, 4, 8}) {
      SCOPED_TRACE(side);
      const CagedAsset asset(volume, side, Bend::kShear);
      const Cage& cage = asset.part().cages[0];
      for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
        for (int face = 0; face < 6; ++face) middles += cage.beyond(cell, face) == kCageInside;
      double solid = 0, carried = 0;
      glm::dvec3 middle(0), middle_carried(0);
      glm::ivec3 v;
      for (v.z = 0; v.z < volume.size.z; ++v.z)
        for (v.y = 0; v.y < volume.size.y; ++v.y)
          for (v.x = 0; v.x < volume.size.x; ++v.x) {
            if (!volume.solid[volume.index(v)]) continue;
            ++solid;
            middle += glm::dvec3(v) + 0.5;
          }
      const std::vector<float> volumes = volumesOf(asset);
      for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
        EXPECT_GE(volumes[i], 0);
        carried += static_cast<double>(volumes[i]);
        middle_carried += static_cast<double>(volumes[i]) * glm::dvec3(cage.rest(i));
      }
      EXPECT_NEAR(carried, solid, 1e-5 * solid);
      EXPECT_LT(glm::distance(middle / solid, middle_carried / carried), 1e-3);
    }
  EXPECT_GT(middles, 100);
}

// Moving a node moves the center of mass by its share: as toWorld() moves the voxels.
TEST(SoftBody, ANodeCarriesWhatItMoves) {
  const fields::Occupancy volume = twoLegs({27, 30, 24});
  for (const int side : {4, 8}) {
    const CagedAsset asset(volume, side, Bend::kShear);
    const Cage& cage = asset.part().cages[0];
    const std::vector<float> volumes = volumesOf(asset);
    std::set<std::uint32_t> split;  // places with several nodes
    std::set<std::uint32_t> seen;
    for (const std::uint32_t place : cage.places)
      if (!seen.insert(place).second) split.insert(place);
    EXPECT_GT(split.size(), 3u);
    std::set<std::uint32_t> at_middle;  // they carry some of it, too
    for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
      for (int face = 0; face < 6; ++face)
        for (int corner = 0; corner < 8 && cage.beyond(cell, face) == kCageInside; ++corner)
          at_middle.insert(cage.node(cell, corner));
    int heavy = 0;
    for (std::uint32_t i = 0; i < cage.nodes(); ++i) {
      if (at_middle.count(i) != 0) continue;
      if (i % 11 != 0 && split.count(cage.places[i]) == 0) continue;
      Pose pose = asset.pose();
      constexpr float kFar = 64;
      pose.nodes(0)[i].x += kFar;
      const Instance instance = asset.instance(pose);
      double moved = 0;
      const glm::ivec3 at = cage.rest(i);
      glm::ivec3 v;
      for (v.z = std::max(at.z - side, 0); v.z < std::min(at.z + side, volume.size.z); ++v.z)
        for (v.y = std::max(at.y - side, 0); v.y < std::min(at.y + side, volume.size.y); ++v.y)
          for (v.x = std::max(at.x - side, 0); v.x < std::min(at.x + side, volume.size.x); ++v.x) {
            if (!volume.solid[volume.index(v)]) continue;
            const glm::vec3 rest = asset.toObject(glm::vec3(v) + 0.5f);
            moved += static_cast<double>(toWorld(instance, 0, rest).value().x - rest.x);
          }
      const double voxel = static_cast<double>(asset.toObject({1, 0, 0}).x - asset.toObject({0, 0, 0}).x);
      EXPECT_NEAR(volumes[i], moved / voxel / static_cast<double>(kFar), 2e-3) << i;
      heavy += volumes[i] > 1;
    }
    EXPECT_GT(heavy, 10);
  }
}

// Two corners of a cell, one of which is the other plus some axes, and no other nodes.
TEST(SoftBody, EdgesAreThoseOfTheTetrahedra) {
  for (const int side : {2, 4, 8}) {
    const CagedAsset asset(twoLegs({40, 50, 30}), side, Bend::kShear);
    const Cage& cage = asset.part().cages[0];
    std::set<std::pair<std::uint32_t, std::uint32_t>> truth;
    for (std::uint32_t cell = 0; cell < cage.cells(); ++cell)
      for (int i = 0; i < 8; ++i)
        for (int k = 0; k < i; ++k) {
          const std::uint32_t a = cage.node(cell, i), b = cage.node(cell, k);
          const glm::ivec3 step = cage.rest(a) - cage.rest(b);
          const bool ascends = step.x >= 0 && step.y >= 0 && step.z >= 0;
          const bool descends = step.x <= 0 && step.y <= 0 && step.z <= 0;
          if (ascends || descends) truth.insert({std::min(a, b), std::max(a, b)});
        }
    const Buffer<NodeEdge> edges = nodeEdges(*asset, 0).value();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const NodeEdge& edge : edges.span()) found.push_back({edge.a, edge.b});
    EXPECT_TRUE(std::equal(found.begin(), found.end(), truth.begin(), truth.end()));
    EXPECT_GT(found.size(), 3 * std::size_t{cage.nodes()});
  }
}

TEST(SoftBody, MisuseIsAnswered) {
  const CagedAsset asset(twoLegs({27, 30, 24}), 8, Bend::kShear);
  const Loaded plain(reed({0, 1}));
  std::vector<float> volumes(asset.part().cages[0].nodes() + 1, -7.0f);
  const std::span<float> all(volumes);
  for (const int part : {-1, 1}) {
    EXPECT_EQ(nodeVolumes(*asset, part, all.first(all.size() - 1)).error().code, ErrorCode::kMisuse);
    EXPECT_EQ(nodeEdges(*asset, part).error().code, ErrorCode::kMisuse);
  }
  EXPECT_EQ(nodeVolumes(*asset, 0, all).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(nodeVolumes(*asset, 0, all.first(all.size() - 2)).error().code, ErrorCode::kMisuse);
  EXPECT_EQ(volumes, std::vector<float>(volumes.size(), -7.0f));
  EXPECT_TRUE(nodeVolumes(*plain.asset, 0, {}));
  EXPECT_EQ(nodeVolumes(*plain.asset, 0, all).error().code, ErrorCode::kMisuse);
  EXPECT_TRUE(nodeEdges(*plain.asset, 0).value().empty());
  const auto unread = *Asset::open(asset.loaded.source.source());
  EXPECT_EQ(nodeVolumes(*unread, 0, all.first(all.size() - 1)).error().code, ErrorCode::kNotYet);
  EXPECT_TRUE(nodeEdges(*unread, 0));
}

TEST(SoftBody, ShortMemoryIsAnError) {
  const CagedAsset asset(twoLegs({27, 30, 24}), 8, Bend::kShear);
  for (const std::size_t calls : {0, 1}) {
    test::ShortMemory memory;
    memory.refuse_at = calls;
    EXPECT_EQ(nodeEdges(*asset, 0, memory.allocator()).error().code, ErrorCode::kOutOfMemory);
  }
}

}  // namespace
}  // namespace kelp::runtime
