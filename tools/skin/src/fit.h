// SPDX-License-Identifier: MIT
// How far a cage is from linear blend skinning.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kelp/skin/skin.h"
#include "weights.h"

namespace kelp::bake {

// The motions of joints at a moment, one a joint, in voxels: posed <- bind pose.
using JointMotions = std::vector<glm::dmat4x3>;

struct SkinMoment {
  JointMotions joints;
  std::vector<double> weights;  // of morph targets; none: all are 0
};

// Where morph targets move nodes and samples.
struct MorphOffsets {
  std::span<const RawMorph> of_nodes;
  std::span<const std::vector<Offset>> of_samples;
};

// Moments of a clip, in the middles of equal stretches.
std::vector<SkinMoment> momentsOfClip(const SourceSkin& skin, std::uint32_t clip, const Frame& frame,
                                      int moments);
// For a skin without clips: each joint turns about its origin, by the axes in turn.
std::vector<SkinMoment> inventedMoments(const SourceSkin& skin, const Frame& frame);

struct CageFit {
  SkinDistances distances;
  std::uint32_t joint = 0;  // that moves the surface most where the distance is greatest
};

// Of nodes that follow joints by `influences`. Samples without a place do not count.
CageFit fitOf(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
              std::span<const Influences> influences, const MorphOffsets& morphs,
              std::span<const SkinMoment> moments);
// Of a morph target alone, its weight 1: where it or the cage moves the surface.
CageFit fitOfMorph(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage,
                   const MorphOffsets& morphs, std::size_t morph);

}  // namespace kelp::bake
