// SPDX-License-Identifier: MIT
// How neighboring parts move apart along their seam.
#pragma once

#include <cstdint>
#include <vector>

#include "decompose.h"
#include "tree.h"

namespace kelp::bake {

// All in voxels of the whole.
struct SeamSteps {
  struct Place {
    glm::dvec3 at{0};
    glm::dvec3 across{0};      // from a to b along the surface; of unit length, or zero
    std::uint32_t motion = 0;  // which of `steps` and `back_steps`
  };
  std::uint32_t a = 0, b = 0;  // parts, a < b
  std::vector<Place> places;
  // The motion of a, seen from b, at each moment; and the other way round. Along a swept part there are
  // several.
  std::vector<std::vector<glm::dmat4x3>> steps, back_steps;

  const Place& nearest(const glm::dvec3& at) const;
  // How far the two parts move apart at such a point near `place`, at the worst moment.
  double opening(const Place& place, const glm::dvec3& at) const;
};

// Of all seams.
std::vector<SeamSteps> stepsAtSeams(const SkinSamples& samples, const SkinMoments& moments,
                                    const SkinSpace& space, const SkinLabels& labels, const PartTree& tree);

}  // namespace kelp::bake
