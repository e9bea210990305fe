// SPDX-License-Identifier: MIT
#include "moments.h"

#include <algorithm>
#include <cstddef>

namespace kelp::bake {

std::vector<double> evenTimes(const SourceSkin::Clip& clip, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(clip.duration) * (i + 0.5) / count);
  return times;
}

std::vector<glm::dmat4x3> motionsAt(const SourceSkin& skin, std::uint32_t clip, double time) {
  const SourceSkin::Clip& its = skin.clips[clip];
  const auto after = std::upper_bound(its.times.begin(), its.times.end(), time,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const auto b = static_cast<std::size_t>(after - its.times.begin()), a = b > 0 ? b - 1 : 0;
  const std::size_t count = skin.joints.size();
  SourceSkin::Clip moment;
  const auto row = its.locals.begin() + static_cast<std::ptrdiff_t>(a * count);
  moment.locals.assign(row, row + static_cast<std::ptrdiff_t>(count));
  if (b > 0 && after != its.times.end()) {
    const double begin = static_cast<double>(its.times[a]), end = static_cast<double>(its.times[b]);
    const double share = (time - begin) / (end - begin);
    for (std::size_t j = 0; j < count; ++j)
      moment.locals[j] += share * (its.locals[b * count + j] - moment.locals[j]);
  }
  return skin.motionsAt(moment, 0);
}

}  // namespace kelp::bake
