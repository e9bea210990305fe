// SPDX-License-Identifier: MIT
// The joints that the nodes of a cage follow.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cage_places.h"
#include "kelp/formats/raw_pack.h"
#include "samples.h"

namespace kelp::bake {

using SamplePlaces = std::vector<std::optional<CagePlaces::Place>>;  // one a sample

// Finds by least squares what nodes need so that the cage, interpolated, moves the samples as the skin does.
// Nodes far from samples have what is around them; pieces without samples follow the nearest one.
class NodeSolver {
 public:
  // At least one sample, with a place or without. Keeps references.
  NodeSolver(const SkinSamples& samples, const SamplePlaces& places, const Cage& cage);
  ~NodeSolver();
  // Of each node the four largest weights, in 255ths. `parts` of the result are joints.
  std::vector<Influences> weights(std::size_t joints, int threads) const;
  // Where morph targets move nodes; nodes that they move less than 1/50 voxel are left out, and targets
  // that move any out of all sight. of_samples(m):
  // where target m moves the samples; any thread may call it. `part` of the result is not set.
  std::vector<RawMorph> morphs(std::size_t count,
                               const std::function<std::vector<Offset>(std::size_t)>& of_samples,
                               int threads) const;

 private:
  struct Equations;
  RawMorph morph(const std::vector<Offset>& of_samples) const;
  void findStrays();

  const SkinSamples& samples_;
  const SamplePlaces& places_;
  const Cage& cage_;
  SampleFinder finder_;
  std::unique_ptr<Equations> equations_;
  // Of nodes that edges join to no sample: the sample nearest to the first of them.
  std::vector<std::optional<std::uint32_t>> strays_;
};

// Weights above 0 that sum to about 1, in 255ths: at most four, ascending by joint.
struct JointWeight {
  double weight = 0;
  std::uint32_t joint = 0;
};
Influences roundedWeights(std::vector<JointWeight> weights);

}  // namespace kelp::bake
