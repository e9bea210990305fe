// SPDX-License-Identifier: MIT
#include "rest_distance.h"
#include "kelp/formats/distance.h"
#include "kelp/runtime/level.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "asset_impl.h"

namespace kelp::runtime {
namespace {

constexpr std::size_t kMostSquared = 226;  // beyond the widest band

// [n]: from the center of a voxel to the nearest cube of voxels whose centers are at least sqrt(n) away: the
// least of sqrt(sum of max(|v_i| - 1/2, 0)^2) over whole vectors v with |v|^2 >= n.
constexpr double rootOf(double square) {
  double root = square + 1e-9;
  for (int i = 0; i < 60; ++i) root = 0.5 * (root + square / root);
  return root;
}
constexpr std::array<float, kMostSquared + 1> makeToCube() {
  std::array<int, kMostSquared + 1> least{};  // 4 times the square
  least.fill(1 << 20);
  for (int z = 0; z <= 16; ++z)
    for (int y = 0; y <= z; ++y)
      for (int x = 0; x <= y; ++x) {
        int four = 0;
        for (const int i : {x, y, z}) four += i > 0 ? (2 * i - 1) * (2 * i - 1) : 0;
        int& at = least[std::min<std::size_t>(static_cast<std::size_t>(x * x + y * y + z * z), kMostSquared)];
        at = std::min(at, four);
      }
  for (std::size_t n = kMostSquared; n-- > 0;) least[n] = std::min(least[n], least[n + 1]);
  std::array<float, kMostSquared + 1> table{};
  for (std::size_t n = 0; n <= kMostSquared; ++n)
    table[n] = static_cast<float>(rootOf(0.25 * least[n]) * (1 - 1e-7));
  table[0] = 0;
  return table;
}
constexpr std::array<float, kMostSquared + 1> kToCube = makeToCube();

// [n]: sqrt(n) - 1/2.
constexpr std::array<float, kMostSquared + 1> makeToSurface() {
  std::array<float, kMostSquared + 1> table{};
  for (std::size_t n = 0; n <= kMostSquared; ++n)
    table[n] = static_cast<float>(rootOf(static_cast<double>(n)) - 0.5);
  return table;
}
constexpr std::array<float, kMostSquared + 1> kToSurface = makeToSurface();

// The least squared distance that a code leaves possible.
std::size_t leastSquared(std::uint8_t code, DistanceBand band) {
  const int squared = squaredOf(code);
  return static_cast<std::size_t>(squared > 0 ? squared : 1 + (isInside(code) ? band.inside : band.outside));
}

// From the codes of the voxels around a point, in voxels of their level.
struct Around {
  float outside = 0, inside = 0;  // how far the nearest solid, empty cube is at least
  glm::vec3 gradient{0};
};
Around lookAround(const Level& level, const glm::vec3& point) {
  const glm::ivec3 low(glm::floor(point - 0.5f)), last = level.size - 1;
  const glm::vec3 share = point - 0.5f - glm::vec3(low);
  Around around;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 corner(i & 1, i >> 1 & 1, i >> 2);
    const glm::ivec3 voxel = low + corner, held = glm::clamp(voxel, glm::ivec3(0), last);
    const std::uint8_t code = distanceCode(level, held);
    const std::size_t squared = leastSquared(code, level.band);
    const bool solid = isInside(code);
    if (voxel == held) {
      const glm::vec3 off = glm::vec3(corner) - share;
      const float reach = kToCube[squared] - std::sqrt(glm::dot(off, off));
      float& best = solid ? around.inside : around.outside;
      best = std::max(best, reach);
    }
    // The gradient of the linear interpolation between the eight.
    const float distance = solid ? -kToSurface[squared] : kToSurface[squared];
    const glm::vec3 near = glm::mix(1.0f - share, share, glm::vec3(corner));
    around.gradient += distance * (2.0f * glm::vec3(corner) - 1.0f) *
                       glm::vec3(near.y * near.z, near.x * near.z, near.x * near.y);
  }
  return around;
}

}  // namespace

std::optional<RestDistance> restDistance(const Asset& asset, int part, const glm::dvec3& point) {
  RestDistance found;
  const int levels = DistanceReader::levels(asset, part);
  const Level* last = nullptr;
  float scale = 1;
  int last_level = 0;
  bool known = false;
  for (int l = 0; l < levels; ++l) {
    const Level* level = DistanceReader::level(asset, part, l);
    if (!level) continue;
    last = level;
    last_level = l;
    scale = 1.0f / static_cast<float>(1 << l);
    const glm::dvec3 exact = point * double{scale};  // a point on a face must not change sides
    const glm::vec3 at(exact);
    const glm::ivec3 voxel = glm::clamp(glm::ivec3(exact), glm::ivec3(0), level->size - 1);
    const std::uint8_t code = distanceCode(*level, voxel);
    if (l == 0 || !known) found.inside = l == 0 && isInside(code);
    known = true;
    if (code != kFarOutside) break;
    // Beyond the band: a coarser level knows more.
    const glm::vec3 off = at - 0.5f - glm::vec3(voxel);
    const float reach = kToCube[leastSquared(code, level->band)] - std::sqrt(glm::dot(off, off));
    found.bound = std::max(found.bound, double{reach / scale});
  }
  if (!last) return std::nullopt;
  const Around around = lookAround(*last, glm::vec3(point * double{scale}));
  // Rounding to float: of the point, and of what follows from it.
  const double slack = 1e-6 * (1.0 + static_cast<double>(last->size.x + last->size.y + last->size.z));
  found.bound = std::max(found.bound, double{around.outside / scale}) - slack / double{scale};
  found.bound = found.inside ? 0.0 : std::max(found.bound, 0.0);
  found.depth = found.inside ? std::max(double{around.inside} - slack, 0.0) : 0.0;
  found.gradient = around.gradient;
  found.level = last_level;
  return found;
}

}  // namespace kelp::runtime
