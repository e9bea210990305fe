// SPDX-License-Identifier: MIT
// Packs that stream, and a view of them, for tests of uploads.
#pragma once

#include <memory>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "cpu_backend.h"
#include "support/cage_pack.h"
#include "support/distance_pack.h"
#include "support/fog_pack.h"

namespace kelp::test {

using runtime::Instance;

inline constexpr std::uint64_t kTinyPool = std::uint64_t{512} << 10;
inline constexpr glm::ivec2 kPicture(40, 30);

inline draw::View lookFrom(const glm::vec3& eye, const glm::vec3& target) {
  draw::View view;
  view.camera.world_to_eye = glm::lookAt(eye, target, glm::vec3(0, 1, 0));
  view.camera.eye_to_clip = glm::perspective(0.8f, 4.0f / 3, 0.01f, 100.0f);
  view.camera.viewport = kPicture;
  view.quality.pixels_per_voxel = 0.2f;  // a small picture that asks for as much as a large one
  return view;
}

// A pack twice: as it streams, and completely in memory.
struct StreamedPack {
  explicit StreamedPack(const RawPack& pack) : bytes(bytesOf(pack)), source(bytes) {
    runtime::AssetOptions options;
    options.distance_level = 0;
    streamed = runtime::Asset::open(source.source(), options).value();
    whole = runtime::Asset::open(source.source(), options).value();
    EXPECT_TRUE(whole->loadAll());
  }
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<runtime::Asset> streamed, whole;
};

// Solids, one with distances and one with cages, and fog: much more than the pool holds.
inline std::vector<std::unique_ptr<StreamedPack>> crowd() {
  std::vector<std::unique_ptr<StreamedPack>> packs;
  packs.push_back(std::make_unique<StreamedPack>(packOf(ballClump({60, 80, 50}, 20, 2))));
  packs.push_back(std::make_unique<StreamedPack>(distancePackOf(ballClump({40, 56, 40}, 14, 5))));
  packs.push_back(std::make_unique<StreamedPack>(
      fogPack(fogOf({40, 56, 36}, puffs, [](const glm::dvec3& p) { return puffs(p) * p.y; }), 0.2f)));
  packs.push_back(std::make_unique<StreamedPack>(cagedPackOf(ballClump({80, 60, 70}, 24, 7), 8)));
  return packs;
}
inline std::vector<Instance> instancesOf(const std::vector<std::unique_ptr<StreamedPack>>& packs) {
  std::vector<Instance> instances;
  for (const auto& pack : packs) {
    instances.push_back({pack->streamed.get()});
    instances.back().to_world[3].x = 1.6f * static_cast<float>(instances.size() - 1);
  }
  return instances;
}

}  // namespace kelp::test
