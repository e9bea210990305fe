// SPDX-License-Identifier: MIT
#include "rigid.h"

#include <algorithm>
#include <cmath>

namespace kelp::bake {
namespace {

using Symmetric = std::array<std::array<double, 4>, 4>;

// The eigenvector of the greatest eigenvalue, by Jacobi's rotations.
std::array<double, 4> greatestEigenvector(Symmetric a) {
  Symmetric v{};
  for (std::size_t i = 0; i < 4; ++i) v[i][i] = 1;
  constexpr int kSweeps = 16;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double off = 0, on = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      on += a[i][i] * a[i][i];
      for (std::size_t j = i + 1; j < 4; ++j) off += a[i][j] * a[i][j];
    }
    if (off <= 1e-30 * on) break;
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 4; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = v[k][p], vq = v[k][q];
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (a[i][i] > a[best][best]) best = i;
  return {v[0][best], v[1][best], v[2][best], v[3][best]};
}

}  // namespace

glm::dmat3 rotationOf(const glm::dquat& q) {
  const double s = 2 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {{1 - s * (q.y * q.y + q.z * q.z), s * (q.x * q.y + q.w * q.z), s * (q.x * q.z - q.w * q.y)},
          {s * (q.x * q.y - q.w * q.z), 1 - s * (q.x * q.x + q.z * q.z), s * (q.y * q.z + q.w * q.x)},
          {s * (q.x * q.z + q.w * q.y), s * (q.y * q.z - q.w * q.x), 1 - s * (q.x * q.x + q.y * q.y)}};
}

namespace {

glm::dquat hornQuaternion(const glm::dmat3& h) {
  // s[a][b]: the sum of x_a y_b; column a of h.
  const glm::dmat3& s = h;
  const Symmetric n{{{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
                     {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
                     {s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
                     {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]}}};
  const std::array<double, 4> q = greatestEigenvector(n);
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

glm::dmat3 nearestRotation(const glm::dmat3& h) { return rotationOf(hornQuaternion(h)); }

glm::dquat quaternionOf(const glm::dmat3& rotation) {
  const glm::dquat q = hornQuaternion(rotation);
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

namespace {

// Which axes are mirrored, 1 or -1: those with which they are nearest to `last`; absent: none, or x.
glm::dvec3 mirroredAxes(const glm::dmat3& k, const glm::dvec3& lengths, const glm::dmat3* last) {
  const bool mirrored = glm::determinant(k) < 0;
  glm::dvec3 signs(mirrored ? -1 : 1, 1, 1);
  if (!last) return signs;
  int least = 0;
  glm::dvec3 like(0);
  for (int axis = 0; axis < 3; ++axis) {
    if (lengths[axis] > 0) like[axis] = glm::dot(k[axis], (*last)[axis]) / lengths[axis];
    signs[axis] = like[axis] < 0 ? -1 : 1;
    if (std::abs(like[axis]) < std::abs(like[least])) least = axis;
  }
  if ((signs.x * signs.y * signs.z < 0) != mirrored) signs[least] = -signs[least];
  return signs;
}

// The rotation whose axes these are. They are at right angles to float precision.
bool makeRotation(const glm::dmat3& axes, glm::dmat3& rotation) {
  constexpr double kSquare = 1e-4;
  if (std::abs(glm::dot(axes[0], axes[1])) > kSquare || std::abs(glm::dot(axes[1], axes[2])) > kSquare ||
      std::abs(glm::dot(axes[2], axes[0])) > kSquare)
    return false;
  rotation = axes;
  for (int round = 0; round < 2; ++round)  // Newton's iteration for the nearest rotation
    rotation = 0.5 * (rotation + glm::transpose(glm::inverse(rotation)));
  return true;
}

}  // namespace

Trs nearestTrs(const glm::dmat4x3& m, const std::optional<glm::dquat>& before) {
  const glm::dquat near = before.value_or(glm::dquat(1, 0, 0, 0));
  const glm::dmat3 k = linearOf(m), last = rotationOf(near);
  const glm::dvec3 lengths(glm::length(k[0]), glm::length(k[1]), glm::length(k[2]));
  const double longest = std::max({lengths.x, lengths.y, lengths.z});
  Trs out{m[3], near, glm::dvec3(0)};
  if (!(longest > 0)) return out;
  const glm::dvec3 signs = mirroredAxes(k, lengths, before ? &last : nullptr);
  // An axis without length counts little, and keeps its direction.
  constexpr double kLittle = 1e-7;
  glm::dmat3 axes, h, best;
  bool regular = true;
  for (int axis = 0; axis < 3; ++axis) {
    const bool flat = lengths[axis] <= kLittle * longest;
    regular = regular && !flat;
    h[axis] = signs[axis] / longest * k[axis] + (flat ? kLittle : 0) * last[axis];
    if (!flat) axes[axis] = signs[axis] / lengths[axis] * k[axis];
  }
  const bool square = regular && makeRotation(axes, best);
  if (!square) best = nearestRotation(h);
  for (int axis = 0; axis < 3; ++axis) out.scale[axis] = glm::dot(best[axis], k[axis]);
  // With shear the rotation and the scale that fit best depend on each other.
  for (int round = 0; round < 8 && !square; ++round) {
    for (int axis = 0; axis < 3; ++axis)
      h[axis] = out.scale[axis] / (longest * longest) * k[axis] + 1e-12 * best[axis];
    best = nearestRotation(h);
    double moved = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double scale = glm::dot(best[axis], k[axis]);
      moved = std::max(moved, std::abs(scale - out.scale[axis]));
      out.scale[axis] = scale;
    }
    if (moved <= 1e-12 * longest) break;
  }
  out.rotation = glm::normalize(glm::quat_cast(best));
  if (glm::dot(out.rotation, near) < 0) out.rotation = -out.rotation;
  return out;
}

glm::dquat slerpShort(const glm::dquat& a, glm::dquat b, double share) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) {
    b = glm::dquat(-b.w, -b.x, -b.y, -b.z);
    cosine = -cosine;
  }
  double of_a = 1 - share, of_b = share;
  if (cosine < 1 - 1e-7) {
    const double angle = std::acos(cosine), sine = std::sin(angle);
    of_a = std::sin(of_a * angle) / sine;
    of_b = std::sin(of_b * angle) / sine;
  }
  const glm::dquat q(of_a * a.w + of_b * b.w, of_a * a.x + of_b * b.x, of_a * a.y + of_b * b.y,
                     of_a * a.z + of_b * b.z);
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

}  // namespace kelp::bake
