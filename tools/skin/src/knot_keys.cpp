// SPDX-License-Identifier: MIT
#include "knot_keys.h"

#include <algorithm>
#include <utility>

#include "key_choice.h"

namespace kelp::bake {
namespace {

constexpr double kRounding = 1.0 / 64;  // voxels

}  // namespace

Between valuesAt(const RigDescription::Track& track, double time) {
  const auto after = std::upper_bound(
      track.keys.begin(), track.keys.end(), time,
      [](double t, const RigDescription::Key& key) { return t < static_cast<double>(key.time); });
  if (after == track.keys.begin()) return {track.keys.front().value, track.keys.front().value, 0};
  if (after == track.keys.end()) return {track.keys.back().value, track.keys.back().value, 0};
  const RigDescription::Key& before = *(after - 1);
  return {before.value, after->value,
          (time - static_cast<double>(before.time)) /
              (static_cast<double>(after->time) - static_cast<double>(before.time))};
}

bool movesKnots(const RigDescription::Track& track) {
  return track.target == Target::kKnotOffset || track.target == Target::kKnotTangent;
}

void addKnotTracks(const SkinSweep& sweep, const std::vector<SkinPose>& poses,
                   const std::vector<float>& times, double tolerance, RigDescription::Clip& clip) {
  const double radius = 0.5 * std::max(sweep.size.x, sweep.size.z);
  for (std::size_t k = 0; k < sweep.knots.size(); ++k)
    for (const Target target : {Target::kKnotOffset, Target::kKnotTangent}) {
      // The most that a unit of the value moves: the knot, or the sides of its section.
      const double reach = target == Target::kKnotOffset ? sweep.height() : radius;
      std::vector<glm::dvec3> values;
      double most = 0;
      for (const SkinPose& pose : poses) {
        const glm::dvec3 exact(target == Target::kKnotOffset
                                   ? pose.knots[k].position - sweep.knots[k].position
                                   : pose.knots[k].tangent - sweep.knots[k].tangent);
        glm::dvec3& value = values.emplace_back();
        for (int axis = 0; axis < 3; ++axis) value[axis] = roundedKey(exact[axis], kRounding / reach);
        most = std::max(most, reach * glm::length(values.back()));
      }
      if (most == 0) continue;
      RigDescription::Track track;
      track.knot = static_cast<int>(k);
      track.target = target;
      const auto error = [&](std::size_t i, std::size_t a, std::size_t b) {
        return reach * glm::distance(glm::mix(values[a], values[b], shareOf(times, i, a, b)), values[i]);
      };
      const std::vector<std::size_t> keys = chooseKeys(times.size(), tolerance, error);
      for (const std::size_t i : keys)
        track.keys.push_back(
            {keys.size() == 1 ? 0.0f : times[i], glm::vec4(glm::vec3(values[i]), 0), {}, {}});
      clip.tracks.push_back(std::move(track));
    }
}

std::vector<Knot> knotsAt(const SkinSweep& sweep, const RigDescription::Clip& clip, double time) {
  std::vector<Knot> knots = sweep.knots;
  for (const RigDescription::Track& track : clip.tracks) {
    if (!movesKnots(track)) continue;
    const Between at = valuesAt(track, time);
    const glm::vec3 value(glm::mix(at.a, at.b, static_cast<float>(at.share)));
    Knot& knot = knots[static_cast<std::size_t>(track.knot)];
    (track.target == Target::kKnotOffset ? knot.position : knot.tangent) += value;
  }
  return knots;
}

}  // namespace kelp::bake
