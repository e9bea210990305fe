// SPDX-License-Identifier: MIT
// Instances of parts with cages in many poses, and the truth of them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "bent_instance.h"
#include "caged.h"
#include "reference/cage_distance.h"
#include "reference/cage_trials.h"

namespace kelp::test {

class CagedTruth : public SolidTruth {
 public:
  CagedTruth(const reference::CagedLevel& level, std::span<const glm::vec3> nodes,
             const std::function<glm::vec3(const glm::ivec3&)>& corner)
      : cage_(level, nodes, corner), distance_(cage_) {
    for (const glm::vec3& node : nodes) bounds_.add(node);
  }
  Box bounds() const override { return bounds_; }
  bool inside(const glm::dvec3& p) const override { return distance_.inside(p); }
  glm::dvec3 nearest(const glm::dvec3& p) const override { return inside(p) ? p : distance_.nearest(p); }
  int inverted() const { return cage_.inverted(); }
  // How far a ray may go, part space; infinite: all the way.
  double firstHit(const glm::dvec3& o, const glm::dvec3& r, double far) const {
    return cage_.truthOf(o, r, far).owed.value_or(INFINITY);
  }

 private:
  reference::CageTruth cage_;
  reference::CageDistance distance_;
  Box bounds_;
};

// A volume with a cage and distances.
class CagedDistances {
 public:
  CagedDistances(const fields::Occupancy& volume, int cell)
      : volume_(volume),
        pack_(packOf(volume, cell)),
        bytes_(bytesOf(pack_)),
        source_(bytes_),
        asset_(loadDistances(source_)) {}

  const MemorySource& source() const { return source_; }
  const runtime::Asset& operator*() const { return *asset_; }
  const fields::Occupancy& volume() const { return volume_; }
  // Where a pose puts a point of the lattice; what is shaken is so by the point's number, or a node's.
  static glm::vec3 place(const reference::CagePose& pose, const glm::ivec3& rest, int side, unsigned number) {
    glm::dvec3 at = pose.map(glm::dvec3(rest));
    std::mt19937 random(number + 1);
    for (int i = 0; i < 3; ++i)
      at[i] += pose.shaken * side * (static_cast<double>(random()) / 4294967296.0 - 0.5);
    return glm::vec3(at);
  }
  // Puts the nodes there, and returns what is true then.
  std::unique_ptr<CagedTruth> put(const reference::CagePose& pose, const runtime::Asset& asset,
                                  runtime::Pose& posed) const {
    const Cage& cage = asset.pack().parts()[0].cages[0];
    const std::span<glm::vec3> nodes = posed.nodes(0);
    for (std::uint32_t i = 0; i < cage.nodes(); ++i) nodes[i] = place(pose, cage.rest(i), cage.side, i);
    const reference::Volume volume{volume_.size, volume_.solid, 1, volume_.size};
    return std::make_unique<CagedTruth>(
        reference::CagedLevel{&cage, pack_.parts[0].cages[0].source(), 0, volume, {}}, nodes,
        [&](const glm::ivec3& corner) { return glm::vec3(pose.map(glm::dvec3(cage.side * corner))); });
  }
  // In one pose. finest: of the levels of distances that are there; `asset`: with these.
  std::unique_ptr<BentInstance> in(const reference::CagePose& pose, const runtime::Asset& asset,
                                   const glm::mat4& to_world, unsigned seed) const {
    runtime::Pose posed = *runtime::Pose::create(asset);
    auto truth = put(pose, asset, posed);
    return std::make_unique<BentInstance>(asset, std::move(posed), std::move(truth), to_world, seed);
  }
  // At rest; sheared, bent, twisted, scaled, squeezed; nodes moved within half a cell and within a cell.
  template <class Check>
  void inPoses(const Check& check) const {
    std::vector<reference::CagePose> poses = reference::namedCagePoses(volume_.size);
    for (const double shaken : {0.5, 1.0}) poses.push_back(reference::shakenPose(shaken));
    unsigned seed = 100;
    for (const reference::CagePose& pose : poses) {
      SCOPED_TRACE(pose.name);
      const glm::mat4 to_world =
          turned(static_cast<float>(seed), glm::vec3(2, 2, seed % 2 == 0 ? -2 : 2), {3, 10, -7});
      check(pose.name, *in(pose, *asset_, to_world, seed++));
    }
  }

 private:
  static RawPack packOf(const fields::Occupancy& volume, int cell) {
    RawPack pack = runtime::CagedAsset::packOf(volume, cell, Bend::kSweep, runtime::straight({0, 1}));
    pack.parts[0].distances = distancesOf(volume, static_cast<int>(pack.parts[0].levels.size()));
    return pack;
  }

  fields::Occupancy volume_;
  RawPack pack_;
  std::vector<std::byte> bytes_;
  MemorySource source_;
  std::unique_ptr<runtime::Asset> asset_;
};

// A thick block with a hollow: it has cubes inside, and nodes all around them.
inline fields::Occupancy hollowBlock() {
  fields::Occupancy block{glm::ivec3(61, 72, 58), std::vector<std::uint8_t>(61 * 72 * 58, 1)};
  for (int i = 0; i < 10 * 10 * 10; ++i)
    block.solid[block.index(glm::ivec3(i % 10, i / 10 % 10, i / 100) + 40)] = 0;
  return block;
}

}  // namespace kelp::test
