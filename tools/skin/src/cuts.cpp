// SPDX-License-Identifier: MIT
// Where parts are cut in two, and how far they are from what they follow.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kelp/common/parallel.h"
#include "partition.h"

namespace kelp::bake {
namespace {

constexpr double kLeastHalf = 40;     // square units
constexpr double kWellFitted = 1e-4;  // of the mean square error of the whole surface: is not cut
constexpr int kRounds = 6;

// The axes of a set of points, by the power method on what is left: where it is longest first.
std::array<glm::dvec3, 3> axesOf(const SkinSamples& samples, const std::vector<std::uint32_t>& members) {
  glm::dvec3 middle(0);
  double area = 0;
  for (const std::uint32_t i : members) {
    middle += samples.areas[i] * samples.positions[i];
    area += samples.areas[i];
  }
  middle /= area;
  glm::dmat3 spread(0);
  for (const std::uint32_t i : members) {
    const glm::dvec3 from = samples.positions[i] - middle;
    spread += samples.areas[i] * glm::outerProduct(from, from);
  }
  glm::dvec3 first(1, 0.5, 0.25);
  for (int k = 0; k < 64; ++k) first = glm::normalize(spread * first + 1e-12 * first);
  // The longest of those at right angles to it.
  glm::dvec3 second = glm::cross(first, std::abs(first.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
  for (int k = 0; k < 64; ++k) {
    const glm::dvec3 next = spread * second + 1e-12 * second;
    second = glm::normalize(next - glm::dot(next, first) * first);
  }
  return {first, second, glm::cross(first, second)};
}

// Numbers along which a part may be cut: places along its axes, and the weights of the joints that differ
// most within it.
std::vector<std::vector<double>> cutDirections(const SkinSamples& samples,
                                               const std::vector<std::uint32_t>& members,
                                               std::size_t joints) {
  std::vector<std::vector<double>> directions;
  for (const glm::dvec3& axis : axesOf(samples, members)) {
    std::vector<double>& along = directions.emplace_back();
    for (const std::uint32_t i : members) along.push_back(glm::dot(axis, samples.positions[i]));
  }
  std::vector<double> sum(joints, 0), squares(joints, 0);
  std::vector<std::uint32_t> used;
  double area = 0;
  for (const std::uint32_t i : members) {
    area += samples.areas[i];
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k) {
      const SkinSamples::Weighted& w = samples.weighted[k];
      if (sum[w.joint] == 0) used.push_back(w.joint);
      sum[w.joint] += samples.areas[i] * w.x.w;
      squares[w.joint] += samples.areas[i] * w.x.w * w.x.w;
    }
  }
  std::vector<std::pair<double, std::uint32_t>> varying;
  for (const std::uint32_t joint : used)
    varying.emplace_back(-(squares[joint] - sum[joint] * sum[joint] / area), joint);
  std::sort(varying.begin(), varying.end());
  for (std::size_t k = 0; k < std::min<std::size_t>(3, varying.size()); ++k) {
    std::vector<double>& along = directions.emplace_back();
    for (const std::uint32_t i : members) along.push_back(samples.weight(i, varying[k].second));
  }
  return directions;
}

}  // namespace

Partition::Cut Partition::findCut(std::size_t part) const {
  const std::vector<std::uint32_t>& members = parts_[part].members;
  PartMotion whole = *parts_[part].motion;
  double area = 0, before = 0;
  std::vector<double> areas;
  for (const std::uint32_t i : members) {
    whole.prepareFor(i, samples_, moments_);
    areas.push_back(samples_.areas[i]);
    area += areas.back();
    before += areas.back() * (whole.cost(i, samples_) + constants_[i]);
  }
  Cut best;
  if (area < 2 * kLeastHalf || before < kWellFitted * samples_.area) return best;
  const std::uint32_t joint = labels_.joints[part];
  for (const std::vector<double>& along : cutDirections(samples_, members, moments_.joints)) {
    const double middle = weightedQuantile(along, areas, 0.5);
    std::vector<bool> upper(members.size());
    for (std::size_t k = 0; k < members.size(); ++k) upper[k] = along[k] > middle;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<std::uint32_t> halves[2];
      double half_areas[2] = {0, 0};
      for (std::size_t k = 0; k < members.size(); ++k) {
        halves[upper[k]].push_back(members[k]);
        half_areas[upper[k]] += areas[k];
      }
      if (half_areas[0] < kLeastHalf || half_areas[1] < kLeastHalf) break;
      PartMotion low(samples_, moments_, halves[0], joint), high(samples_, moments_, halves[1], joint);
      double after = 0;
      std::vector<bool> next(members.size());
      for (std::size_t k = 0; k < members.size(); ++k) {
        low.prepareFor(members[k], samples_, moments_);
        high.prepareFor(members[k], samples_, moments_);
        const double of_low = low.cost(members[k], samples_), of_high = high.cost(members[k], samples_);
        after += areas[k] * ((upper[k] ? of_high : of_low) + constants_[members[k]]);
        next[k] = of_high < of_low;
      }
      if (before - after > best.gain) best = {before - after, halves[1]};
      if (next == upper) break;
      upper = std::move(next);
    }
  }
  return best;
}

void Partition::findCuts() {
  fit();
  parallelRanges(parts_.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      PartState& part = parts_[p];
      if (part.cut_for == part.members) continue;
      part.cut = findCut(p);
      part.cut_for = part.members;
    }
  });
}

Partition::Distances Partition::worstClip() {
  fit();
  Distances worst;
  for (std::size_t begin = 0, end = 0; begin < moments_.size(); begin = end) {
    while (end < moments_.size() && moments_.clips[end] == moments_.clips[begin]) ++end;
    std::vector<double> distances, areas;
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const glm::dvec4 x(samples_.positions[i], 1);
      for (std::size_t t = begin; t < end; ++t) {
        const double distance = glm::distance(parts_[labels_.parts[i]].motion->motions()[t] * x,
                                              skinnedPoint(samples_, i, moments_, t));
        distances.push_back(distance);
        areas.push_back(samples_.areas[i]);
        sum += samples_.areas[i] * distance;
        area += samples_.areas[i];
      }
    }
    worst.mean = std::max(worst.mean, sum / area);
    worst.p95 = std::max(worst.p95, weightedQuantile(distances, areas, 0.95));
  }
  return worst;
}

}  // namespace kelp::bake
