// SPDX-License-Identifier: MIT
#include "measure.h"

#include <algorithm>
#include <memory>

#include "keys.h"
#include "quantile.h"

namespace kelp::bake {

std::vector<glm::vec3> straightPlaces(const SkinSamples& samples, const SkinLabels& labels,
                                      const PartTree& tree) {
  std::vector<glm::vec3> straight(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const auto& sweep = tree.sweeps[labels.parts[i]])
      straight[i] = sweep->straightened(sweep->toPart(samples.positions[i]));
  return straight;
}

ClipFit measureClip(const SkinSamples& samples, const SourceSkin& skin, std::uint32_t clip,
                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree,
                    const std::vector<glm::vec3>& straight, const std::vector<RigDescription::Clip>& keys) {
  constexpr int kMoments = 12;
  const std::vector<double> times = evenTimes(skin.clips[clip], kMoments);
  const SkinMoments moments = momentsAt(skin, clip, times, space, 1);
  ClipFit fit;
  fit.all.clip = skin.clips[clip].name;
  struct List {
    std::vector<double> distances, areas;
    void add(double distance, double area) {
      distances.push_back(distance);
      areas.push_back(area);
    }
    SkinDistances summary() const {
      SkinDistances its;
      double area = 0;
      for (std::size_t i = 0; i < distances.size(); ++i) {
        its.mean += areas[i] * distances[i];
        area += areas[i];
        its.max = std::max(its.max, distances[i]);
      }
      its.mean /= area;
      its.p95 = weightedQuantile(distances, areas, 0.95);
      return its;
    }
  };
  List all;
  std::vector<List> of_parts(labels.joints.size());
  double most = -1;
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
      all.add(distance, samples.areas[i]);
      of_parts[part].add(distance, samples.areas[i]);
      if (distance <= most) continue;
      most = distance;
      fit.all.joint = skin.joints[samples.heaviestJoint(i)].name;
    }
  }
  fit.all.distances = all.summary();
  for (const List& part : of_parts) fit.parts.push_back(part.summary());
  return fit;
}

}  // namespace kelp::bake
