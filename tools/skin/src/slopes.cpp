// SPDX-License-Identifier: MIT
#include "slopes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

// A step along the normal should go out of the posed surface by so much of its length, and must by more than
// nothing.
constexpr double kOut = 0.6;
constexpr double kSteepest = 0.1;
constexpr int kRounds = 30;

class SlopeFinder {
 public:
  SlopeFinder(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
              const SkinSamples& samples, std::span<const std::vector<SkinMoment>> moments)
      : soup_(soup), skin_(skin), frame_(frame), samples_(samples), moments_(moments) {}

  // Of a sample; `slopes` are 0.
  void find(std::size_t sample, std::span<double> slopes) {
    findEdges(sample);
    if (rows(sample)) return;
    const std::size_t joints = slopes.size();
    for (int round = 0; round < kRounds; ++round) {
      bool changed = false;
      for (std::size_t m = 0; m < outs_.size(); ++m) {
        const std::span<const double> effects(effects_.data() + m * joints, joints);
        double square = 0;
        for (const double effect : effects) square += effect * effect;
        const double lacks = kOut - outOf(m, slopes);
        if (!(lacks > 0) || !(square > 0)) continue;
        for (std::size_t k = 0; k < joints; ++k) slopes[k] += lacks * effects[k] / square;
        changed = true;
      }
      if (!changed) break;
    }
    bool good = true;
    for (std::size_t m = 0; m < outs_.size(); ++m) good &= outOf(m, slopes) > 0;
    for (const double slope : slopes) good &= std::abs(slope) <= kSteepest;
    if (!good) std::fill(slopes.begin(), slopes.end(), 0.0);
  }

 private:
  // Two edges of the sample's triangle, and by how much its weights grow along them.
  void findEdges(std::size_t sample) {
    const std::uint32_t triangle = samples_.triangles[sample];
    std::array<glm::dvec3, 3> corners;
    std::array<std::vector<SkinSamples::Weighted>, 3> at;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = soup_.triangles[triangle].vertex[c];
      corners[c] = frame_.node_to_voxel * glm::dvec4(glm::dvec3(soup_.positions[vertex]), 1);
      addWeights(skin_, soup_.skinned[triangle][c], 1, at[c]);
    }
    const auto weightAt = [&](std::size_t c, std::uint32_t joint) {
      for (const SkinSamples::Weighted& one : at[c])
        if (one.joint == joint) return one.weight;
      return 0.0;
    };
    for (std::size_t e = 0; e < 2; ++e) {
      edges_[e] = corners[e + 1] - corners[0];
      growth_[e].clear();
      for (const SkinSamples::Weighted& one : samples_.weights(sample))
        growth_[e].push_back(weightAt(e + 1, one.joint) - weightAt(0, one.joint));
    }
  }

  // For each moment: how far what is along the normal goes out of the posed surface, and what slopes of 1
  // would add to that, less their mean: weights sum to 1. True if it is enough at all moments.
  bool rows(std::size_t sample) {
    const std::span<const SkinSamples::Weighted> weights = samples_.weights(sample);
    const glm::dvec3 &at = samples_.positions[sample], &normal = samples_.normals[sample];
    outs_.clear();
    effects_.clear();
    bool enough = true;
    for (const std::vector<SkinMoment>& clip : moments_) {
      for (const SkinMoment& moment : clip) {
        std::array<glm::dvec3, 2> posed{};
        glm::dvec3 blended(0), mean(0);
        places_.clear();
        for (std::size_t k = 0; k < weights.size(); ++k) {
          const glm::dmat4x3& motion = moment.joints[weights[k].joint];
          const glm::dmat3 turn(motion);
          places_.push_back(motion * glm::dvec4(at, 1));
          for (std::size_t e = 0; e < 2; ++e)
            posed[e] += weights[k].weight * (turn * edges_[e]) + growth_[e][k] * places_[k];
          blended += weights[k].weight * (turn * normal);
          mean += places_[k] / static_cast<double>(weights.size());
        }
        const glm::dvec3 across = glm::cross(posed[0], posed[1]);
        const double length = glm::length(across);
        if (!(length > 0) || !std::isfinite(length)) continue;
        outs_.push_back(glm::dot(blended, across) / length);
        enough &= outs_.back() >= kOut;
        for (const glm::dvec3& place : places_) effects_.push_back(glm::dot(place - mean, across) / length);
      }
    }
    return enough;
  }

  double outOf(std::size_t moment, std::span<const double> slopes) const {
    double out = outs_[moment];
    for (std::size_t k = 0; k < slopes.size(); ++k) out += slopes[k] * effects_[moment * slopes.size() + k];
    return out;
  }

  const TriangleSoup& soup_;
  const SourceSkin& skin_;
  const Frame& frame_;
  const SkinSamples& samples_;
  std::span<const std::vector<SkinMoment>> moments_;
  std::array<glm::dvec3, 2> edges_{};
  std::array<std::vector<double>, 2> growth_;
  std::vector<glm::dvec3> places_;
  std::vector<double> outs_, effects_;
};

}  // namespace

std::vector<double> slopesUnder(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame,
                                const SkinSamples& samples, std::span<const std::vector<SkinMoment>> moments,
                                int threads) {
  std::vector<double> slopes(samples.weighted.size(), 0);
  parallelRanges(samples.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
    SlopeFinder finder(soup, skin, frame, samples, moments);
    for (std::size_t s = begin; s < end; ++s)
      finder.find(s, std::span(slopes).subspan(samples.first_weighted[s], samples.weights(s).size()));
  });
  return slopes;
}

}  // namespace kelp::bake
