// SPDX-License-Identifier: MIT
// How a part bends: the words for it, and the rest rig.
#include <numbers>
#include <string>

#include "kelp/formats/sweep.h"
#include "kelp/rig/rig.h"
#include "words.h"

namespace kelp {

std::optional<Bend> parseBend(std::string_view text) {
  for (const Bend bend : {Bend::kShear, Bend::kSweep})
    if (text == toString(bend)) return bend;
  return std::nullopt;
}

const char* toString(Bend bend, bool caged) {
  return caged ? "cage" : bend == Bend::kSweep ? "sweep" : "shear";
}

double rollInDegrees(float roll) { return static_cast<double>(roll) * 180 / std::numbers::pi; }

float rollOfDegrees(double degrees) { return static_cast<float>(degrees * std::numbers::pi / 180); }

RestRig realizeRig(const RigDescription& rig, Bend by_default) {
  RestRig rest{{realizeKnots(rig), automaticTangents(rig), rig.parent_at}, rig.caged, rig.cell};
  rest.bend = rig.bend.value_or(by_default);
  rest.roll = rig.roll;
  return rest;
}

void checkRest(const RawRig& rest, const glm::ivec3& size) {
  const Result<void> sound = checkRig(rest.bend, rest.knots, size, rest.roll);
  if (sound) return;
  const ErrorCode code = sound.error().code;
  const char* const remedy =
      code == ErrorCode::kMisuse ? "give it or the next another offset or tangent"
      : code == ErrorCode::kNotMonotone
          ? "the spline may not turn back along its axis: give the knot a shorter tangent or a smaller "
            "offset, or write \"bend\": \"sweep\""
          : "a swept part may not fold: let it turn over a greater length or by other tangents, or make it "
            "thinner";
  throw RigError(rig::placeOf(rest.knots, sound.error().offset) + ": " + sound.error().detail + "; " +
                 remedy);
}

}  // namespace kelp
