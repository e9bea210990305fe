// SPDX-License-Identifier: MIT
#include "kelp/import/core/source_model.h"

#include <utility>

namespace kelp::bake {

void SourceSkin::keepMorphs(const std::vector<std::size_t>& kept) {
  const std::size_t count = morphs.size();
  for (Clip& clip : clips) {
    std::vector<float> weights;
    for (std::size_t i = 0; i < clip.weights.size(); i += count)
      for (const std::size_t morph : kept) weights.push_back(clip.weights[i + morph]);
    clip.weights = std::move(weights);
  }
  std::vector<Morph> left;
  for (const std::size_t morph : kept) left.push_back(std::move(morphs[morph]));
  morphs = std::move(left);
}

std::vector<glm::dmat4x3> SourceSkin::motionsAt(const Clip& clip, std::size_t time) const {
  std::vector<glm::dmat4x3> motions;
  motions.reserve(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const glm::dmat4x3& local = clip.locals[time * joints.size() + j];
    motions.push_back(joints[j].parent < 0
                          ? local
                          : motions[static_cast<std::size_t>(joints[j].parent)] * glm::dmat4(local));
  }
  return motions;
}

}  // namespace kelp::bake
