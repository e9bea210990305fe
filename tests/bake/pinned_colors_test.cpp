// SPDX-License-Identifier: MIT
// Facts about real files from outside kelp: where in the world they have a surface, and of what color.
// The figures come from a second reading of the files (accessors, node matrices, skins and PNGs by another
// program, rays against the triangles in double precision) and were looked at in pictures. Nothing here calls
// an importer, so a swapped axis, a lost matrix or a turned texture has nowhere to hide.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "kelp/bake/bake.h"
#include "kelp/runtime/instance.h"
#include "support/assets.h"
#include "support/test_pack.h"

namespace kelp {
namespace {

using Srgb = glm::ivec3;

// A ray along a world axis, from outside, and what it meets first.
struct Probe {
  const char* what;
  glm::vec3 from, along;
  std::optional<float> at;    // the coordinate along the ray; absent: nothing is there
  std::optional<Srgb> color;  // as the file's picture has it, 8 bits
};

struct Pinned {
  const char* name;
  const char* path;
  glm::vec3 low, high;  // world
  std::vector<Probe> probes;
};

constexpr glm::vec3 kLeft(-1, 0, 0), kRight(1, 0, 0), kDown(0, -1, 0), kUp(0, 1, 0), kBack(0, 0, -1),
    kFront(0, 0, 1);
constexpr Srgb kYellow(255, 216, 0), kBeak(255, 126, 0), kWing(255, 188, 0), kBlack(0, 0, 0);
constexpr Srgb kOrange(219, 135, 41), kWhite(255, 250, 242), kSock(83, 52, 16);
constexpr Srgb kSky(108, 173, 223), kSun(255, 255, 255), kHill(94, 136, 42), kGlass(0, 57, 40),
    kTyre(38, 38, 38), kBumper(142, 142, 142);

// The duck looks to +x, the fox to +z, the truck drives to +x, the cow looks to -z.
const std::vector<Pinned>& pinned() {
  static const std::vector<Pinned> files = {
      {"Duck",
       "gltf/draco_testdata/Duck.glb",
       {-0.693f, 0.099f, -0.613f},
       {0.962f, 1.640f, 0.539f},
       {{"beak", {3, 1.22f, 0}, kLeft, 0.862f, kBeak},
        {"breast", {3, 0.6f, 0}, kLeft, 0.832f, kYellow},
        {"tail", {-3, 0.6f, 0}, kRight, -0.687f, kYellow},
        {"back of the head", {-3, 1.3f, 0}, kRight, -0.121f, kYellow},
        {"crown", {0.35f, 3, 0}, kDown, 1.635f, kYellow},
        {"left wing", {-0.19f, 0.52f, 3}, kBack, 0.499f, kWing},
        {"right wing", {-0.19f, 0.52f, -3}, kFront, -0.569f, kWing},
        {"left flank before the wing", {0.5f, 0.5f, 3}, kBack, 0.463f, kYellow},
        {"left eye", {3, 1.356f, 0.131f}, kLeft, 0.675f, kBlack},
        {"right eye", {0.49f, 1.356f, -3}, kFront, -0.387f, kBlack},
        {"air above the tail", {-0.5f, 1.3f, 3}, kBack, std::nullopt, std::nullopt}}},
      {"Fox",
       "gltf/draco_testdata/Fox/Fox.gltf",
       {-12.593f, -0.122f, -88.095f},
       {12.593f, 78.907f, 66.625f},
       {{"back", {0, 200, -10}, kDown, 64.828f, kOrange},
        {"left flank", {100, 45, -10}, kLeft, 11.021f, kOrange},
        {"right flank", {-100, 45, -10}, kRight, -11.021f, kOrange},
        {"chest", {0, 40, 200}, kBack, 32.026f, kWhite},
        {"forehead", {0, 62, 200}, kBack, 58.263f, kOrange},
        {"belly", {0, -50, -5}, kUp, 32.696f, kWhite},
        {"rump", {0, 50, -200}, kFront, -50.691f, kOrange},
        {"tip of the tail", {0, 24, -200}, kFront, -83.809f, kWhite},
        {"fore leg", {100, 8, 18.5f}, kLeft, 8.3f, kSock},
        {"hind leg", {100, 8, -34}, kLeft, 8.42f, kSock},
        {"air between the legs", {100, 10, -5}, kLeft, std::nullopt, std::nullopt}}},
      {"CesiumMilkTruck",
       "gltf/draco_testdata/CesiumMilkTruck/CesiumMilkTruck.gltf",
       {-2.431f, 0.001f, -1.396f},
       {2.438f, 2.584f, 1.396f},
       {{"sky of the left emblem", {-1, 2.2f, 9}, kBack, 1.09f, kSky},
        {"hill of the left emblem", {-1, 1.3f, 9}, kBack, 1.09f, kHill},
        {"sun of the left emblem", {-0.72f, 2.07f, 9}, kBack, 1.09f, kSun},
        {"sky across from it", {-1.12f, 2.07f, 9}, kBack, 1.09f, kSky},
        {"sky of the right emblem", {-1, 2.2f, -9}, kFront, -1.1f, kSky},
        {"hill of the right emblem", {-1, 1.3f, -9}, kFront, -1.1f, kHill},
        {"sun of the right emblem", {-1.12f, 2.06f, -9}, kFront, -1.1f, kSun},
        {"sky across from it", {-0.72f, 2.06f, -9}, kFront, -1.1f, kSky},
        {"windscreen", {9, 1.9f, 0.5f}, kLeft, 1.525f, kGlass},
        {"bumper", {9, 0.5f, 0}, kLeft, 2.43f, kBumper},
        {"rear left tyre", {-1.35f, 0.1f, 9}, kBack, 1.053f, kTyre},
        {"front left tyre", {1.43f, 0.1f, 9}, kBack, 1.053f, kTyre},
        {"rear right tyre", {-1.35f, 0.1f, -9}, kFront, -1.053f, kTyre},
        {"front right tyre from below", {1.43f, -3, -0.9f}, kUp, 0.003f, kTyre},
        {"air between the wheels", {0, 0.1f, 9}, kBack, std::nullopt, std::nullopt}}},
      {"spot",
       "mesh/common3d/spot.obj",
       {-0.472f, -0.737f, -0.669f},
       {0.472f, 0.954f, 1.049f},
       {{"snout", {0, 0.2f, -5}, kFront, -0.629f, std::nullopt},
        {"rump", {0, 0, 5}, kBack, 0.989f, std::nullopt},
        {"back", {0, 5, 0.3f}, kDown, 0.304f, std::nullopt},
        {"horn", {0.17f, 5, -0.25f}, kDown, 0.947f, std::nullopt},
        {"cheek", {5, 0.6f, -0.4f}, kLeft, 0.266f, std::nullopt},
        {"hind leg", {5, -0.6f, 0.8f}, kLeft, 0.326f, std::nullopt},
        {"air between the legs", {5, -0.6f, 0.2f}, kLeft, std::nullopt, std::nullopt},
        {"air above the rump", {5, 0.6f, 0.5f}, kLeft, std::nullopt, std::nullopt}}}};
  return files;
}

int srgbOf(float linear) {
  const double c = static_cast<double>(linear);
  return static_cast<int>(
      std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
}

class PinnedColors : public testing::TestWithParam<std::size_t> {};

TEST_P(PinnedColors, AreWhereTheyBelongInTheWorld) {
  const Pinned& file = pinned()[GetParam()];
  KELP_ASSET(path, file.path);
  bake::Settings settings;
  bake::Report report;
  const std::vector<std::byte> bytes = test::bytesOf(bake::bake(path, settings, report));
  MemorySource source(bytes);
  auto opened = runtime::Asset::open(source.source());
  ASSERT_TRUE(opened);
  const auto asset = *std::move(opened);
  ASSERT_TRUE(asset->loadAll());
  const runtime::Instance instance{asset.get()};
  const float voxel = glm::length(asset->pack().parts()[0].to_object[0]);

  const Box box = runtime::bounds(instance);
  // The nodes of a cage lie up to a cell beyond its voxels.
  const Part& body = asset->pack().parts()[0];
  const float spare = (body.cages.empty() ? 1.1f : static_cast<float>(body.cages[0].side)) * voxel;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(box.min[axis], file.low[axis] + 1.1f * voxel) << "axis " << axis;
    EXPECT_GE(box.min[axis], file.low[axis] - spare) << "axis " << axis;
    EXPECT_GE(box.max[axis], file.high[axis] - 1.1f * voxel) << "axis " << axis;
    EXPECT_LE(box.max[axis], file.high[axis] + spare) << "axis " << axis;
  }
  for (const Probe& probe : file.probes) {
    const auto hit = runtime::raycast(instance, {probe.from, probe.along});
    ASSERT_EQ(hit.has_value(), probe.at.has_value() || probe.color.has_value()) << probe.what;
    if (!hit) continue;
    const float at = glm::dot(hit->position, glm::abs(probe.along));
    EXPECT_NEAR(at, probe.at.value_or(at), 1.5f * voxel) << probe.what;
    if (!probe.color) continue;
    const glm::vec4 color = asset->pack().palette()[hit->material].base_color;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(srgbOf(color[c]), (*probe.color)[c], 12) << probe.what << ", channel " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(RealFiles, PinnedColors, testing::Range(std::size_t{0}, pinned().size()),
                         [](const auto& index) { return std::string(pinned()[index.param].name); });

}  // namespace
}  // namespace kelp
