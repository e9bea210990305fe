// SPDX-License-Identifier: MIT
#include "rig_sketch.h"

namespace kelp::view {
namespace {

// Tall and thin: a swept part that bends too sharply for such a stick is refused, all others are not.
constexpr glm::ivec3 kStick(1, 256, 1);

RawLevel stick() {
  RawLevel level;
  for (std::uint32_t brick = 0; brick < kStick.y / kBrickSide; ++brick) {
    level.cells.push_back(kCellSolid | brick);
    level.codes.push_back(kSurfaceCode);
    level.codes.resize(level.cells.size() * kBrickVoxels);
    level.attributes.push_back(0);
  }
  return level;
}

}  // namespace

Result<std::unique_ptr<RigSketch>> RigSketch::make(const PackRig& rig) {
  RawPack pack;
  pack.info_json = "{}";
  pack.palette.emplace_back();
  for (const RawRig& rest : rig.parts) {
    RawPart& part = pack.parts.emplace_back();
    part.size = kStick;
    part.knots = rest.knots;
    part.automatic_tangents = rest.automatic_tangents;
    part.parent_at = rest.parent_at;
    part.bend = rest.bend;
    part.roll = rest.roll;
    if (rest.parent_at != Part::kNotOnSpline && pack.parts.size() > 1) part.parent = 0;  // whichever it is
    part.levels.push_back(stick());
  }
  pack.clips = rig.clips;
  pack.sockets = rig.sockets;

  std::unique_ptr<RigSketch> sketch(new RigSketch);
  const Sink sink = Sink::into(sketch->bytes_);
  if (const auto written = writePack(pack, sink); !written) return written.error();
  sketch->memory_ = MemorySource(sketch->bytes_);
  runtime::AssetOptions options;
  options.limits.max_parts = static_cast<std::uint32_t>(rig.parts.size());
  auto asset = runtime::Asset::open(sketch->memory_.source(), options);
  if (!asset) return asset.error();
  sketch->asset_ = *std::move(asset);
  return sketch;
}

}  // namespace kelp::view
