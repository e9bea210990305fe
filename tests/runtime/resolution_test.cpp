// SPDX-License-Identifier: MIT
// One shape at 128 and at 256 voxels of height. All that a game does to a pose is in heights of the part. So
// the same calls give both packs the same pose and the same points in the world, and pictures that differ by
// a coarse voxel at most.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "kelp/runtime/instance.h"
#include "kelp/runtime/spring.h"
#include "loaded.h"

namespace kelp::runtime {
namespace {

constexpr float kVoxel = 1.0f / 128;  // of the coarser one, meters: the shape is 1 m high

// A body with bulges, without gaps that a voxel could close.
fields::Occupancy bulges(const glm::ivec3& size) {
  fields::Occupancy volume{
      size, std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                                      static_cast<std::size_t>(size.z))};
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 p = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(size.y) - glm::dvec3(0.125, 0, 0.125);
        const double radius = 0.08 + 0.03 * std::cos(14 * p.y);
        volume.solid[volume.index({x, y, z})] = p.x * p.x + 2 * p.z * p.z < radius * radius;
      }
  return volume;
}

RawPack shapeOf(int height) {
  RawPack pack = test::packOf(bulges({height / 4, height, height / 4}), straight({0, 0.3f, 0.7f, 1}));
  pack.parts[0].automatic_tangents = 15;
  RawClip sway{"sway", 3, {}, {}};
  sway.waves = {{0, 2, Target::kKnotOffset, {0.05f, 0, 0.03f}, 3, 0.1f},
                {0, 3, Target::kKnotOffset, {0.12f, 0, -0.04f}, 2, 0.3f},
                {0, 3, Target::kKnotTangent, {0.3f, 0, 0.1f}, 2, 0.2f}};
  sway.tracks = {{0,
                  1,
                  Target::kKnotOffset,
                  Interpolation::kCubic,
                  {{0, glm::vec4(0), {}, {}}, {2, {0, 0.02f, 0.04f, 0}, {}, {}}}}};
  pack.clips.push_back(sway);
  return pack;
}

// The poses of an instance in a game, one for each moment.
std::vector<Pose> played(const Asset& asset, const glm::mat4& to_world) {
  std::vector<Pose> poses;
  Spring spring = *Spring::create(asset);
  EXPECT_TRUE(spring.push(0, {0.9f, 0, -0.5f}));
  EXPECT_TRUE(spring.setWind(0, {3, 0, 4}));
  for (int frame = 0; frame < 4; ++frame) {
    Pose& pose = poses.emplace_back(*Pose::create(asset));
    const Instance instance{&asset, &pose, to_world};
    if (frame == 2) {
      EXPECT_TRUE(spring.pushInWorld(instance, 0, {0.5f, 0.1f, 0.3f}));
    }
    if (frame == 3) {
      EXPECT_TRUE(spring.setWindInWorld(instance, 0, {-2, 0, 5}));
    }
    EXPECT_TRUE(addClip(asset, 0, 0.7 * frame, 0.8f, pose));
    EXPECT_TRUE(pose.move(0, 1, {0.04f, 0.01f, 0}));
    EXPECT_TRUE(pose.move(0, 3, {-0.15f, 0.05f, 0.1f}));
    EXPECT_TRUE(spring.step(0.15f));
    EXPECT_TRUE(spring.addTo(pose));
    EXPECT_TRUE(pose.check());
  }
  return poses;
}

class Resolutions : public testing::Test {
 protected:
  const Loaded coarse_{shapeOf(128)}, fine_{shapeOf(256)};
  const glm::mat4 to_world_ = glm::scale(glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0.5f, -0.2f, 1)),
                                                     0.4f, glm::normalize(glm::vec3(0.1f, 1, 0.2f))),
                                         glm::vec3(1.25f));
  const std::vector<Pose> coarse_poses_ = played(*coarse_.asset, to_world_),
                          fine_poses_ = played(*fine_.asset, to_world_);
};

