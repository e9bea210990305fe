// SPDX-License-Identifier: MIT
#include "kelp/rig/rig.h"

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

}  // namespace kelp
