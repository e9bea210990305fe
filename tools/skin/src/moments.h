// SPDX-License-Identifier: MIT
// How joints move, in the space in which skins are divided.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/import/core/source_model.h"
#include "rigid.h"
#include "samples.h"

namespace kelp::bake {

// The motions of joints at some moments.
struct SkinMoments {
  std::size_t joints = 0;
  std::vector<glm::dmat4x3> motions;  // of moment t and joint j at [t * joints + j]: posed <- bind pose
  std::vector<glm::dmat3> rotations;  // the rotations nearest to them
  std::vector<std::uint32_t> clips;   // of each moment
  // Of each joint: true if these clips scale it. Between samples a turning joint shrinks a little, too.
  std::vector<bool> scaling;

  std::size_t size() const { return clips.size(); }
  const glm::dmat4x3& motion(std::size_t moment, std::uint32_t joint) const {
    return motions[moment * joints + joint];
  }
  const glm::dmat3& rotation(std::size_t moment, std::uint32_t joint) const {
    return rotations[moment * joints + joint];
  }
};

// Of each joint: true if a clip makes it larger or smaller by more than such a share.
std::vector<bool> scalingJoints(const SourceSkin& skin, double most = kSameSize);
// Of chains: a swept part keeps its thickness, and breathing is no reason to give it up.
inline constexpr double kSweptScale = 0.05;

// The middles of `count` equal stretches of a clip.
std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count);

// The joints at these times of a clip; between samples motions are linear.
SkinMoments momentsAt(const SourceSkin& skin, std::uint32_t clip, const std::vector<double>& times,
                      const SkinSpace& space, int threads);

// Moments by which parts are judged, of all clips evenly. A moment like the bind pose, or like the one before
// it in its clip, does not count: still clips must not make the others look better than they are.
SkinMoments judgedMoments(const SourceSkin& skin, const SkinSamples& samples, const SkinSpace& space,
                          int threads);

// Where linear blend skinning draws sample i.
inline glm::dvec3 skinnedPoint(const SkinSamples& samples, std::size_t i, const SkinMoments& moments,
                               std::size_t moment) {
  glm::dvec3 at(0);
  for (std::size_t k = samples.first_weighted[i]; k < samples.first_weighted[i + 1]; ++k)
    at += moments.motion(moment, samples.weighted[k].joint) * samples.weighted[k].x;
  return at;
}

}  // namespace kelp::bake
