// SPDX-License-Identifier: MIT
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

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
