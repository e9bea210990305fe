// SPDX-License-Identifier: MIT
// Instances whose distances are asked and known: poses, matrices, and the truth in the world.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "bent_truth.h"
#include "kelp/runtime/distance.h"
#include "support/all_tests.h"
#include "support/distance_pack.h"
#include "swept_truth.h"

namespace kelp::test {

inline std::unique_ptr<runtime::Asset> loadDistances(const MemorySource& source, int finest = 0) {
  runtime::AssetOptions options;
  options.distance_level = finest;
  auto asset = runtime::Asset::open(source.source(), options).value();
  EXPECT_TRUE(asset->loadAll());
  return asset;
}

// A turned, scaled and moved matrix.
inline glm::mat4 turned(float angle, const glm::vec3& scale, const glm::vec3& at) {
  glm::mat4 m = glm::mat4_cast(glm::angleAxis(angle, glm::normalize(glm::vec3(1, 2, -0.5f))));
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  m[3] = glm::vec4(at, 1);
  return m;
}

// Four segments at rest.
inline std::vector<Knot> straightStem() {
  std::vector<Knot> knots;
  for (const float t : {0.0f, 0.2f, 0.5f, 0.8f, 1.0f}) knots.push_back({t, {0, t, 0}, {0, 1, 0}});
  return knots;
}

// Four segments that lean, stretch and come back.
inline std::vector<Knot> bentStem() {
  return {{0, {0, 0, 0}, {0, 1, 0}},
          {0.2f, {0.1f, 0.25f, 0}, {2, 1, 1}},
          {0.5f, {0.3f, 0.6f, -0.2f}, {-1, 1.5f, 0}},
          {0.8f, {-0.2f, 1, 0.1f}, {0, 0.8f, 2}},
          {1, {0, 1.4f, 0.2f}, {-3, 2, 0}}};
}

// One instance of one part, and random questions about it in the world. The truth is exact if the
// matrix scales x and z alike, for a swept part all three, and else still a distance to a point of the solid.
class BentInstance {
 public:
  BentInstance(const runtime::Asset& asset, const Layers& layers, std::span<const Knot> knots,
               const glm::mat4& to_world, unsigned seed, float roll = 0)
      : pose_(*runtime::Pose::create(asset)), random_(seed) {
    if (asset.pack().parts()[0].bend == Bend::kSweep) {
      truth_ = std::make_unique<SweptTruth>(layers, knots, roll);
    } else {
      const double tall{glm::length(to_world[1]) / glm::length(to_world[0])};
      truth_ = std::make_unique<BentTruth>(layers, knots, tall);
    }
    EXPECT_TRUE(pose_.setKnots(0, knots));
    pose_.motion(0)->roll = roll;
    place(asset, to_world);
  }
  // Another pose, and the truth of it.
  BentInstance(const runtime::Asset& asset, runtime::Pose pose, std::unique_ptr<SolidTruth> truth,
               const glm::mat4& to_world, unsigned seed)
      : pose_(std::move(pose)), truth_(std::move(truth)), random_(seed) {
    place(asset, to_world);
  }
  BentInstance(const BentInstance&) = delete;
  BentInstance& operator=(const BentInstance&) = delete;

  // Of our own, as libraries' distributions draw other points from the same seed. In braces: from left to
  // right.
  double unit() { return static_cast<double>(random_()) / 4294967296.0; }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 p = 2.0 * glm::dvec3{unit(), unit(), unit()} - 1.0;
      if (const double squared = glm::dot(p, p); squared > 0 && squared <= 1) return p / std::sqrt(squared);
    }
  }
  glm::vec3 anywhere() {
    const glm::dvec3 share{unit(), unit(), unit()};
    return glm::vec3(to_world_ * glm::dvec4(glm::mix(low_ - 20.0, high_ + 20.0, share), 1));
  }
  // A point about e^-3 to e^`most` voxels beside the solid.
  glm::vec3 beside(double most = 4) {
    const glm::dvec3 near = nearest(anywhere());
    return glm::vec3(near + voxel * std::exp(glm::mix(-3.0, most, unit())) * direction());
  }
  glm::dvec3 nearest(const glm::dvec3& world) const {
    return glm::dvec3(to_world_ * glm::dvec4(truth_->nearest(toPart(world)), 1));
  }
  double distanceOf(const glm::dvec3& world) const {
    return truth_->inside(toPart(world)) ? 0.0 : glm::distance(world, nearest(world));
  }
  bool inside(const glm::dvec3& world) const { return truth_->inside(toPart(world)); }

  runtime::Instance instance;
  double voxel = 0;  // the longest side of a level-0 voxel, in the world

 private:
  glm::dvec3 toPart(const glm::dvec3& world) const { return glm::dvec3(to_part_ * glm::dvec4(world, 1)); }

  void place(const runtime::Asset& asset, const glm::mat4& to_world) {
    instance = {&asset, &pose_, to_world};
    to_world_ = glm::dmat4(partToWorld(instance, 0).value());
    to_part_ = glm::inverse(to_world_);
    const Box box = truth_->bounds();
    low_ = glm::dvec3(box.min), high_ = glm::dvec3(box.max);
    for (int i = 0; i < 3; ++i) voxel = std::max(voxel, glm::length(glm::dvec3(to_world_[i])));
  }

  runtime::Pose pose_;
  std::unique_ptr<SolidTruth> truth_;
  std::mt19937 random_;
  glm::dmat4 to_world_{1}, to_part_{1};
  glm::dvec3 low_{0}, high_{0};
};

}  // namespace kelp::test
