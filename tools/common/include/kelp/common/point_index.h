// SPDX-License-Identifier: MIT
// Numbers of points in a list, found by their coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace kelp {

// A hash table with open addressing that holds nothing but numbers. Its hash has a random key for each
// process, so that no file can be made whose points all collide; the numbers do not depend on it. Coordinates
// are compared by their bits: -0 is not 0. Up to 2^31 points.
template <class Point>
class PointIndex {
 public:
  // The point's number in `points`, where it is appended if it is new. Give the same list each time.
  std::uint32_t of(const Point& point, std::vector<Point>& points) {
    if (2 * points.size() >= slots_.size()) grow(points);
    std::uint32_t& slot = find(point, points);
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(points.size());
      points.push_back(point);
    }
    return slot;
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;

  static std::uint64_t bitsOf(float value) { return glm::floatBitsToUint(value); }
  static std::uint64_t bitsOf(std::int64_t value) { return static_cast<std::uint64_t>(value); }

  static std::uint64_t hash(const Point& point) {
    static const std::uint64_t kKey = std::uint64_t{std::random_device()()} << 32 | std::random_device()();
    std::uint64_t hash = kKey;
    for (int axis = 0; axis < 3; ++axis) {
      hash = (hash ^ bitsOf(point[axis])) * 0xff51afd7ed558ccdu;
      hash ^= hash >> 32;
    }
    return hash;
  }
  static bool same(const Point& a, const Point& b) {
    return bitsOf(a.x) == bitsOf(b.x) && bitsOf(a.y) == bitsOf(b.y) && bitsOf(a.z) == bitsOf(b.z);
  }

  // The slot that holds the point, or the free one where it belongs.
  std::uint32_t& find(const Point& point, const std::vector<Point>& points) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash(point) & mask;
    while (slots_[at] != kFree && !same(points[slots_[at]], point)) at = (at + 1) & mask;
    return slots_[at];
  }
  void grow(const std::vector<Point>& points) {
    slots_.assign(slots_.empty() ? 1024 : 2 * slots_.size(), kFree);
    for (std::uint32_t i = 0; i < points.size(); ++i) find(points[i], points) = i;
  }

  std::vector<std::uint32_t> slots_;  // a power of two; at least half are free
};

}  // namespace kelp
