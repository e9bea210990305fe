// SPDX-License-Identifier: MIT
// One level of one part in memory, with access voxel by voxel. Voxels outside the level's size are never
// reported, whatever the bricks hold.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/common/dense_index.h"
#include "kelp/formats/fog.h"
#include "kelp/formats/raw_pack.h"
#include "pack/pack_file.h"

namespace kelp::dump {

class LevelVoxels {
 public:
  static constexpr int kEmpty = -1;  // in rows

  // Reads all of a level. ToolError; kRuntime if it is larger than this machine's memory.
  LevelVoxels(PackFile& file, std::uint32_t part, int level);

  bool fog() const { return kind_ == PartKind::kFog; }
  const glm::ivec3& size() const { return size_; }  // voxels; of fog: samples
  const glm::ivec3& grid() const { return grid_; }  // bricks
  std::uint64_t bricks() const { return brick_of_slot_.size(); }
  // Maps this level's voxels to the object, in meters. edge(): of a cube as large as a voxel.
  const glm::dmat4x3& toObject() const { return to_object_; }
  double edge() const;

  // Of solid parts.
  bool solid(const glm::ivec3& voxel) const { return isSolidCode(code(voxel)); }
  // The attribute of a surface voxel, nothing for others.
  std::optional<std::uint32_t> attribute(const glm::ivec3& voxel) const;
  // The palette index of each voxel of a row along x, or kEmpty. Inner voxels have no color: they get that
  // of the surface voxel before them. `row` begins at x = `from` and ends within the level.
  void paletteRow(int y, int z, int from, std::span<std::int16_t> row) const;
  // True if a brick with any of the voxels from..beyond-1 of a row is solid, in part or whole.
  bool anyBrick(int from, int beyond, int y, int z) const;
  std::uint64_t surfaceVoxels() const { return raw_.attributes.size(); }
  // Calls f(voxel, attribute) for every surface voxel, brick by brick in the file's order.
  template <class F>
  void eachSurface(F&& f) const {
    std::size_t next = 0;
    for (std::size_t slot = 0; slot < brick_of_slot_.size(); ++slot)
      for (int i = 0; i < kBrickVoxels; ++i) {
        if (!isSurfaceCode(raw_.codes[slot * kBrickVoxels + static_cast<std::size_t>(i)])) continue;
        const std::uint32_t attribute = raw_.attributes[next++];
        if (const glm::ivec3 voxel = voxelOf(slot, i); contains(voxel)) f(voxel, attribute);
      }
  }
  // Calls f(voxel) for every solid voxel.
  template <class F>
  void eachSolid(F&& f) const {
    for (const glm::ivec3& brick : inside_)
      for (int i = 0; i < kBrickVoxels; ++i) f(brick * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6));
    for (std::size_t slot = 0; slot < brick_of_slot_.size(); ++slot)
      for (int i = 0; i < kBrickVoxels; ++i) {
        if (!isSolidCode(raw_.codes[slot * kBrickVoxels + static_cast<std::size_t>(i)])) continue;
        if (const glm::ivec3 voxel = voxelOf(slot, i); contains(voxel)) f(voxel);
      }
  }
  const std::vector<glm::ivec3>& storedBricks() const { return brick_of_slot_; }  // by slot
  const std::vector<glm::ivec3>& insideBricks() const { return inside_; }         // kCellInside

  // Of fog.
  float extinction() const { return extinction_; }
  bool hot() const { return !raw_.heat.empty(); }
  // Calls f(sample, density code, heat code) for every sample that is not clear. Samples that bricks share
  // come once from each.
  template <class F>
  void eachSample(F&& f) const {
    for (std::size_t slot = 0; slot < brick_of_slot_.size(); ++slot)
      for (int i = 0; i < kFogSamples; ++i) {
        const std::size_t at = slot * kFogSamples + static_cast<std::size_t>(i);
        const std::uint8_t density = raw_.density[at], heat = hot() ? raw_.heat[at] : std::uint8_t{0};
        const glm::ivec3 sample =
            brick_of_slot_[slot] * kBrickSide +
            glm::ivec3(i % kFogSide, i / kFogSide % kFogSide, i / (kFogSide * kFogSide));
        if ((density | heat) != 0 && contains(sample)) f(sample, density, heat);
      }
  }

 private:
  bool contains(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_.x && v.y < size_.y && v.z < size_.z;
  }
  glm::ivec3 voxelOf(std::size_t slot, int i) const {
    return brick_of_slot_[slot] * kBrickSide + glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
  }
  std::uint32_t cellOf(const glm::ivec3& voxel) const {
    return raw_.cells[denseIndex(grid_, voxel / kBrickSide)];
  }
  std::uint8_t code(const glm::ivec3& voxel) const {
    if (!contains(voxel)) return 0;
    const std::uint32_t cell = cellOf(voxel);
    if (cell == kCellInside) return kInnerCode;
    return cell & kCellSolid ? raw_.codes[std::size_t{cell & kCellSlotMask} * kBrickVoxels +
                                          static_cast<std::size_t>(codeIndex(voxel))]
                             : std::uint8_t{0};
  }
  std::uint32_t attributeOf(std::uint32_t slot, int index, std::uint8_t surface_code) const {
    return raw_.attributes[slice_base_[std::size_t{slot} * 8 + static_cast<std::size_t>(index >> 6)] +
                           surface_code - kSurfaceCode];
  }

  PartKind kind_ = PartKind::kSolid;
  glm::ivec3 size_{0}, grid_{0};
  glm::dmat4x3 to_object_{1};
  float extinction_ = 0;
  RawLevel raw_;
  std::vector<glm::ivec3> brick_of_slot_, inside_;
  std::vector<std::uint32_t> slice_base_;  // 8 a slot
};

}  // namespace kelp::dump
