// SPDX-License-Identifier: MIT
#include "kelp/formats/brick.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "eight_codes.h"

namespace kelp {
namespace {

// An octahedral coordinate is (code - 2047) / 2047, so that 0 and the six axes are exact. Code 4095 reads as
// 4094.
constexpr int kOctahedralHalf = 2047;

// Moves the bits of x to bits 0, 3, 6, ...
std::uint64_t spreadBits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | (x << 32)) & 0x001f00000000ffffu;
  x = (x | (x << 16)) & 0x001f0000ff0000ffu;
  x = (x | (x << 8)) & 0x100f00f00f00f00fu;
  x = (x | (x << 4)) & 0x10c30c30c30c30c3u;
  x = (x | (x << 2)) & 0x1249249249249249u;
  return x;
}

struct Direction {
  double x, y, z;
};

// The unit vector of two octahedral codes, in double precision.
Direction octahedralDirection(int u, int v) {
  double x = static_cast<double>(std::min(u, 2 * kOctahedralHalf) - kOctahedralHalf) / kOctahedralHalf;
  double z = static_cast<double>(std::min(v, 2 * kOctahedralHalf) - kOctahedralHalf) / kOctahedralHalf;
  const double y = 1.0 - std::abs(x) - std::abs(z);
  // The lower half is folded outward over the diagonals.
  const double fold = std::max(-y, 0.0);
  x += x >= 0.0 ? -fold : fold;
  z += z >= 0.0 ? -fold : fold;
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

}  // namespace

glm::ivec3 levelSize(const glm::ivec3& size, int level) {
  const auto shrink = [level](int n) {
    return static_cast<int>(
        std::max<std::int64_t>(1, (std::int64_t{n} + (std::int64_t{1} << level) - 1) >> level));
  };
  return {shrink(size.x), shrink(size.y), shrink(size.z)};
}

glm::ivec3 brickGrid(const glm::ivec3& size) { return levelSize(size, 3); }

std::uint64_t mortonCode(const glm::ivec3& brick) {
  return spreadBits(static_cast<std::uint64_t>(brick.x)) |
         (spreadBits(static_cast<std::uint64_t>(brick.y)) << 1) |
         (spreadBits(static_cast<std::uint64_t>(brick.z)) << 2);
}

std::uint32_t encodeNormal(const glm::vec3& normal, int ones) {
  const double nx = normal.x, ny = normal.y, nz = normal.z;
  const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
  if (!(length > 0.0) || !std::isfinite(length)) return encodeNormal(glm::vec3(0.0f, 1.0f, 0.0f), ones);
  const double sum = std::abs(nx) + std::abs(ny) + std::abs(nz);
  double x = nx / sum, z = nz / sum;
  if (ny < 0.0) {
    const double folded_x = (1.0 - std::abs(z)) * (x >= 0.0 ? 1.0 : -1.0);
    const double folded_z = (1.0 - std::abs(x)) * (z >= 0.0 ? 1.0 : -1.0);
    x = folded_x;
    z = folded_z;
  }
  // The map is not uniform, so rounding does not always give the nearest normal: try the codes around it.
  constexpr int kEnd = 2 * kOctahedralHalf;
  const int u0 = (static_cast<int>(std::floor(x * kOctahedralHalf)) + kOctahedralHalf) >> ones;
  const int v0 = (static_cast<int>(std::floor(z * kOctahedralHalf)) + kOctahedralHalf) >> ones;
  const auto codeOf = [ones](int rounded) { return (rounded + 1) * (1 << ones) - 1; };
  int best_u = 0, best_v = 0;
  double best_distance = 16.0;
  for (int j = v0 - 1; j <= v0 + 2; ++j) {
    for (int i = u0 - 1; i <= u0 + 2; ++i) {
      const int u = codeOf(i), v = codeOf(j), most = ones > 0 ? kEnd + 1 : kEnd;  // kEnd + 1 reads as kEnd
      if (u < 0 || v < 0 || u > most || v > most) continue;
      const Direction d = octahedralDirection(u, v);
      // Compares chords. Cosines near 1 cannot distinguish such small angles.
      const double dx = d.x - nx / length, dy = d.y - ny / length, dz = d.z - nz / length;
      const double distance = dx * dx + dy * dy + dz * dz;
      if (distance < best_distance) {
        best_distance = distance;
        best_u = u;
        best_v = v;
      }
    }
  }
  // On the border of the square, two codes are the same direction: write the greater.
  const auto isBorder = [](int code) { return code == 0 || code >= kEnd; };
  if (isBorder(best_u)) best_v = std::max(best_v, kEnd - best_v);
  if (isBorder(best_v)) best_u = std::max(best_u, kEnd - best_u);
  return static_cast<std::uint32_t>(best_u) | static_cast<std::uint32_t>(best_v) << 12;
}

glm::vec3 decodeNormal(std::uint32_t bits24) {
  const Direction d =
      octahedralDirection(static_cast<int>(bits24 & 0xfffu), static_cast<int>((bits24 >> 12) & 0xfffu));
  return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

Result<std::uint32_t> computeSliceBase(std::span<const std::uint8_t> codes, std::uint32_t first,
                                       std::span<std::uint32_t> slice_base) {
  if (codes.size() % kBrickVoxels != 0 || slice_base.size() < codes.size() / EightCodes::kSlice)
    return Error{ErrorCode::kMisuse, "codes of whole bricks and 8 slices a brick are needed"};
  std::uint64_t wrong = 0;
  std::uint32_t count = 0;
  for (std::size_t slice = 0; slice < codes.size() / EightCodes::kSlice; ++slice) {
    slice_base[slice] = first + count;
    std::uint64_t rank = 0;  // of the slice's next surface voxel
    for (std::size_t i = 0; i < EightCodes::kSlice; i += 8) {
      const EightCodes eight(codes.data() + slice * EightCodes::kSlice + i);
      wrong |= eight.reservedBits() | ((eight.codes ^ eight.ranked(rank)) & eight.surfaceBytes());
      rank += eight.surfaceVoxels();
    }
    count += static_cast<std::uint32_t>(rank);
  }
  if (wrong != 0) return Error{ErrorCode::kCorrupt, "a brick holds a reserved code or a wrong rank"};
  return count;
}

}  // namespace kelp
