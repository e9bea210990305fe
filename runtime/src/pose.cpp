// SPDX-License-Identifier: MIT
#include "kelp/runtime/pose.h"

#include <algorithm>
#include <cmath>

namespace kelp::runtime {

Result<Pose> Pose::create(const Asset& asset, const Allocator& allocator) {
  const std::span<const Part> parts = asset.pack().parts();
  std::size_t total = 0;
  for (const Part& part : parts) total += part.knots.size();
  Pose pose;
  pose.knots_ = Buffer<Knot>(allocator);
  pose.rest_ = Buffer<Knot>(allocator);
  pose.first_knot_ = Buffer<std::uint32_t>(allocator);
  pose.motions_ = Buffer<Motion>(allocator);
  if (!pose.knots_.reset(total) || !pose.rest_.reset(total) || !pose.first_knot_.reset(parts.size() + 1) || !pose.motions_.reset(parts.size())) {
    return Error{ErrorCode::kOutOfMemory, "no memory for a pose"};
  }
  std::size_t n = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pose.first_knot_[i] = static_cast<std::uint32_t>(n);
    for (const Knot& knot : parts[i].knots) pose.rest_[n++] = knot;
  }
  pose.first_knot_[parts.size()] = static_cast<std::uint32_t>(n);
  pose.reset();
  return pose;
}

std::span<Knot> Pose::knots(int part) {
  if (part < 0 || part >= parts()) return {};
  const auto i = static_cast<std::size_t>(part);
  return knots_.span().subspan(first_knot_[i], first_knot_[i + 1] - first_knot_[i]);
}

std::span<const Knot> Pose::knots(int part) const { return const_cast<Pose*>(this)->knots(part); }

void Pose::reset() {
  std::copy(rest_.begin(), rest_.end(), knots_.begin());
  std::fill(motions_.begin(), motions_.end(), Motion{});
}

bool Pose::assign(const Pose& other) {
  if (other.knots_.size() != knots_.size() || other.first_knot_.size() != first_knot_.size()) return false;
  if (!std::equal(first_knot_.begin(), first_knot_.end(), other.first_knot_.begin())) return false;
  std::copy(other.knots_.begin(), other.knots_.end(), knots_.begin());
  std::copy(other.motions_.begin(), other.motions_.end(), motions_.begin());
  return true;
}

Result<void> Pose::check() const {
  for (int part = 0; part < parts(); ++part) {
    const Result<void> sound = checkKnots(knots(part));
    if (!sound) return Error{sound.error().code, sound.error().detail, static_cast<std::uint64_t>(part)};
  }
  return {};
}

void Pose::clampMonotone() {
  for (int part = 0; part < parts(); ++part) {
    const std::span<Knot> k = knots(part);
    if (k.empty() || checkKnots(k)) continue;
    // Knots must rise: at least a thousandth of their share of the height at rest.
    const std::span<const Knot> rest(&rest_[first_knot_[static_cast<std::size_t>(part)]], k.size());
    const float height = rest.back().position.y - rest.front().position.y;
    for (std::size_t i = 1; i < k.size(); ++i) {
      const float least = k[i - 1].position.y + 1e-3f * height * (k[i].at - k[i - 1].at);
      k[i].position.y = std::max(k[i].position.y, least);
    }
    // Fritsch and Carlson 1980: a Hermite cubic of rise d with end slopes m0, m1 >= 0 is monotone if m0^2 + m1^2 <= 9 d^2.
    for (Knot& knot : k) knot.tangent.y = std::max(knot.tangent.y, 0.0f);
    // Shrinking a tangent may spoil the neighbour's segment, if that was monotone outside the circle; a segment inside stays there. So each
    // pass brings one more segment to rest, or is the last.
    bool mended = true;
    while (mended) {
      mended = false;
      for (std::size_t i = 0; i + 1 < k.size(); ++i) {
        const float share = k[i + 1].at - k[i].at;
        const float rise = (k[i + 1].position.y - k[i].position.y) / share;
        const float length = std::sqrt(k[i].tangent.y * k[i].tangent.y + k[i + 1].tangent.y * k[i + 1].tangent.y);
        if (!(length > 3.0f * rise) || isMonotone(makeSegment(k[i], k[i + 1]))) continue;
        k[i].tangent.y *= 2.999f * rise / length;
        k[i + 1].tangent.y *= 2.999f * rise / length;
        mended = true;
      }
    }
  }
}

}  // namespace kelp::runtime