TEST_F(Resolutions, GiveTheSamePosesAndPoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  double moved = 0;
  for (std::size_t i = 0; i < coarse_poses_.size(); ++i) {
    SCOPED_TRACE(i);
    for (std::size_t k = 0; k < 4; ++k) {
      const Knot &a = coarse_poses_[i].knots(0)[k], &b = fine_poses_[i].knots(0)[k];
      if (i < 2) {  // no step of these knows the number of voxels
        EXPECT_EQ(a.position, b.position);
        EXPECT_EQ(a.tangent, b.tangent);
      }
      EXPECT_LT(glm::distance(a.position, b.position), 1e-6f);
      EXPECT_LT(glm::distance(a.tangent, b.tangent), 4e-6f);
    }
    const Instance a{coarse_.asset.get(), &coarse_poses_[i], to_world_},
        b{fine_.asset.get(), &fine_poses_[i], to_world_};
    for (int n = 0; n < 2000; ++n) {
      const glm::vec3 rest(0.125f * unit(random), 0.5f + 0.5f * unit(random), 0.125f * unit(random));
      const glm::vec3 p = toWorld(a, 0, rest).value(), q = toWorld(b, 0, rest).value();
      // Some twenty roundings of numbers up to 2 m: 2 m / 2^24 each.
      EXPECT_LT(glm::distance(p, q), 20 * 2 * 0x1p-24f);
      moved = std::max(moved, double{glm::distance(p, glm::vec3(to_world_ * glm::vec4(rest, 1)))});
      const std::optional<glm::vec3> back = toRest(a, 0, p), back_of_other = toRest(b, 0, p);
      // A hundredth of a voxel: at the ends the map back may amplify a rounding.
      if (back && back_of_other) {
        EXPECT_LT(glm::distance(*back, *back_of_other), 0.01f * kVoxel);
      }
    }
  }
  EXPECT_GT(moved, 20 * kVoxel);
}

// Distances along parallel rays; HUGE_VALF: no hit.
constexpr int kSide = 300;               // rays in a row, and rows
constexpr float kPixel = 0.6f * kVoxel;  // from ray to ray
std::vector<float> distancesOf(const Instance& instance) {
  std::vector<float> out;
  const glm::vec3 towards = glm::normalize(glm::vec3(0.3f, -0.2f, -1)),
                  right = glm::normalize(glm::cross(towards, glm::vec3(0, 1, 0))),
                  up = glm::cross(right, towards);
  const glm::vec3 middle(instance.to_world * glm::vec4(0, 0.5f, 0, 1));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const glm::vec2 at = kPixel * (glm::vec2(x, y) - 0.5f * kSide);
      const auto hit = raycast(instance, {middle + at.x * right + at.y * up - 3.0f * towards, towards});
      out.push_back(hit ? hit->t : HUGE_VALF);
    }
  return out;
}

// How many distances of `a` are not between the least and the greatest of `b` so far around, give or take as
// much.
int strangers(const std::vector<float>& a, const std::vector<float>& b, float apart) {
  const int around = static_cast<int>(std::ceil(apart / kPixel));
  int count = 0;
  for (int y = around; y < kSide - around; ++y)
    for (int x = around; x < kSide - around; ++x) {
      float low = HUGE_VALF, high = 0;
      for (int v = -around; v <= around; ++v)
        for (int u = -around; u <= around; ++u) {
          const float other = b[static_cast<std::size_t>((y + v) * kSide + x + u)];
          low = std::min(low, other);
          high = std::max(high, other);
        }
      const float t = a[static_cast<std::size_t>(y * kSide + x)];
      count += t < low - apart || t > high + apart;
    }
  return count;
}

TEST_F(Resolutions, GiveTheSameOutlineWithinAVoxel) {
  const float apart = 1.25f * kVoxel;  // a voxel, in the world
  const Instance rest{coarse_.asset.get(), nullptr, to_world_};
  const std::vector<float> at_rest = distancesOf(rest);
  for (std::size_t i = 0; i < coarse_poses_.size(); ++i) {
    SCOPED_TRACE(i);
    const Instance a{coarse_.asset.get(), &coarse_poses_[i], to_world_},
        b{fine_.asset.get(), &fine_poses_[i], to_world_};
    const std::vector<float> of_a = distancesOf(a), of_b = distancesOf(b);
    EXPECT_GT(std::count_if(of_a.begin(), of_a.end(), [](float t) { return t < HUGE_VALF; }), 5000);
    EXPECT_EQ(strangers(of_a, of_b, apart), 0);
    EXPECT_EQ(strangers(of_b, of_a, apart), 0);
    EXPECT_GT(strangers(of_a, at_rest, apart), 1000) << "the pose moves it";
  }
}

}  // namespace
}  // namespace kelp::runtime
