// SPDX-License-Identifier: MIT
// The same pack, pose and instance twice: by C and by C++. Equal means equal to the last bit.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "../formats/tiny_cage_pack.h"
#include "../formats/tiny_distance_pack.h"
#include "../formats/tiny_fog_pack.h"
#include "kelp/kelp.h"
#include "kelp/kelp.hpp"
#include "support/random_pack.h"
#include "support/scratch.h"

namespace kelp::test {

// The path of a small pack: "distance" has a sheared and a swept part, a clip with a wave and tracks,
// sockets, joints and distances; "solid" has no distances; "fog" has fog; "cage" has cages, "morphs" morph
// targets.
inline std::string packFile(const std::string& name) {
  static const Scratch scratch;
  static std::map<std::string, std::string> paths;  // each is made once
  std::string& path = paths[name];
  if (path.empty()) {
    RawPack pack = name == "distance" ? makeTinyDistancePack()
                   : name == "fog"    ? makeTinyFogPack()
                   : name == "cage"   ? makeTinyCagePack()
                   : name == "morphs" ? makeTinyMorphPack()
                                      : makeTinyPack();
    if (name == "distance") pack.joints = makeTinyJointPack().joints;
    path = scratch.write(name + ".kelp", std::span<const std::byte>(writeToMemory(pack))).string();
  }
  return path;
}

#define EXPECT_KELP(result, call) EXPECT_EQ(kelp_result{result}, call) << kelp::test::lastError().text
#define ASSERT_KELP(call) ASSERT_EQ(kelp_result{KELP_OK}, call) << kelp::test::lastError().text

inline kelp_error lastError() {
  kelp_error error = {};
  error.struct_size = sizeof error;
  EXPECT_EQ(kelp_result{KELP_OK}, kelp_last_error(&error));
  return error;
}

// A struct of kelp.h, with its size.
template <class T>
T sized() {
  T out = {};
  out.struct_size = sizeof(T);
  return out;
}

// C's numbers and C++'s, of the same number of bytes.
template <class A, class B>
void expectSame(const A& c, const B& cpp, const char* what) {
  static_assert(sizeof(A) == sizeof(B));
  EXPECT_EQ(0, std::memcmp(&c, &cpp, sizeof(A))) << what;
}
inline std::string toString(const kelp_text& text) { return {text.data, text.size}; }

// Random numbers, the same in each run.
class Dice {
 public:
  float in(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  glm::vec3 vec3(float reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }

 private:
  std::mt19937 random_{7};
};

// The memory of a host, counted. refuse_at: the number of the allocation that fails.
struct Memory {
  std::atomic<long> live{0}, calls{0};
  long refuse_at = -1;

  kelp_allocator allocator() {
    auto out = sized<kelp_allocator>();
    out.user = this;
    out.allocate = [](void* user, std::size_t bytes) -> void* {
      Memory& self = *static_cast<Memory*>(user);
      if (self.calls++ == self.refuse_at) return nullptr;
      self.live += static_cast<long>(bytes);
      return std::malloc(bytes);
    };
    out.deallocate = [](void* user, void* memory, std::size_t bytes) {
      static_cast<Memory*>(user)->live -= static_cast<long>(bytes);
      std::free(memory);
    };
    return out;
  }
};

// C++'s view in C.
template <class View>
kelp_view viewOf(const View& view) {
  auto out = sized<kelp_view>();
  EXPECT_KELP(KELP_OK, kelp_view_defaults(&out));
  std::memcpy(out.world_to_eye, &view.camera.world_to_eye, sizeof out.world_to_eye);
  std::memcpy(out.eye_to_clip, &view.camera.eye_to_clip, sizeof out.eye_to_clip);
  out.viewport[0] = view.camera.viewport.x;
  out.viewport[1] = view.camera.viewport.y;
  out.pixels_per_voxel = view.quality.pixels_per_voxel;
  return out;
}

inline void expectStats(const draw::Stats& expected, const kelp_stats& stats) {
  EXPECT_EQ(expected.instances, stats.instances);
  EXPECT_EQ(expected.culled, stats.culled);
  EXPECT_EQ(expected.left_out, stats.left_out);
  EXPECT_EQ(expected.draws, stats.draws);
  EXPECT_EQ(expected.pending, stats.pending);
  EXPECT_EQ(expected.bytes_uploaded, stats.bytes_uploaded);
  EXPECT_EQ(expected.gpu_bytes, stats.gpu_bytes);
}

struct BothAssets {
  explicit BothAssets(const std::string& path, int distance_level = 0) {
    auto options = sized<kelp_asset_options>();
    EXPECT_KELP(KELP_OK, kelp_asset_options_defaults(&options));
    options.distance_level = distance_level;
    EXPECT_KELP(KELP_OK, kelp_asset_open_file(path.c_str(), &options, &c));
    EXPECT_KELP(KELP_OK, kelp_asset_load_all(c));
    runtime::AssetOptions cpp_options;
    if (distance_level != KELP_NONE) cpp_options.distance_level = distance_level;
    cpp = std::move(runtime::Asset::open(path.c_str(), cpp_options)).value();
    cpp->loadAll().value();
  }
  ~BothAssets() { EXPECT_KELP(KELP_OK, kelp_asset_destroy(c)); }
  BothAssets(const BothAssets&) = delete;
  BothAssets& operator=(const BothAssets&) = delete;

