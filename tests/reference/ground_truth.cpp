// SPDX-License-Identifier: MIT
#include "reference/ground_truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "walk.h"

namespace kelp::reference {
namespace {

using glm::dvec3;

// A cubic in power form, value(x) = k[0] + x (k[1] + x (k[2] + x k[3])).
struct Cubic {
  std::array<dvec3, 4> k{};
  dvec3 at(double x) const { return k[0] + x * (k[1] + x * (k[2] + x * k[3])); }
  // A box around the curve between two parameters.
  void hull(double x0, double x1, dvec3& low, dvec3& high) const {
    const double w = x1 - x0;
    const dvec3 p0 = at(x0);
    const dvec3 d1 = k[1] + x0 * (2.0 * k[2] + 3.0 * x0 * k[3]);
    const dvec3 d2 = 2.0 * k[2] + 6.0 * x0 * k[3];
    const dvec3 a = w * d1, b = 0.5 * w * w * d2, c = w * w * w * k[3];
    const std::array<dvec3, 4> bezier{p0, p0 + a / 3.0, p0 + 2.0 / 3.0 * a + b / 3.0, p0 + a + b + c};
    low = high = bezier[0];
    for (const dvec3& p : bezier) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
};

// S(t) of the segment between two knots, straight from the definition of Hermite splines.
Cubic hermite(const Segment& segment) {
  const dvec3 p0(segment.p0), p1(segment.p1), m0(segment.m0), m1(segment.m1);
  return {{p0, m0, -3.0 * p0 - 2.0 * m0 + 3.0 * p1 - m1, 2.0 * p0 + m0 - 2.0 * p1 + m1}};
}

// t in [0, 1] where the non-decreasing y of S reaches `y`: the lowest or the highest such t.
double parameterAt(const Cubic& s, double y, bool lowest) {
  double low = 0, high = 1;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    const double h = s.at(middle).y;
    if (lowest ? h < y : h <= y) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return lowest ? low : high;
}

}  // namespace

std::optional<Touch> firstTouch(const Volume& volume, std::span<const Knot> knots, const dvec3& o,
                                const dvec3& r, double s_min, double s_max, double erode) {
  const std::vector<Segment> segments = segmentsOf(knots, volume.size0);
  const double base = double{segments.front().p0.y};
  const double stretch = double{static_cast<double>(volume.size0.y)} / (double{segments.back().p1.y} - base);
  const dvec3 unit(volume.scale, volume.scale * stretch, volume.scale);
  std::optional<Touch> best;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Cubic spline = hermite(segments[i]);
    const double y0 = spline.at(0).y, y1 = spline.at(1).y;
    Cubic q;
    double x0, x1;
    if (r.y == 0.0) {  // a straight line in s, at one parameter of the spline
      if (o.y < y0 || o.y > y1) continue;
      const double t = parameterAt(spline, o.y, true);
      const dvec3 s = spline.at(t);
      q.k = {unit * dvec3(o.x - s.x, o.y - base, o.z - s.z), unit * r, dvec3(0), dvec3(0)};
      x0 = s_min;
      x1 = s_max;
      double x;
      glm::ivec3 voxel;
      if (Walk(volume, q, erode).first(x0, x1, x, voxel) && (!best || x < best->s))
        best = Touch{x, t, static_cast<int>(i), voxel, q.at(x)};
      continue;
    }
    // s(t) = (Sy(t) - o.y) / r.y; walked in the ray's direction, so with x = t or x = -t.
    const double h0 = std::clamp(o.y + s_min * r.y, std::min(y0, y1), std::max(y0, y1));
    const double h1 = std::clamp(o.y + s_max * r.y, std::min(y0, y1), std::max(y0, y1));
    if ((r.y > 0 && (o.y + s_max * r.y < y0 || o.y + s_min * r.y > y1)) ||
        (r.y < 0 && (o.y + s_min * r.y < y0 || o.y + s_max * r.y > y1)))
      continue;
    const double ta = parameterAt(spline, h0, r.y > 0);
    const double tb = parameterAt(spline, h1, r.y < 0);
    const double sign = r.y > 0 ? 1.0 : -1.0;
    Cubic in_t;
    for (std::size_t n = 0; n < 4; ++n) {
      const double s_n = (spline.k[n].y - (n == 0 ? o.y : 0.0)) / r.y;
      in_t.k[n] = unit * ((n == 0 ? dvec3(o.x, o.y - base, o.z) : dvec3(0)) + s_n * r -
                          dvec3(spline.k[n].x, 0.0, spline.k[n].z));
    }
    // The height is known without the detour through s.
    for (std::size_t n = 0; n < 4; ++n) in_t.k[n].y = unit.y * (spline.k[n].y - (n == 0 ? base : 0.0));
    q = in_t;
    q.k[1] *= sign;
    q.k[3] *= sign;
    double x;
    glm::ivec3 voxel;
    x0 = sign * ta;
    x1 = sign * tb;
    if (x0 <= x1 && Walk(volume, q, erode).first(x0, x1, x, voxel)) {
      const double t = sign * x;
      const double s = (spline.at(t).y - o.y) / r.y;
      if (!best || s < best->s) best = Touch{s, t, static_cast<int>(i), voxel, q.at(x)};
    }
  }
  return best;
}

}  // namespace kelp::reference
