// SPDX-License-Identifier: MIT
// The bytes of one page of a solid level (SPEC.md, 5.3): which voxels are solid and which surface, given the
// next coarser level, then the attributes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "kelp/formats/buffer.h"
#include "kelp/formats/error.h"
#include "kelp/formats/raw_pack.h"

namespace kelp {

// The 4 x 4 x 4 voxels of the next coarser level over a brick: bit x + 4 y + 16 z.
struct CoarseBlock {
  std::uint64_t solid = 0, surface = 0;  // surface voxels are solid too
};

struct PageShape {
  std::span<const glm::ivec3> bricks;  // grid positions in ascending Morton order, 1 to 128 of them
  std::span<const CoarseBlock> above;  // one a brick; empty: the coarsest level of its part
  glm::ivec3 size{0};                  // of the level, in voxels
  std::uint32_t palette = 1;           // entries, 1 to 256
};

// Finds a page's bricks by their places, in a table that is never more than a quarter full.
class BrickPlaces {
 public:
  explicit BrickPlaces(std::span<const glm::ivec3> bricks) : bricks_(bricks) {
    table_.fill(-1);
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      std::size_t at = start(bricks[i]);
      while (table_[at] >= 0) at = (at + 1) % table_.size();
      table_[at] = static_cast<std::int16_t>(i);
    }
  }
  // -1: the page does not hold it.
  int find(const glm::ivec3& brick) const {
    for (std::size_t at = start(brick);; at = (at + 1) % table_.size())
      if (table_[at] < 0 || bricks_[static_cast<std::size_t>(table_[at])] == brick) return table_[at];
  }

 private:
  static std::size_t start(const glm::ivec3& p) {
    return static_cast<std::uint32_t>(p.x + p.y * 8 + p.z * 64) % 512;
  }
  std::span<const glm::ivec3> bricks_;
  std::array<std::int16_t, 512> table_;
};

// Of a page: 512 bytes a brick and 4 a surface voxel are at most 64 KiB.
inline constexpr std::size_t kMaxPageAttributes = 64 * 1024 / 4;

// codes: 512 a brick: 0 (empty), 64 (surface) or 128 (inner). attributes: one a surface voxel, brick by brick
// in the order of codes. kMisuse: sizes, or codes that break a rule of SPEC.md, 5.1, that the format uses: a
// brick without a surface voxel, a solid voxel beyond the level, a voxel that the coarser level excludes.
Result<void> encodeSolidPage(const PageShape& shape, std::span<const std::uint8_t> codes,
                             std::span<const std::uint32_t> attributes, Effort effort,
                             Buffer<std::byte>& workspace, Buffer<std::byte>& out);

// The inverse. Safe for any bytes and any `above`. shapes: one a brick. attributes: as many as the page must
// hold. kCorrupt: it holds another number, an index beyond the palette, a brick without a surface voxel, or
// other bytes than its voxels take. Allocates nothing once `workspace` was used.
Result<void> decodeSolidPage(const PageShape& shape, std::span<const std::byte> stored,
                             Buffer<std::byte>& workspace, std::span<BrickShape> shapes,
                             std::span<std::uint32_t> attributes);

}  // namespace kelp
