// SPDX-License-Identifier: MIT
#include "placement.h"

#include <algorithm>

namespace kelp::bake {
namespace {

glm::mat4x3 placed(const glm::dmat3& outer, const glm::mat4x3& inner) {
  return {glm::vec3(outer * glm::dvec3(inner[0])), glm::vec3(outer * glm::dvec3(inner[1])),
          glm::vec3(outer * glm::dvec3(inner[2])), glm::vec3(outer * glm::dvec3(inner[3]))};
}

}  // namespace

void placeInObject(SourceModel& model, const ImportSettings& settings) {
  const Axis up = settings.up.value_or(model.up);
  if (up == Axis::kPlusY && settings.unit == 1) return;
  // As exporters turn: a quarter turn about x or z, for -y half a turn about x.
  const glm::dmat3 outer = settings.unit * glm::dmat3(axisRotation(up));
  for (SourcePart& part : model.parts) {
    part.to_object = placed(outer, part.to_object);
    part.pivot = placed(outer, part.pivot);
  }
}

}  // namespace kelp::bake
