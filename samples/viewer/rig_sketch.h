// SPDX-License-Identifier: MIT
// Rigs without a model: a pack in memory of one voxel a part. The runtime plays its clips, and its RIGS and CLIP chunks stand in for those of the
// pack whose rigs they are.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "kelp/runtime/pose.h"
#include "pack_rig.h"

namespace viewer {

class RigSketch {
 public:
  // kMisuse with a word for rigs that no pack can hold.
  static kelp::Result<std::unique_ptr<RigSketch>> make(const PackRig& rig);
  RigSketch(const RigSketch&) = delete;
  RigSketch& operator=(const RigSketch&) = delete;

  const kelp::runtime::Asset& asset() const { return *asset_; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  RigSketch() = default;

  std::vector<std::byte> bytes_;
  kelp::MemorySource memory_{std::span<const std::byte>()};
  std::unique_ptr<kelp::runtime::Asset> asset_;
};

}  // namespace viewer
