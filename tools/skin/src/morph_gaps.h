// SPDX-License-Identifier: MIT
// How far morph targets move places of the surface apart.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "samples.h"

namespace kelp::bake {

class MorphGaps {
 public:
  // Keeps a reference to the soup.
  MorphGaps(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame);
  // True if nothing is ever moved.
  bool none() const { return offsets_.empty(); }
  // The most that a target alone, its weight 1, moves two samples apart; voxels.
  double between(const SkinSamples& a, std::size_t i, const SkinSamples& b, std::size_t j);

 private:
  void add(const SkinSamples& of, std::size_t i, double sign);

  const TriangleSoup& soup_;
  std::vector<std::size_t> first_offset_;  // of each vertex of the skin, and the end
  std::vector<Offset> offsets_;            // `index`: the target
  std::vector<Offset> sums_;
};

}  // namespace kelp::bake
