// SPDX-License-Identifier: MIT
// The joints that the nodes of a cage follow.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cage_places.h"
#include "samples.h"

namespace kelp::bake {

using SamplePlaces = std::vector<std::optional<CagePlaces::Place>>;  // one a sample

// Weights with which the cage, interpolated, moves the samples as the skin does, by least squares; of each
// node the four largest, in 255ths. `parts` of the result are joints. Nodes far from samples have what is
// around them; pieces without samples follow the nearest one. At least one sample, with a place or without.
std::vector<Influences> weightsOfNodes(const SkinSamples& samples, const SamplePlaces& places,
                                       const Cage& cage, std::size_t joints, int threads);

// Weights above 0 that sum to about 1, in 255ths: at most four, ascending by joint.
struct JointWeight {
  double weight = 0;
  std::uint32_t joint = 0;
};
Influences roundedWeights(std::vector<JointWeight> weights);

}  // namespace kelp::bake
