// SPDX-License-Identifier: MIT
// Rigs without a model: a pack in memory with a stick of voxels for each part. The runtime plays its clips.
// Its RIGS, CLIP and SOCK chunks replace those of the real pack (see rerigged.h).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "kelp/runtime/pose.h"
#include "pack_rig.h"

namespace kelp::view {

class RigSketch {
 public:
  // kMisuse, with the reason, for rigs that a pack cannot hold.
  static Result<std::unique_ptr<RigSketch>> make(const PackRig& rig);
  RigSketch(const RigSketch&) = delete;
  RigSketch& operator=(const RigSketch&) = delete;

  const runtime::Asset& asset() const { return *asset_; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  RigSketch() = default;

  std::vector<std::byte> bytes_;
  MemorySource memory_{std::span<const std::byte>()};
  std::unique_ptr<runtime::Asset> asset_;
};

}  // namespace kelp::view
