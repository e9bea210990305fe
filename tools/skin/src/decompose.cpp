// SPDX-License-Identifier: MIT
#include "decompose.h"

#include <algorithm>
#include <utility>

#include "partition.h"

namespace kelp::bake {
namespace {

constexpr int kFirstRounds = 8, kRoundsOfCut = 4;
constexpr double kLeastGain = 0.02;               // of a cut, in the mean square error of the whole surface
constexpr double kMeanGoal = 0.8, kGoal95 = 2.5;  // units: cuts that gain less are made until these are met
constexpr std::size_t kMostParts = 256;           // by cuts
constexpr std::size_t kMostSeeds = 1024;
constexpr int kMostFailures = 3;

// The joint that moves each sample most. Of very many, those of the largest surfaces; the others' samples go
// to the joint before.
SkinLabels seeds(const SkinSamples& samples, std::size_t joints) {
  std::vector<std::uint32_t> heaviest(samples.size());
  std::vector<double> areas(joints, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    heaviest[i] = samples.heaviestJoint(i);
    areas[heaviest[i]] += samples.areas[i];
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t joint = 0; joint < joints; ++joint)
    if (areas[joint] > 0) kept.push_back(joint);
  if (kept.size() > kMostSeeds) {
    std::stable_sort(kept.begin(), kept.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return areas[a] > areas[b]; });
    kept.resize(kMostSeeds);
    std::sort(kept.begin(), kept.end());
  }
  SkinLabels labels;
  labels.joints = kept;
  for (const std::uint32_t joint : heaviest) {
    const auto after = std::upper_bound(kept.begin(), kept.end(), joint);
    labels.parts.push_back(static_cast<std::uint32_t>(after == kept.begin() ? 0 : after - kept.begin() - 1));
  }
  return labels;
}

// A part is that of the joint which moves most of it: Lloyd's iteration may have moved it.
SkinLabels ofHeaviestJoints(SkinLabels labels, const SkinSamples& samples, std::size_t joints) {
  const std::vector<std::vector<std::uint32_t>> members = labels.members();
  for (std::size_t p = 0; p < members.size(); ++p) {
    std::vector<double> weights(joints, 0);
    for (const std::uint32_t i : members[p])
      for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k)
        weights[samples.weighted[k].joint] += samples.areas[i] * samples.weighted[k].x.w;
    labels.joints[p] =
        static_cast<std::uint32_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  }
  labels.chains.resize(labels.joints.size());
  return labels;
}

}  // namespace

SkinLabels decompose(const SkinSamples& samples, const SkinMoments& moments, int threads,
                     const std::function<void(double)>& step) {
  SkinLabels first = seeds(samples, moments.joints);
  first.chains.resize(first.joints.size());
  if (moments.size() == 0) return first;
  const std::size_t most = std::max(first.joints.size(), std::min(2 * first.joints.size(), kMostParts));
  Partition partition(samples, moments, std::move(first), threads);
  partition.improve(kFirstRounds);
  partition.merge();
  for (int failures = 0; partition.parts() < most && failures <= kMostFailures;) {
    step(static_cast<double>(partition.parts()) / static_cast<double>(most));
    partition.findCuts();
    std::size_t best = 0;
    for (std::size_t p = 1; p < partition.parts(); ++p)
      if (partition.cutOf(p).gain > partition.cutOf(best).gain) best = p;
    const double gain = partition.cutOf(best).gain / samples.area;
    if (!(gain > 0)) break;
    if (gain < kLeastGain) {
      const Partition::Distances worst = partition.worstClip();
      if (worst.mean <= kMeanGoal && worst.p95 <= kGoal95) break;
    }
    const std::size_t before = partition.parts();
    partition.split(best, std::vector<std::uint32_t>(partition.cutOf(best).half));
    partition.improve(kRoundsOfCut);
    if (partition.parts() <= before) ++failures;
  }
  return ofHeaviestJoints(partition.labels(), samples, moments.joints);
}

}  // namespace kelp::bake
