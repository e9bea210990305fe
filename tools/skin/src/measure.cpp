// SPDX-License-Identifier: MIT
#include "measure.h"

#include <memory>

#include "keys.h"
#include "quantile.h"

namespace kelp::bake {

SkinFit measureClip(const SkinSamples& samples, const SourceSkin& skin, std::uint32_t clip,
                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree,
                    const std::vector<RigDescription::Clip>& keys) {
  constexpr int kMoments = 12;
  const std::vector<double> times = evenTimes(skin.clips[clip], kMoments);
  const SkinMoments moments = momentsAt(skin, clip, times, space, 1);
  SkinFit fit;
  fit.clip = skin.clips[clip].name;
  std::vector<glm::vec3> straight(samples.size());  // of those in swept parts
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const auto& sweep = tree.sweeps[labels.parts[i]])
      straight[i] = sweep->straightened(sweep->toPart(samples.positions[i]));
  std::vector<double> distances, areas;
  double sum = 0, area = 0;
  for (std::size_t t = 0; t < times.size(); ++t) {
    const std::vector<SkinPose> poses = posesOfKeys(keys, tree, space, times[t]);
    std::vector<std::unique_ptr<PosedSweep>> swept(poses.size());
    for (std::size_t p = 0; p < poses.size(); ++p)
      if (tree.sweeps[p]) swept[p] = std::make_unique<PosedSweep>(*tree.sweeps[p], poses[p]);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::uint32_t part = labels.parts[i];
      const glm::dvec3 at = swept[part] ? swept[part]->at(straight[i])
                                        : poses[part].motion * glm::dvec4(samples.positions[i], 1);
      const double distance = space.voxels * glm::distance(at, skinnedPoint(samples, i, moments, t));
      distances.push_back(distance);
      areas.push_back(samples.areas[i]);
      sum += samples.areas[i] * distance;
      area += samples.areas[i];
      if (fit.joint.empty() || distance > fit.max) {
        fit.max = distance;
        fit.joint = skin.joints[samples.heaviestJoint(i)].name;
      }
    }
  }
  fit.mean = sum / area;
  fit.p95 = weightedQuantile(distances, areas, 0.95);
  return fit;
}

}  // namespace kelp::bake
