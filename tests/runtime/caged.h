// SPDX-License-Identifier: MIT
// Assets of one part with cages, and poses of it.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "kelp/cages/posed_cage.h"
#include "kelp/fields/cages.h"
#include "loaded.h"

namespace kelp::runtime {

// Thin and thick, with several pieces in some cubes.
inline fields::Occupancy twoLegs(const glm::ivec3& size) {
  fields::Occupancy volume = test::ballClump(size, 12, 3);
  for (int y = 0; y < size.y; ++y)
    for (const int x : {5, 8})
      for (const int z : {9, 10}) volume.solid[volume.index({x, y, z})] = 1;
  for (int i = 0; i < 20 * 20 * 20; ++i)
    volume.solid[volume.index(glm::ivec3(i % 20, i / 20 % 20, i / 400) + 2)] = 1;
  return volume;
}

struct CagedAsset {
  CagedAsset(const fields::Occupancy& of, int cell, Bend bend,
             std::vector<Knot> knots = straight({0, 0.5f, 1}))
      : volume(of), loaded(packOf(of, cell, bend, std::move(knots))) {}
  static RawPack packOf(const fields::Occupancy& of, int cell, Bend bend, std::vector<Knot> knots) {
    RawPack pack = test::packOf(of, std::move(knots));
    pack.parts[0].bend = bend;
    RawPart& part = pack.parts[0];
    part.cell = cell;
    part.cages = fields::buildCages(fields::SolidBits(of, 1), static_cast<int>(part.levels.size()), cell);
    return pack;
  }

  const Asset& operator*() const { return *loaded.asset; }
  const Part& part() const { return loaded.asset->pack().parts()[0]; }
  Pose pose() const { return Pose::create(*loaded.asset).value(); }
  Instance instance(const Pose& pose) const { return {loaded.asset.get(), &pose}; }
  // With its tree.
  PosedCage posed(const Pose& pose, int cage = 0) const {
    return posedCage(instance(pose), 0, cage, CageUse::kTree).value();
  }
  // Part space -> the world, with the identity as matrix.
  glm::vec3 toObject(const glm::vec3& voxels) const { return part().to_object * glm::vec4(voxels, 1); }

  fields::Occupancy volume;
  Loaded loaded;
};

// The same model without cages, which its spline alone bends.
struct PlainTwin {
  PlainTwin(const fields::Occupancy& volume, Bend bend, std::vector<Knot> rest,
            const std::vector<Knot>& knots)
      : loaded(packOf(volume, bend, std::move(rest))), pose(Pose::create(*loaded.asset).value()) {
    pose.setKnots(0, knots).value();
  }
  static RawPack packOf(const fields::Occupancy& volume, Bend bend, std::vector<Knot> knots) {
    RawPack pack = test::packOf(volume, std::move(knots));
    pack.parts[0].bend = bend;
    return pack;
  }
  Instance instance() const { return {loaded.asset.get(), &pose}; }

  Loaded loaded;
  Pose pose;
};

inline std::vector<Knot> leaning() {
  return {{0, {0, 0, 0}, {0, 1, 0}},
          {0.5f, {0.1f, 0.52f, -0.06f}, {0.5f, 0.9f, -0.1f}},
          {1, {0.45f, 0.9f, 0}, {0.8f, 0.6f, 0.3f}}};
}

// Moves each node by up to `far` voxels along each axis.
inline void shakeNodes(std::span<glm::vec3> nodes, float far, unsigned seed) {
  std::mt19937 random(seed);
  for (glm::vec3& node : nodes)
    for (int axis = 0; axis < 3; ++axis)
      node[axis] += far * (static_cast<float>(random()) / 2147483648.0f - 1.0f);
}

}  // namespace kelp::runtime
