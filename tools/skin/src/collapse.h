// SPDX-License-Identifier: MIT
// The least-squares rigid motions of sets of samples, with a scale where joints scale, and what following
// them costs each sample, in the mean over all moments. Both come from sums of 4x4 matrices, so that the cost
// of a sample does not depend on how many moments there are (README.md has the formulas).
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "moments.h"
#include "samples.h"

namespace kelp::bake {

// Joints that move less of a part than this share of it do not scale it.
inline constexpr double kScaledShare = 0.05;

// The motions of a part, which follow its samples.
class PartMotion {
 public:
  // Fits to `members`. They pull weakly towards the rotation of `joint`, which decides for parts that are
  // flat or small. A part has a scale at moments at which joints with kScaledShare of it have one.
  PartMotion(const SkinSamples& samples, const SkinMoments& moments,
             const std::vector<std::uint32_t>& members, std::uint32_t joint);

  const std::vector<glm::dmat4x3>& motions() const { return motions_; }

  // Makes cost() ready for samples that this joint moves. Not on several threads at once.
  void prepare(std::uint32_t joint, const SkinMoments& moments);
  void prepareFor(std::size_t sample, const SkinSamples& samples, const SkinMoments& moments) {
    for (std::size_t k = samples.first_weighted[sample]; k < samples.first_weighted[sample + 1]; ++k)
      prepare(samples.weighted[k].joint, moments);
  }

  // The mean, over the moments, of the squared distance between where the motion puts the sample and where it
  // is drawn, less a number that depends on the sample alone (constantCost). All its joints must be prepared.
  double cost(std::size_t sample, const SkinSamples& samples) const;

 private:
  std::vector<glm::dmat4x3> motions_;  // one a moment
  glm::dmat4 own_{0};                  // the mean of M^T M
  std::vector<glm::dmat4> cross_;      // of prepared joints: the mean of M^T S
  std::vector<std::int32_t> slots_;    // of each joint: its place in cross_, or -1
};

// The constant that cost() leaves out of each sample: the mean squared distance of its drawn places from the
// origin.
std::vector<double> constantCosts(const SkinSamples& samples, const SkinMoments& moments, int threads);

// One fit, at moments that need not be those of the others.
std::vector<glm::dmat4x3> fitMotions(const SkinSamples& samples, const SkinMoments& moments,
                                     const std::vector<std::uint32_t>& members, std::uint32_t joint);

}  // namespace kelp::bake
