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

namespace {

// Samples of a clip around a time, and how far it is from the first to the second.
struct Between {
  std::size_t a = 0, b = 0;
  double share = 0;

  Between(const SourceSkin::Clip& clip, double time) {
    const auto after = std::upper_bound(clip.times.begin(), clip.times.end(), time,
                                        [](double t, float key) { return t < static_cast<double>(key); });
    b = static_cast<std::size_t>(after - clip.times.begin());
    a = b > 0 ? b - 1 : 0;
    if (b == 0 || after == clip.times.end()) {
      b = a;
      return;
    }
    const double begin = static_cast<double>(clip.times[a]), end = static_cast<double>(clip.times[b]);
    share = (time - begin) / (end - begin);
  }
};

}  // namespace

std::vector<glm::dmat4x3> motionsAt(const SourceSkin& skin, std::uint32_t clip, double time) {
  const SourceSkin::Clip& its = skin.clips[clip];
  const auto [a, b, share] = Between(its, time);
  const std::size_t count = skin.joints.size();
  SourceSkin::Clip moment;
  const auto row = its.locals.begin() + static_cast<std::ptrdiff_t>(a * count);
  moment.locals.assign(row, row + static_cast<std::ptrdiff_t>(count));
  for (std::size_t j = 0; b != a && j < count; ++j)
    moment.locals[j] += share * (its.locals[b * count + j] - moment.locals[j]);
  return skin.motionsAt(moment, 0);
}

std::vector<double> weightsAt(const SourceSkin& skin, std::uint32_t clip, double time) {
  const SourceSkin::Clip& its = skin.clips[clip];
  const auto [a, b, share] = Between(its, time);
  const std::size_t count = skin.morphs.size();
  std::vector<double> weights;
  for (std::size_t m = 0; m < count; ++m)
    weights.push_back(glm::mix(static_cast<double>(its.weights[a * count + m]),
                               static_cast<double>(its.weights[b * count + m]), share));
  return weights;
}

}  // namespace kelp::bake
