// SPDX-License-Identifier: MIT
#include "pack/part_axis.h"

#include <algorithm>

namespace kelp::dump {

std::optional<Axis> bakedAxis(const Part& part) {
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    const glm::dmat3 to_file(glm::transpose(axisRotation(axis)));
    double apart = 0;
    for (int column = 0; column < 3; ++column) {
      const glm::dvec3 expected = glm::dmat3(glm::dmat4x3(part.pivot)) * to_file[column];
      apart = std::max(
          apart, glm::distance(glm::normalize(expected), glm::normalize(glm::dvec3(part.to_object[column]))));
    }
    if (apart < 1e-3) return axis;
  }
  return std::nullopt;
}

}  // namespace kelp::dump
