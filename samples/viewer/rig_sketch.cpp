// SPDX-License-Identifier: MIT
#include "rig_sketch.h"

namespace viewer {
namespace {

kelp::RawLevel oneVoxel() {
  kelp::RawLevel level;
  level.cells = {kelp::kCellSolid};
  level.codes.assign(kelp::kBrickVoxels, 0);
  level.codes[0] = kelp::kSurfaceCode;
  level.attributes = {0};
  return level;
}

}  // namespace

kelp::Result<std::unique_ptr<RigSketch>> RigSketch::make(const PackRig& rig) {
  kelp::RawPack pack;
  pack.info_json = "{}";
  pack.palette.emplace_back();
  for (const std::vector<kelp::Knot>& knots : rig.knots) {
    kelp::RawPart& part = pack.parts.emplace_back();
    part.size = glm::ivec3(1);
    part.knots = knots;
    part.levels.push_back(oneVoxel());
  }
  pack.clips = rig.clips;

  std::unique_ptr<RigSketch> sketch(new RigSketch);
  const kelp::Sink sink{[](void* user, std::span<const std::byte> more) {
                          auto& all = *static_cast<std::vector<std::byte>*>(user);
                          all.insert(all.end(), more.begin(), more.end());
                          return true;
                        },
                        &sketch->bytes_};
  if (const auto written = writePack(pack, sink); !written) return written.error();
  sketch->memory_ = kelp::MemorySource(sketch->bytes_);
  kelp::runtime::Options options;
  options.limits.max_parts = static_cast<std::uint32_t>(rig.knots.size());
  auto asset = kelp::runtime::Asset::open(sketch->memory_.source(), options);
  if (!asset) return asset.error();
  sketch->asset_ = *std::move(asset);
  return sketch;
}

}  // namespace viewer
