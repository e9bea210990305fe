// SPDX-License-Identifier: MIT
#include "fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "moments.h"

namespace kelp::bake {
namespace {

// Seen in the voxels of a frame.
JointMotions inVoxels(const std::vector<glm::dmat4x3>& motions, const Frame& frame) {
  const glm::dmat4 back = glm::inverse(frame.node_to_voxel);
  JointMotions out;
  out.reserve(motions.size());
  for (const glm::dmat4x3& motion : motions)
    out.emplace_back(frame.node_to_voxel * glm::dmat4(motion) * back);
  return out;
}

glm::dvec3 skinnedAt(const SkinSamples& samples, std::size_t i, const glm::dvec3& morphed,
                     const JointMotions& motions) {
  const glm::dvec4 rest(morphed, 1);
  glm::dvec3 at(0);
  for (const SkinSamples::Weighted& w : samples.weights(i)) at += w.weight * (motions[w.joint] * rest);
  return at;
}

void addOffsets(const RawMorph& morph, double weight, std::vector<glm::dvec3>& nodes) {
  for (std::size_t i = 0; i < morph.nodes.size(); ++i)
    nodes[morph.nodes[i]] += weight * static_cast<double>(morph.step) * glm::dvec3(morph.offsets[i]);
}

std::vector<glm::dvec3> morphedSamples(const SkinSamples& samples, const MorphOffsets& morphs,
                                       const std::vector<double>& weights) {
  std::vector<glm::dvec3> morphed = samples.positions;
  for (std::size_t m = 0; m < weights.size(); ++m)
    if (weights[m] != 0)
      for (const Offset& offset : morphs.of_samples[m]) morphed[offset.index] += weights[m] * offset.by;
  return morphed;
}

std::vector<glm::dvec3> posedNodes(const Cage& cage, std::span<const Influences> influences,
                                   const MorphOffsets& morphs, const SkinMoment& moment) {
  std::vector<glm::dvec3> nodes;
  nodes.reserve(influences.size());
  for (std::uint32_t n = 0; n < influences.size(); ++n) nodes.emplace_back(cage.rest(n));
  for (std::size_t m = 0; m < moment.weights.size(); ++m)
    if (moment.weights[m] != 0) addOffsets(morphs.of_nodes[m], moment.weights[m], nodes);
  for (std::uint32_t n = 0; n < influences.size(); ++n) {
    const glm::dvec4 rest(nodes[n], 1);
    glm::dvec3& at = nodes[n] = glm::dvec3(0);
    for (int i = 0; i < 4; ++i)
      if (influences[n].weights[i] != 0)
        at += influences[n].weights[i] / 255.0 * (moment.joints[influences[n].parts[i]] * rest);
  }
  return nodes;
}

// Distances at samples by area, counted in steps; and the joint at the greatest.
class SampleDistances {
 public:
  explicit SampleDistances(const SkinSamples& samples) : samples_(samples) {}
  void add(std::size_t sample, double distance) {
    const double step = std::min(distance * kSteps, static_cast<double>(areas_.size() - 1));
    areas_[static_cast<std::size_t>(step)] += samples_.areas[sample];
    sum_ += samples_.areas[sample] * distance;
    area_ += samples_.areas[sample];
    if (distance <= max_) return;
    max_ = distance;
    joint_ = samples_.heaviestJoint(sample);
  }
  CageFit fit() const {
    CageFit fit;
    fit.joint = joint_;
    if (!(area_ > 0)) return fit;
    double below = 0;
    std::size_t step = 0;
    while (step + 1 < areas_.size() && (below += areas_[step]) < 0.95 * area_) ++step;
    const double most = std::max(max_, 0.0);
    fit.distances = {sum_ / area_, std::min(static_cast<double>(step + 1) / kSteps, most), most};
    return fit;
  }

 private:
  static constexpr int kSteps = 512, kFarthest = 64;  // of a voxel; voxels
  const SkinSamples& samples_;
  std::vector<double> areas_ = std::vector<double>(std::size_t{kSteps} * kFarthest, 0);
  double sum_ = 0, area_ = 0, max_ = -1;
  std::uint32_t joint_ = 0;
};

}  // namespace

std::vector<SkinMoment> momentsOfClip(const SourceSkin& skin, std::uint32_t clip, const Frame& frame,
                                      int moments) {
  std::vector<SkinMoment> out;
  for (const double time : evenTimes(skin.clips[clip], moments))
    out.push_back({inVoxels(motionsAt(skin, clip, time), frame), weightsAt(skin, clip, time)});
  return out;
}

std::vector<SkinMoment> inventedMoments(const SourceSkin& skin, const Frame& frame) {
  constexpr double kTurn = 0.6;
  std::vector<SkinMoment> out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<glm::dmat4> posed;
    std::vector<glm::dmat4x3> motions;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      glm::dvec3 about(0);
      about[static_cast<int>((axis + j) % 3)] = 1;
      const glm::dvec3 at(skin.joints[j].frame[3]);
      const glm::dmat4 turn = glm::translate(glm::dmat4(1), at) *
                              glm::rotate(glm::dmat4(1), j % 2 ? -kTurn : kTurn, about) *
                              glm::translate(glm::dmat4(1), -at);
      const int parent = skin.joints[j].parent;
      posed.push_back(parent < 0 ? turn : posed[static_cast<std::size_t>(parent)] * turn);
      motions.emplace_back(posed.back());
    }
    out.push_back({inVoxels(motions, frame), {}});
  }
  return out;
}

CageFit fitOf(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
              std::span<const Influences> influences, const MorphOffsets& morphs,
              std::span<const SkinMoment> moments) {
  SampleDistances all(samples);
  for (const SkinMoment& moment : moments) {
    const std::vector<glm::dvec3> nodes = posedNodes(cage, influences, morphs, moment),
                                  morphed = morphedSamples(samples, morphs, moment.weights);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!places[i]) continue;
      glm::dvec3 at(0);
      for (int k = 0; k < 4; ++k) at += places[i]->weights[k] * nodes[places[i]->nodes[k]];
      all.add(i, glm::distance(at, skinnedAt(samples, i, morphed[i], moment.joints)));
    }
  }
  return all.fit();
}

CageFit fitOfMorph(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
                   const MorphOffsets& morphs, std::size_t morph) {
  std::vector<glm::dvec3> nodes(cage.nodes(), glm::dvec3(0)), wanted(samples.size(), glm::dvec3(0));
  addOffsets(morphs.of_nodes[morph], 1, nodes);
  for (const Offset& offset : morphs.of_samples[morph]) wanted[offset.index] = offset.by;
  SampleDistances all(samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!places[i]) continue;
    glm::dvec3 by(0);
    for (int k = 0; k < 4; ++k) by += places[i]->weights[k] * nodes[places[i]->nodes[k]];
    if (by == glm::dvec3(0) && wanted[i] == glm::dvec3(0)) continue;
    all.add(i, glm::distance(by, wanted[i]));
  }
  return all.fit();
}

}  // namespace kelp::bake
