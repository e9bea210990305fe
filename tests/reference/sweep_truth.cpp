// SPDX-License-Identifier: MIT
#include "reference/sweep_truth.h"

#include <algorithm>
#include <cmath>

#include "walk.h"

namespace kelp::reference {
namespace {

using glm::dot;
using glm::dvec3;

// The plane's axes from the floats of an arc, made exactly perpendicular.
struct Axes {
  dvec3 t, n, b;
  explicit Axes(const Arc& arc) : t(glm::normalize(dvec3(arc.along))) {
    n = glm::normalize(dvec3(arc.inward) - dot(dvec3(arc.inward), t) * t);
    b = glm::cross(n, t);
  }
};

// A straight ray as a curve in the rest space of one slice.
struct SliceCurve {
  const Arc& arc;
  const glm::ivec3& size;
  double scale;
  dvec3 o, r;

  dvec3 at(double s) const { return scale * unswept(arc, size, o + s * r); }
  // x and z change by no more than the ray's length, y by no more than rise / (1 - k u) times it.
  void hull(double s0, double s1, dvec3& low, dvec3& high) const {
    const double s = 0.5 * (s0 + s1), half = 0.5 * (s1 - s0), k = arc.curvature;
    const dvec3 e = o + s * r - dvec3(arc.middle), middle = at(s);
    const Axes axes(arc);
    const double room = std::hypot(1 - k * dot(e, axes.n), k * dot(e, axes.t)) - k * half;
    const double y = room > 0 ? half * double{arc.rise} / room : 1e9;
    const dvec3 reach = scale * dvec3(half, y, half);
    low = middle - reach;
    high = middle + reach;
  }
};

}  // namespace

dvec3 unswept(const Arc& arc, const glm::ivec3& size, const dvec3& point) {
  const Axes axes(arc);
  const dvec3 e = point - dvec3(arc.middle);
  const double p = dot(e, axes.n), l = dot(e, axes.t), v = dot(e, axes.b), k = arc.curvature;
  double u = p, a = l;
  if (k > 0) {
    // From the axis of curvature: the distance, and the angle.
    const double to_axis = 1 - k * p, g = std::hypot(to_axis, k * l);
    u = (2 * p - k * (p * p + l * l)) / (1 + g);
    a = std::atan2(k * l, to_axis) / k;
  }
  const double c = arc.bend.x, s = arc.bend.y, norm = std::hypot(c, s);
  return {0.5 * size.x + (c * u - s * v) / norm, double{arc.y} + a * double{arc.rise},
          0.5 * size.z + (s * u + c * v) / norm};
}

dvec3 swept(const Arc& arc, const glm::ivec3& size, const dvec3& rest) {
  const Axes axes(arc);
  const double c = arc.bend.x, s = arc.bend.y, norm = std::hypot(c, s), k = arc.curvature;
  const double x = rest.x - 0.5 * size.x, z = rest.z - 0.5 * size.z;
  const double u = (c * x + s * z) / norm, v = (c * z - s * x) / norm;
  const double a = (rest.y - double{arc.y}) / double{arc.rise};
  const dvec3 middle(arc.middle);
  if (!(k > 0)) return middle + a * axes.t + u * axes.n + v * axes.b;
  const double radius = 1 / k - u;
  return middle + axes.n / k + radius * (std::sin(k * a) * axes.t - std::cos(k * a) * axes.n) + v * axes.b;
}

std::optional<Touch> firstTouch(const Volume& volume, const ArcChain& chain, const dvec3& o, const dvec3& r,
                                double s_min, double s_max, double erode) {
  std::optional<Touch> best;
  for (int i = 0; i < chain.count; ++i) {
    const Arc& arc = chain.arcs[i];
    double s0 = s_min, s1 = best ? best->s : s_max;
    // Voxels that are taken larger may be touched beside the slice.
    const double slack = std::max(-erode, 0.0);
    const auto keep = [&](const glm::vec4& plane, double side) {
      const double value = side * (dot(dvec3(plane), o) + double{plane.w}) + slack,
                   slope = side * dot(dvec3(plane), r);
      if (slope > 0) s0 = std::max(s0, -value / slope);
      if (slope < 0) s1 = std::min(s1, -value / slope);
      if (slope == 0 && value < 0) s1 = s0 - 1;
    };
    keep(chain.joints[i].plane, 1);
    keep(chain.joints[i + 1].plane, -1);
    // And the ball around the slice.
    const dvec3 e = o - dvec3(arc.middle);
    const double middle = -dot(e, r), off2 = dot(e, e) - middle * middle, radius = double{arc.radius} + 1;
    if (off2 > radius * radius) continue;
    s0 = std::max(s0, middle - std::sqrt(radius * radius - off2));
    s1 = std::min(s1, middle + std::sqrt(radius * radius - off2));
    if (!(s0 <= s1)) continue;
    const SliceCurve curve{arc, volume.size0, volume.scale, o, r};
    double s;
    glm::ivec3 voxel;
    if (Walk(volume, curve, erode).first(s0, s1, s, voxel) && (!best || s < best->s))
      best = Touch{s, 0, i, voxel, curve.at(s)};
  }
  return best;
}

Truth truthOf(const Volume& volume, const ArcChain& chain, const dvec3& o, const dvec3& r, double s_max) {
  Truth truth;
  const auto possible = firstTouch(volume, chain, o, r, 0, s_max, -kMargin);
  if (!possible) return truth;
  truth.possible = possible->s;
  if (const auto owed = firstTouch(volume, chain, o, r, std::max(possible->s - 1e-3, 0.0), s_max, kMargin))
    truth.owed = owed->s;
  return truth;
}

}  // namespace kelp::reference
