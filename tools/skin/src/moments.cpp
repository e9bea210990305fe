// SPDX-License-Identifier: MIT
#include "moments.h"

#include <algorithm>

namespace kelp::bake {

std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(clip.duration) * (i + 0.5) / count);
  return times;
}

std::vector<glm::dmat4x3> motionsAt(const SourceSkin& skin, std::uint32_t index, double time) {
  const SourceSkin::Clip& clip = skin.clips[index];
  const std::size_t count = skin.joints.size();
  const auto after = std::upper_bound(clip.times.begin(), clip.times.end(), time,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const auto b = static_cast<std::size_t>(after - clip.times.begin());
  std::vector<glm::dmat4x3> out;
  for (std::size_t j = 0; j < count; ++j) {
    if (b == 0 || b == clip.times.size()) {
      out.push_back(clip.motions[(b == 0 ? 0 : b - 1) * count + j]);
      continue;
    }
    const double begin = clip.times[b - 1], end = clip.times[b], share = (time - begin) / (end - begin);
    const glm::dmat4x3& from = clip.motions[(b - 1) * count + j];
    out.push_back(from + share * (clip.motions[b * count + j] - from));
  }
  return out;
}

}  // namespace kelp::bake
