// SPDX-License-Identifier: MIT
#include <cmath>

#include "check.h"
#include "kelp/fields/fields.h"

namespace kelp::fields {

std::vector<std::uint32_t> squaredClearance(const Occupancy& occupancy, int threads) {
  const std::vector<std::uint8_t> dilated = dilate26(occupancy, threads);
  std::vector<std::uint32_t> squared(dilated.size());
  squaredDistance(dilated, occupancy.size, squared, threads);
  return squared;
}

std::uint32_t quantizedClearance(std::uint32_t squared, std::uint32_t scale) {
  if (scale > kMaxClearanceScale)
    throw std::invalid_argument("the scale of a clearance is at most " + std::to_string(kMaxClearanceScale));
  // floor(scale sqrt(s)) = floor(sqrt(scale^2 s)), below 2^64. The double is near; integers decide.
  const std::uint64_t square = std::uint64_t{scale} * scale * squared;
  auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(square)));
  if (root > 0xffffffffu) root = 0xffffffffu;
  while (root * root > square) --root;
  while (root < 0xffffffffu && (root + 1) * (root + 1) <= square) ++root;
  return static_cast<std::uint32_t>(root);
}

}  // namespace kelp::fields
