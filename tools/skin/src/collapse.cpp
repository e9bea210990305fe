// SPDX-License-Identifier: MIT
#include "collapse.h"

#include <algorithm>

#include "kelp/common/parallel.h"
#include "rigid.h"

namespace kelp::bake {
namespace {

// How strongly a part turns with its joint: a share of its spread, and of a spread of its area.
constexpr double kPullOfSpread = 1e-3, kPullOfArea = 0.05;

// Transposed product of 4x3 matrices: a^T b.
glm::dmat4 gram(const glm::dmat4x3& a, const glm::dmat4x3& b) {
  glm::dmat4 out(0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out[column][row] = glm::dot(a[row], b[column]);
  return out;
}

}  // namespace

std::vector<glm::dmat4x3> fitMotions(const SkinSamples& samples, const SkinMoments& moments,
                                     const std::vector<std::uint32_t>& members, std::uint32_t joint) {
  // Sums over the members: area times X x^T for each joint, with x = (position, 1), and of x x^T itself.
  std::vector<std::uint32_t> joints;
  std::vector<glm::dmat4> sums;
  std::vector<std::int32_t> slots(moments.joints, -1);
  glm::dmat4 own(0);
  for (const std::uint32_t i : members) {
    const glm::dvec4 x(samples.positions[i], 1), ax = samples.areas[i] * x;
    own += glm::outerProduct(x, ax);
    for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k) {
      std::int32_t& slot = slots[samples.weighted[k].joint];
      if (slot < 0) {
        slot = static_cast<std::int32_t>(joints.size());
        joints.push_back(samples.weighted[k].joint);
        sums.emplace_back(0);
      }
      sums[static_cast<std::size_t>(slot)] += glm::outerProduct(samples.weighted[k].x, ax);
    }
  }
  std::vector<glm::dmat4x3> motions;
  motions.reserve(moments.size());
  const double area = own[3][3];
  if (!(area > 0)) {
    for (std::size_t t = 0; t < moments.size(); ++t)
      motions.push_back(rigid(moments.rotation(t, joint), moments.motion(t, joint)[3]));
    return motions;
  }
  const glm::dvec3 middle = glm::dvec3(own[3]) / area;
  const double spread = own[0][0] + own[1][1] + own[2][2] - area * glm::dot(middle, middle);
  for (std::size_t t = 0; t < moments.size(); ++t) {
    glm::dmat4x3 drawn(0);  // the sum of area times y x^T, of drawn places y
    for (std::size_t j = 0; j < joints.size(); ++j) drawn += moments.motion(t, joints[j]) * sums[j];
    const glm::dvec3 drawn_middle = drawn[3] / area;
    const glm::dmat3 fit = linearOf(drawn) - area * glm::outerProduct(drawn_middle, middle);
    const glm::dmat3 h = fit + (kPullOfSpread * spread + kPullOfArea * area) * moments.rotation(t, joint);
    glm::dmat3 turn = nearestRotation(h);
    double scaled = 0;
    for (std::size_t j = 0; j < joints.size(); ++j)
      if (moments.scaling[joints[j]] && !keepsSize(moments.motion(t, joints[j]))) scaled += sums[j][3][3];
    if (scaled >= kScaledShare * area && spread > 0) {
      // The scale that is best with this turn (Umeyama 1991).
      double along = 0;
      for (int column = 0; column < 3; ++column) along += glm::dot(turn[column], fit[column]);
      turn *= std::max(0.0, along / spread);
    }
    motions.push_back(rigid(turn, drawn_middle - turn * middle));
  }
  return motions;
}

PartMotion::PartMotion(const SkinSamples& samples, const SkinMoments& moments,
                       const std::vector<std::uint32_t>& members, std::uint32_t joint)
    : motions_(fitMotions(samples, moments, members, joint)), slots_(moments.joints, -1) {
  for (const glm::dmat4x3& m : motions_) own_ += gram(m, m);
  own_ /= static_cast<double>(motions_.size());
}

void PartMotion::prepare(std::uint32_t joint, const SkinMoments& moments) {
  if (slots_[joint] >= 0) return;
  slots_[joint] = static_cast<std::int32_t>(cross_.size());
  glm::dmat4& cross = cross_.emplace_back(0);
  for (std::size_t t = 0; t < motions_.size(); ++t) cross += gram(motions_[t], moments.motion(t, joint));
  cross /= static_cast<double>(motions_.size());
}

double PartMotion::cost(std::size_t sample, const SkinSamples& samples) const {
  const glm::dvec4 x(samples.positions[sample], 1);
  glm::dvec4 sum = own_ * x;
  for (std::size_t k = samples.first_weighted[sample]; k < samples.first_weighted[sample + 1]; ++k)
    sum -=
        2.0 * (cross_[static_cast<std::size_t>(slots_[samples.weighted[k].joint])] * samples.weighted[k].x);
  return glm::dot(x, sum);
}

std::vector<double> constantCosts(const SkinSamples& samples, const SkinMoments& moments, int threads) {
  std::vector<double> costs(samples.size(), 0);
  parallelRanges(samples.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t t = 0; t < moments.size(); ++t) {
        const glm::dvec3 at = skinnedPoint(samples, i, moments, t);
        costs[i] += glm::dot(at, at);
      }
      costs[i] /= static_cast<double>(moments.size());
    }
  });
  return costs;
}

}  // namespace kelp::bake