  kelp_asset c = {};
  std::unique_ptr<runtime::Asset> cpp;
};

struct BothPoses {
  explicit BothPoses(const BothAssets& assets) : cpp(std::move(runtime::Pose::create(*assets.cpp)).value()) {
    EXPECT_KELP(KELP_OK, kelp_pose_create(assets.c, nullptr, &c));
  }
  ~BothPoses() { EXPECT_KELP(KELP_OK, kelp_pose_destroy(c)); }
  BothPoses(const BothPoses&) = delete;
  BothPoses& operator=(const BothPoses&) = delete;

  void expectEqual() const {
    std::int32_t parts = -1;
    EXPECT_KELP(KELP_OK, kelp_pose_get_parts(c, &parts));
    ASSERT_EQ(cpp.parts(), parts);
    for (int part = 0; part < parts; ++part) {
      std::array<kelp_knot, 64> knots = {};
      std::uint32_t count = 0;
      EXPECT_KELP(KELP_OK, kelp_pose_get_knots(c, part, knots.data(), 64, &count));
      ASSERT_EQ(cpp.knots(part).size(), count);
      EXPECT_EQ(0, std::memcmp(knots.data(), cpp.knots(part).data(), cpp.knots(part).size_bytes())) << part;
      kelp_motion motion = {};
      EXPECT_KELP(KELP_OK, kelp_pose_get_motion(c, part, &motion));
      const runtime::Motion& expected = *cpp.motion(part);
      expectSame(motion.translation, expected.translation, "translation");
      EXPECT_EQ(expected.rotation,
                glm::quat(motion.rotation[3], motion.rotation[0], motion.rotation[1], motion.rotation[2]));
      expectSame(motion.scale, expected.scale, "scale");
      EXPECT_EQ(expected.roll, motion.roll);
    }
  }

  kelp_pose c = {};
  runtime::Pose cpp;
};

inline kelp_instance instanceOf(kelp_asset asset, kelp_pose pose, const glm::mat4& to_world = glm::mat4(1)) {
  auto out = sized<kelp_instance>();
  EXPECT_KELP(KELP_OK, kelp_instance_defaults(&out));
  out.asset = asset;
  out.pose = pose;
  std::memcpy(out.to_world, &to_world, sizeof out.to_world);
  return out;
}

// Three instances of one pack, in poses and places of their own.
class BothInstances {
 public:
  static constexpr std::uint32_t kCount = 3;
  explicit BothInstances(const BothAssets& assets) {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      BothPoses& pose = *poses_.emplace_back(std::make_unique<BothPoses>(assets));
      const double seconds = 0.4 + 0.7 * i;
      if (assets.cpp->pack().clips().size() > 0) {
        EXPECT_KELP(KELP_OK, kelp_pose_add_clip(pose.c, assets.c, 0, seconds, 1, KELP_PLAY_LOOP));
        addClip(*assets.cpp, 0, seconds, 1, pose.cpp).value();
      }
      glm::mat4 to_world = glm::translate(glm::mat4(1), glm::vec3(14 * static_cast<float>(i), 1, 0));
      to_world = glm::rotate(to_world, 0.6f * static_cast<float>(i), glm::vec3(0, 1, 0));
      c.push_back(instanceOf(assets.c, pose.c, to_world));
      cpp.push_back({assets.cpp.get(), &pose.cpp, to_world});
    }
  }
  std::vector<kelp_instance> c;
  std::vector<runtime::Instance> cpp;

 private:
  std::vector<std::unique_ptr<BothPoses>> poses_;
};

}  // namespace kelp::test
