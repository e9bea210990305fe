// SPDX-License-Identifier: MIT
#include <vector>

#include "kelp/rig/rig.h"

namespace kelp {
namespace {

// Two directions at right angles to the axis: `side` is level for every axis, `other` is the remaining one.
struct Directions {
  glm::vec3 side, other;
};

Directions directionsOf(Axis axis) {
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  switch (axis) {
    case Axis::kPlusX:
    case Axis::kMinusX:
      return {z, y};
    case Axis::kPlusZ:
    case Axis::kMinusZ:
      return {x, y};
    case Axis::kPlusY:
    case Axis::kMinusY:
      break;
  }
  return {x, z};
}

RigDescription::Wave wave(int knot, Target target, const glm::vec3& amplitude, float period, float phase) {
  return {knot, target, amplitude, period, phase};
}

// A plant in a slow current: the foot stands upright, the top swings along one direction in 3 s and across it
// in 5 s. The two meet again only after 15 s, so the motion does not look repeated, but the clip loops. The
// tip's tangent runs ahead of its position when the stem is pulled and lags when it springs back, which looks
// elastic.
RigDescription sway(Axis axis) {
  const auto [side, other] = directionsOf(axis);
  RigDescription rig;
  rig.axis = axis;
  RigDescription::Clip clip{"sway", 15.0f, {}, {}};
  clip.waves = {wave(1, Target::kKnotOffset, 0.11f * side, 3, 0),
                wave(1, Target::kKnotTangent, 0.26f * side, 3, -0.06f),
                wave(1, Target::kKnotOffset, 0.05f * other, 5, 0.15f),
                wave(1, Target::kKnotTangent, 0.13f * other, 5, 0.1f),
                wave(0, Target::kKnotTangent, glm::vec3(0), 3, 0)};  // does not follow the top
  rig.clips.push_back(clip);
  return rig;
}

// A fish: a wave runs from the head, which hardly moves, to the tail, where it is widest. The tangents are
// the slope of the travelling wave a(s) sin(2 pi (t/period - s/length)), with s along the body.
RigDescription swim(Axis axis) {
  const glm::vec3 side = directionsOf(axis).side;
  RigDescription rig;
  rig.axis = axis;
  rig.knots = {
      {0, glm::vec3(0), std::nullopt}, {0.5f, glm::vec3(0), std::nullopt}, {1, glm::vec3(0), std::nullopt}};
  RigDescription::Clip clip{"swim", 1.0f, {}, {}};
  clip.waves = {wave(0, Target::kKnotOffset, 0.02f * side, 1, 0.25f),
                wave(0, Target::kKnotTangent, -0.06f * side, 1, 0.25f),
                wave(1, Target::kKnotOffset, 0.035f * side, 1, 0),
                wave(1, Target::kKnotTangent, 0.16f * side, 1, -0.15f),
                wave(2, Target::kKnotOffset, 0.13f * side, 1, -0.25f),
                wave(2, Target::kKnotTangent, 0.5f * side, 1, -0.35f)};
  rig.clips.push_back(clip);
  return rig;
}

// One wave of sections, in a cage.
RigDescription sections(Axis axis, std::vector<float> knots, const char* clip,
                        const RigDescription::Wave& wave) {
  RigDescription rig;
  rig.axis = axis;
  for (const float at : knots) rig.knots.push_back({at, glm::vec3(0), std::nullopt});
  rig.clips.push_back({clip, wave.period, {wave}, {}});
  rig.bend = Bend::kSweep;
  rig.caged = true;
  return rig;
}

// A chest: the middle widens and narrows.
RigDescription breathe(Axis axis) {
  return sections(axis, {0, 0.5f, 1}, "breathe", {1, Target::kKnotOffset, {0.08f, 0.08f, 0}, 4, 0, true});
}

// A tower: its end turns about the axis, a quarter turn to each side.
RigDescription twist(Axis axis) {
  return sections(axis, {0, 1}, "twist", {1, Target::kKnotTangent, {1.57079633f, 0, 0}, 6, 0, true});
}

}  // namespace

std::optional<RigDescription> presetRig(std::string_view name, std::optional<Axis> axis,
                                        std::optional<Axis> up) {
  if (name == "sway") return sway(axis.value_or(up.value_or(Axis::kPlusY)));
  if (name == "swim") return swim(axis.value_or(Axis::kMinusZ));
  if (name == "breathe") return breathe(axis.value_or(up.value_or(Axis::kPlusY)));
  if (name == "twist") return twist(axis.value_or(up.value_or(Axis::kPlusY)));
  if (name == "none") {
    RigDescription rig;
    rig.axis = axis;
    return rig;
  }
  return std::nullopt;
}

std::vector<std::string> presetNames() { return {"none", "sway", "swim", "breathe", "twist"}; }

}  // namespace kelp
