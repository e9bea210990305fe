// SPDX-License-Identifier: MIT
#include "morph_gaps.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {

MorphGaps::MorphGaps(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame)
    : soup_(soup), first_offset_(skin.first_influence.size(), 0) {
  for (const SourceSkin::Morph& morph : skin.morphs)
    for (const std::uint32_t vertex : morph.vertices) ++first_offset_[vertex + 1];
  for (std::size_t v = 1; v < first_offset_.size(); ++v) first_offset_[v] += first_offset_[v - 1];
  offsets_.resize(first_offset_.back());
  std::vector<std::size_t> next = first_offset_;
  const glm::dmat3 to_voxels(frame.node_to_voxel);
  for (std::uint32_t m = 0; m < skin.morphs.size(); ++m)
    for (std::size_t i = 0; i < skin.morphs[m].vertices.size(); ++i)
      offsets_[next[skin.morphs[m].vertices[i]]++] = {m, to_voxels * glm::dvec3(skin.morphs[m].offsets[i])};
}

void MorphGaps::add(const SkinSamples& of, std::size_t i, double sign) {
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t vertex = soup_.skinned[of.triangles[i]][static_cast<std::size_t>(c)];
    for (std::size_t k = first_offset_[vertex]; k < first_offset_[vertex + 1]; ++k)
      sums_.push_back({offsets_[k].index, sign * of.shares[i][c] * offsets_[k].by});
  }
}

double MorphGaps::between(const SkinSamples& a, std::size_t i, const SkinSamples& b, std::size_t j) {
  sums_.clear();
  add(a, i, 1);
  add(b, j, -1);
  std::stable_sort(sums_.begin(), sums_.end(),
                   [](const Offset& one, const Offset& other) { return one.index < other.index; });
  double most = 0;
  for (std::size_t k = 0; k < sums_.size();) {
    const std::uint32_t target = sums_[k].index;
    glm::dvec3 apart(0);
    for (; k < sums_.size() && sums_[k].index == target; ++k) apart += sums_[k].by;
    most = std::max(most, glm::length(apart));
  }
  return most;
}

}  // namespace kelp::bake
