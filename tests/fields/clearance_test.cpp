// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>

#include "every_target.h"
#include "kelp/fields/fields.h"
#include "reference_fields.h"
#include "volumes.h"

namespace kelp::test {
namespace {

// Calls visit(neighbor, inside the volume) for the 26 neighbors of a voxel, itself too.
template <class Visit>
void aroundOf(const glm::ivec3& voxel, const glm::ivec3& size, Visit visit) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const glm::ivec3 n = voxel + glm::ivec3(dx, dy, dz);
        visit(n, n.x >= 0 && n.y >= 0 && n.z >= 0 && n.x < size.x && n.y < size.y && n.z < size.z);
      }
    }
  }
}

TEST(SquaredClearance, IsTheDistanceBetweenClosedCubes) {
  for (const NamedVolume& volume : hardVolumes()) {
    const auto expected = bruteSquaredClearance(volume.occupancy);
    forEveryTarget([&](const char* target) {
      ASSERT_EQ(fields::squaredClearance(volume.occupancy, 2), expected) << volume.name << " on " << target;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(Dilate26, SetsWhatHasASolidNeighbor) {
  for (const NamedVolume& volume : hardVolumes()) {
    const auto expected = volumeWhere(volume.occupancy.size, [&](const glm::ivec3& v) {
      bool any = false;
      aroundOf(v, volume.occupancy.size, [&](const glm::ivec3& n, bool inside) {
        any |= inside && volume.occupancy.solid[volume.occupancy.index(n)];
      });
      return any;
    });
    forEveryTarget([&](const char* target) {
      ASSERT_EQ(fields::dilate26(volume.occupancy, 2), expected.solid) << volume.name << " on " << target;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(SurfaceVoxels, AreSolidWithAnEmptyOrOutsideNeighbor) {
  std::vector<NamedVolume> volumes = hardVolumes(), wide = wideVolumes();
  volumes.insert(volumes.end(), wide.begin(), wide.end());
  for (const NamedVolume& volume : volumes) {
    std::vector<std::uint64_t> expected;
    const auto surface = volumeWhere(volume.occupancy.size, [&](const glm::ivec3& v) {
      bool open = false;
      aroundOf(v, volume.occupancy.size, [&](const glm::ivec3& n, bool inside) {
        open |= !inside || !volume.occupancy.solid[volume.occupancy.index(n)];
      });
      return open && volume.occupancy.solid[volume.occupancy.index(v)];
    });
    for (std::size_t i = 0; i < surface.solid.size(); ++i) {
      if (surface.solid[i]) expected.push_back(i);
    }
    forEveryTarget([&](const char* target) {
      ASSERT_EQ(fields::surfaceVoxels(volume.occupancy, 2), expected) << volume.name << " on " << target;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(Neighbors, AreTheSameForAnyNumberOfThreads) {
  const auto volume = randomVolume({45, 31, 67}, 0.9, 3);
  for (const int threads : {0, 2, 3, 4}) {
    EXPECT_EQ(fields::dilate26(volume, threads), fields::dilate26(volume, 1));
    EXPECT_EQ(fields::surfaceVoxels(volume, threads), fields::surfaceVoxels(volume, 1));
    EXPECT_EQ(fields::squaredClearance(volume, threads), fields::squaredClearance(volume, 1));
  }
}

TEST(Neighbors, RefuseSizesThatDoNotFit) {
  auto volume = emptyVolume({4, 5, 6});
  volume.size.x = 5;
  EXPECT_THROW(fields::dilate26(volume, 1), std::invalid_argument);
  EXPECT_THROW(fields::surfaceVoxels(volume, 1), std::invalid_argument);
  EXPECT_THROW(fields::squaredClearance(volume, 1), std::invalid_argument);
  EXPECT_THROW(fields::coarser(volume), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test
