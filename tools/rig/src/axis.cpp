// SPDX-License-Identifier: MIT
#include <algorithm>

#include "kelp/rig/rig_file.h"

namespace kelp {

std::optional<Axis> parseAxis(std::string_view text) {
  bool minus = false;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    minus = text[0] == '-';
    text.remove_prefix(1);
  }
  if (text == "x") return minus ? Axis::kMinusX : Axis::kPlusX;
  if (text == "y") return minus ? Axis::kMinusY : Axis::kPlusY;
  if (text == "z") return minus ? Axis::kMinusZ : Axis::kPlusZ;
  return std::nullopt;
}

const char* toString(Axis axis) {
  switch (axis) {
    case Axis::kPlusX:
      return "+x";
    case Axis::kMinusX:
      return "-x";
    case Axis::kPlusY:
      return "+y";
    case Axis::kMinusY:
      return "-y";
    case Axis::kPlusZ:
      return "+z";
    case Axis::kMinusZ:
      return "-z";
  }
  return "+y";
}

glm::mat3 axisRotation(Axis axis) {
  // Columns: the images of the artist's x, y and z. Quarter turns about the axis that is neither y nor the
  // spline's; for -y half a turn about x.
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  switch (axis) {
    case Axis::kPlusX:
      return {y, -x, z};
    case Axis::kMinusX:
      return {-y, x, z};
    case Axis::kPlusY:
      return {x, y, z};
    case Axis::kMinusY:
      return {x, -y, -z};
    case Axis::kPlusZ:
      return {x, -z, y};
    case Axis::kMinusZ:
      return {x, z, -y};
  }
  return {x, y, z};
}

std::optional<Axis> axisByPlace(const glm::mat4x3& to_object, const glm::mat4x3& pivot) {
  for (const Axis axis :
       {Axis::kPlusX, Axis::kMinusX, Axis::kPlusY, Axis::kMinusY, Axis::kPlusZ, Axis::kMinusZ}) {
    const glm::dmat3 to_file(glm::transpose(axisRotation(axis)));
    double apart = 0;
    for (int column = 0; column < 3; ++column) {
      const glm::dvec3 expected = glm::dmat3(glm::dmat4x3(pivot)) * to_file[column];
      apart = std::max(
          apart, glm::distance(glm::normalize(expected), glm::normalize(glm::dvec3(to_object[column]))));
    }
    if (apart < 1e-3) return axis;
  }
  return std::nullopt;
}

}  // namespace kelp
