// SPDX-License-Identifier: MIT
// A file baked to a pack in memory, opened as the runtime opens it, and its picture beside triangles.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/runtime/instance.h"
#include "support/rasterizer.h"
#include "support/test_pack.h"

namespace kelp::bake::test {

class BakedAsset {
 public:
  BakedAsset(const std::filesystem::path& path, Settings settings, int resolution) {
    settings.resolution = resolution;
    settings.resolution_given = true;
    settings.threads = 2;
    pack_ = bake::bake(path, settings, report);
    bytes_ = kelp::test::bytesOf(pack_);
    source_.emplace(bytes_);
    auto opened = runtime::Asset::open(source_->source());
    EXPECT_TRUE(opened);
    asset_ = *std::move(opened);
  }
  const RawPack& pack() const { return pack_; }
  runtime::Asset& asset() const { return *asset_; }
  int partNamed(const std::string& name) const {
    for (std::size_t i = 0; i < pack_.parts.size(); ++i)
      if (pack_.parts[i].name == name) return static_cast<int>(i);
    ADD_FAILURE() << "no part '" << name << "'";
    return 0;
  }
  Report report;

 private:
  RawPack pack_;
  std::vector<std::byte> bytes_;
  std::optional<MemorySource> source_;
  std::unique_ptr<runtime::Asset> asset_;
};

// Voxels seen from one side beside triangles, given corner by corner: intersection over union of the two
// silhouettes, in a square of so many pixels a side. `yaw` in degrees; null: the pose at rest.
inline double agreement(const BakedAsset& baked, const std::vector<glm::dvec3>& corners, double yaw,
                        const runtime::Pose* pose = nullptr, int pixels = 160) {
  EXPECT_TRUE(baked.asset().loadAll());
  const runtime::Instance instance{&baked.asset(), pose};
  glm::dvec3 low(1e30), high(-1e30);
  for (const glm::dvec3& p : corners) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const auto camera = kelp::test::OrthographicCamera::around(low, high, yaw, 10, pixels);
  const double back = 2 * camera.depthRange(low, high);
  kelp::test::Rasterizer triangles(camera);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    triangles.draw(static_cast<std::uint32_t>(i / 3), corners[i], corners[i + 1], corners[i + 2]);
  int both = 0, either = 0;
  for (int y = 0; y < pixels; ++y) {
    for (int x = 0; x < pixels; ++x) {
      const bool voxel =
          runtime::raycast(instance, {glm::vec3(camera.pixelOrigin(x, y, back)), glm::vec3(camera.forward)})
              .has_value();
      const bool triangle = triangles.at(x, y).hit();
      both += voxel && triangle;
      either += voxel || triangle;
    }
  }
  return static_cast<double>(both) / either;
}

}  // namespace kelp::bake::test
