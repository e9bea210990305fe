// SPDX-License-Identifier: MIT
// Knots and clips in voxels, for tests that think in voxels.
#pragma once

#include <span>
#include <vector>

#include "kelp/formats/raw_pack.h"

namespace kelp::test {

// Knots of a part of `height` voxels, given in voxels.
inline std::vector<Knot> inHeights(std::vector<Knot> voxels, float height) {
  for (Knot& knot : voxels) knot.position /= height, knot.tangent /= height;
  return voxels;
}
inline std::vector<Knot> inVoxels(std::span<const Knot> knots, float height) {
  std::vector<Knot> voxels(knots.begin(), knots.end());
  for (Knot& knot : voxels) knot.position *= height, knot.tangent *= height;
  return voxels;
}

// A clip of a part of `height` voxels, given in voxels.
inline RawClip inHeights(RawClip clip, float height) {
  for (Wave& wave : clip.waves) wave.amplitude /= height;
  for (RawTrack& track : clip.tracks) {
    if (track.target != Target::kKnotOffset && track.target != Target::kKnotTangent) continue;
    for (Key& key : track.keys) key.value /= height, key.in /= height, key.out /= height;
  }
  return clip;
}

}  // namespace kelp::test
