// SPDX-License-Identifier: MIT
#include "detail.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::draw {
namespace {

bool isFinite(const glm::dmat4& m) {
  double sum = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) sum += 0.0 * m[column][row];
  }
  return sum == 0.0;
}

}  // namespace

Result<Projection> makeProjection(const View& view) {
  const glm::dmat4 to_eye(view.camera.world_to_eye);
  const glm::dmat4 to_clip(view.camera.eye_to_clip);
  Projection projection;
  projection.world_to_clip = to_clip * to_eye;
  projection.linear = projection.world_to_clip;
  const double determinant = glm::determinant(projection.world_to_clip);
  if (!isFinite(projection.world_to_clip) || !std::isfinite(determinant) || determinant == 0.0) {
    return Error{ErrorCode::kMisuse, "the view's matrices are not finite and invertible"};
  }
  // All rays of a view meet where clip x, y and w vanish: at the eye, or, orthographic, at infinity.
  const bool orthographic = to_clip[0][3] == 0 && to_clip[1][3] == 0 && to_clip[2][3] == 0;
  projection.eye = glm::inverse(projection.world_to_clip) * glm::dvec4(0, 0, 1, 0);
  if (orthographic) {
    projection.eye /= glm::length(glm::dvec3(projection.eye));
    if ((to_eye * projection.eye).z > 0) projection.eye = -projection.eye;
    projection.eye.w = 0;
  } else {
    projection.eye /= projection.eye.w;
  }
  double side = 0;  // of a unit cube in eye space: to_world has what world_to_eye does not scale
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, glm::length(glm::dvec3(to_eye[axis])));
  const double pixels =
      std::max(glm::length(glm::dvec3(to_clip[0][0], to_clip[1][0], to_clip[2][0])) * view.camera.viewport.x,
               glm::length(glm::dvec3(to_clip[0][1], to_clip[1][1], to_clip[2][1])) * view.camera.viewport.y);
  projection.pixel_scale = static_cast<float>(0.5 * side * pixels);
  return projection;
}

bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel) {
  const int x = pixel.x ^ pixel.y;
  const int y = pixel.y;
  return ((x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 | (y & 4) >> 2) <
         detail.coarser;
}

}  // namespace kelp::draw
