// SPDX-License-Identifier: MIT
#include "kelp/fields/solid_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "every_target.h"
#include "kelp/formats/brick.h"
#include "volumes.h"

namespace kelp::test {
namespace {

bool isWithin(const glm::ivec3& v, const glm::ivec3& size) {
  return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z;
}

// Every bit that may be read, margins included.
void expectBits(const fields::SolidBits& bits, const fields::Occupancy& volume, const std::string& what) {
  ASSERT_EQ(bits.size(), volume.size) << what;
  const glm::ivec3 grid = brickGrid(volume.size);
  for (int z = -1; z <= kBrickSide * grid.z; ++z) {
    for (int y = -1; y <= kBrickSide * grid.y; ++y) {
      for (int word = -1; word <= bits.words(); ++word) {
        for (int i = 0; i < fields::SolidBits::kWordVoxels; ++i) {
          const glm::ivec3 v(word * fields::SolidBits::kWordVoxels + i, y, z);
          const bool solid = isWithin(v, volume.size) && volume.solid[volume.index(v)] != 0;
          ASSERT_EQ(bits.row(y, z)[word] >> i & 1, solid) << what << ": " << v.x << " " << y << " " << z;
        }
      }
      for (int x = 0; x < grid.x && y >= 0 && z >= 0; ++x)
        ASSERT_EQ(bits.eight(x, y, z), bits.row(y, z)[x / 8] >> (8 * (x % 8)) & 0xff) << what;
    }
  }
}

TEST(SolidBits, AreTheOccupancyWithEmptyMargins) {
  for (const NamedVolume& volume : wideVolumes()) {
    fields::Occupancy any = volume.occupancy;  // anything but 0 is solid
    for (std::size_t i = 0; i < any.solid.size(); ++i)
      if (any.solid[i]) any.solid[i] = static_cast<std::uint8_t>(1 << i % 8);
    forEveryTarget([&](const char* target) {
      const fields::SolidBits bits(any, 2);
      expectBits(bits, any, volume.name + " on " + target);
      EXPECT_EQ(bits.count(2),
                static_cast<std::uint64_t>(any.solid.size()) -
                    static_cast<std::uint64_t>(std::count(any.solid.begin(), any.solid.end(), 0)))
          << volume.name;
    });
    if (HasFatalFailure()) return;
  }
}

TEST(SolidBits, AreCountedOnAnyNumberOfThreads) {
  const fields::Occupancy volume = randomVolume({300, 131, 140}, 0.4, 6);  // several pieces of work
  const auto solid =
      static_cast<std::uint64_t>(std::count(volume.solid.begin(), volume.solid.end(), std::uint8_t{1}));
  for (const int threads : {0, 1, 3}) EXPECT_EQ(fields::SolidBits(volume, threads).count(threads), solid);
}

TEST(SolidBits, AreHalvedLikeOccupancies) {
  for (const NamedVolume& volume : wideVolumes()) {
    for (const int threads : {1, 3}) {
      const fields::SolidBits half = fields::coarser(fields::SolidBits(volume.occupancy, threads), threads);
      expectBits(half, fields::coarser(volume.occupancy), volume.name);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(SolidBits, RefuseSizesThatDoNotFit) {
  auto volume = emptyVolume({4, 5, 6});
  volume.size.x = 5;
  EXPECT_THROW(fields::SolidBits(volume, 1), std::invalid_argument);
  EXPECT_THROW(fields::SolidBits(glm::ivec3(0, 1, 1)), std::invalid_argument);
  volume.size = glm::ivec3(fields::kMaxSide);  // without taking memory for all of them first
  EXPECT_THROW(fields::SolidBits(volume, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kelp::test
