// SPDX-License-Identifier: MIT
#include "detail.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kelp::gl {
namespace {

// Added to the bounds on every side: a ray that meets a voxel in the box's very face must not be lost to rounding. Voxels.
constexpr float kMargin = 1.0f / 64.0f;

bool isFinite(const glm::dmat4& m) {
  double sum = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) sum += 0.0 * m[column][row];
  }
  return sum == 0.0;
}

}  // namespace

Result<Camera> makeCamera(const View& view) {
  const glm::dmat4 to_eye(view.world_to_eye);
  const glm::dmat4 to_clip(view.eye_to_clip);
  Camera camera;
  camera.world_to_clip = to_clip * to_eye;
  const double determinant = glm::determinant(camera.world_to_clip);
  if (!isFinite(camera.world_to_clip) || !std::isfinite(determinant) || determinant == 0.0) {
    return Error{ErrorCode::kMisuse, "the view's matrices are not finite and invertible"};
  }
  // All rays of a view meet where clip x, y and w vanish: at the eye, or, orthographic, at infinity.
  const bool orthographic = to_clip[0][3] == 0 && to_clip[1][3] == 0 && to_clip[2][3] == 0;
  camera.eye = glm::inverse(camera.world_to_clip) * glm::dvec4(0, 0, 1, 0);
  if (orthographic) {
    camera.eye /= glm::length(glm::dvec3(camera.eye));
    if ((to_eye * camera.eye).z > 0) camera.eye = -camera.eye;
    camera.eye.w = 0;
  } else {
    camera.eye /= camera.eye.w;
  }
  double side = 0;  // of a unit cube in eye space: to_world has what world_to_eye does not scale
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, glm::length(glm::dvec3(to_eye[axis])));
  camera.pixel_scale = 0.5 * side *
                       std::max(glm::length(glm::dvec3(to_clip[0][0], to_clip[1][0], to_clip[2][0])) * view.viewport.x,
                                glm::length(glm::dvec3(to_clip[0][1], to_clip[1][1], to_clip[2][1])) * view.viewport.y);
  return camera;
}

bool invert(const glm::mat4& m, glm::dmat3& inverse) {
  const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
  const glm::dvec3 yz = glm::cross(y, z);
  const double determinant = glm::dot(x, yz);
  const double per = 1.0 / determinant;
  // A number that is not finite makes the determinant, or the sum of the translation, another.
  if (!(std::abs(determinant) > 0.0) || !std::isfinite(determinant) || !std::isfinite(per) || !std::isfinite(m[3][0] + m[3][1] + m[3][2])) return false;
  inverse = glm::transpose(glm::dmat3(per * yz, per * glm::cross(z, x), per * glm::cross(x, y)));
  return true;
}

PlacedPart placePart(const Camera& camera, const runtime::Instance& instance, int part, std::span<const Knot> knots, const glm::ivec3& size) {
  PlacedPart placed;
  placed.bounds = deformedBounds(knots, size);
  placed.bounds.min -= kMargin;
  placed.bounds.max += kMargin;
  placed.to_world = runtime::partToWorld(instance, part);
  placed.to_clip = camera.world_to_clip * glm::dmat4(placed.to_world);
  glm::dmat3 to_part;
  if (!invert(placed.to_world, to_part)) return placed;
  glm::dvec3 eye = to_part * (glm::dvec3(camera.eye) - camera.eye.w * glm::dvec3(placed.to_world[3]));
  if (camera.eye.w == 0) eye = glm::normalize(eye);
  placed.eye = glm::dvec4(eye, camera.eye.w);

  // A linear function over a box is greatest where every term is: its value at the centre, and |term| times half a side for each.
  const glm::dvec3 centre = 0.5 * (glm::dvec3(placed.bounds.min) + glm::dvec3(placed.bounds.max));
  const glm::dvec3 half = glm::dvec3(placed.bounds.max) - centre;
  const glm::dvec4 at = placed.to_clip * glm::dvec4(centre, 1.0);
  const glm::dvec4 x = placed.to_clip[0] * half.x, y = placed.to_clip[1] * half.y, z = placed.to_clip[2] * half.z;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const double reach = std::abs(x.w + side * x[axis]) + std::abs(y.w + side * y[axis]) + std::abs(z.w + side * z[axis]);
      placed.outside = placed.outside || at.w + side * at[axis] + reach < 0.0;
    }
  }
  placed.nearest = at.w - (std::abs(x.w) + std::abs(y.w) + std::abs(z.w));
  placed.good = std::isfinite(placed.nearest);

  float side2 = 0;
  for (int axis = 0; axis < 3; ++axis) side2 = std::max(side2, glm::dot(glm::vec3(placed.to_world[axis]), glm::vec3(placed.to_world[axis])));
  placed.pixels = std::sqrt(static_cast<double>(side2)) * camera.pixel_scale / std::max(placed.nearest, 1e-30);
  return placed;
}

Detail chooseDetail(double pixels, float wanted, int finest, int levels) {
  Detail detail{std::min(finest, levels - 1), 0};
  if (!(wanted > 0)) return detail;
  const double between = std::log2(static_cast<double>(wanted) / pixels);
  if (!(between > detail.level)) return detail;
  const double whole = std::floor(between);
  if (whole >= levels - 1) return {levels - 1, 0};
  return {static_cast<int>(whole), static_cast<int>(64.0 * (between - whole))};
}

bool drawsCoarser(const Detail& detail, const glm::ivec2& pixel) {
  const int x = pixel.x ^ pixel.y;
  const int y = pixel.y;
  return ((x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 | (y & 4) >> 2) < detail.coarser;
}

}  // namespace kelp::gl
