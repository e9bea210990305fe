// SPDX-License-Identifier: MIT
// A pack made in memory, opened and loaded.
#pragma once

#include <memory>
#include <vector>

#include "kelp/runtime/asset.h"
#include "support/test_pack.h"

namespace kelp::runtime {

struct Loaded {
  explicit Loaded(const RawPack& pack) : bytes(test::bytesOf(pack)), source(bytes) {
    auto opened = Asset::open(source.source());
    EXPECT_TRUE(opened);
    asset = *std::move(opened);
    EXPECT_TRUE(asset->loadAll());
  }
  std::vector<std::byte> bytes;
  MemorySource source;
  std::unique_ptr<Asset> asset;
};

// Straight knots at these places.
inline std::vector<Knot> straight(std::initializer_list<float> places) {
  std::vector<Knot> knots;
  for (const float at : places) knots.push_back({at, {0, at, 0}, {0, 1, 0}});
  return knots;
}

// A part of 24 x 40 x 24 voxels on these knots.
inline RawPack reed(std::initializer_list<float> places) {
  return test::packOf(test::ballClump({24, 40, 24}, 8, 1), straight(places));
}

}  // namespace kelp::runtime
