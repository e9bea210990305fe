// SPDX-License-Identifier: MIT
#include "reference/ground_truth.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kelp::reference {
namespace {

using glm::dvec3;

// A cubic in power form, value(x) = k[0] + x (k[1] + x (k[2] + x k[3])).
struct Cubic {
  std::array<dvec3, 4> k{};
  dvec3 at(double x) const { return k[0] + x * (k[1] + x * (k[2] + x * k[3])); }
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

// Walks a curve q(x), x in [x0, x1], in order and stops at the first point inside the solid shrunk by `erode`
// (negative: grown).
class Walk {
 public:
  Walk(const Volume& volume, const Cubic& q, double erode)
      : volume_(volume), q_(q), erode_(erode), extent_(volume.scale * dvec3(volume.size0)) {}

  // Sets x and voxel and answers true at the first touch.
  bool first(double x0, double x1, double& x, glm::ivec3& voxel) const {
    dvec3 low, high;
    hull(x0, x1, low, high);
    const dvec3 side = high - low;
    const double longest = std::max({side.x, side.y, side.z});
    const double grow = std::max(-erode_, 0.0);
    if (!meetsVolume(low - grow, high + grow)) return false;
    if (longest <= 3.0) {
      if (!anySolid(low - grow, high + grow, voxel)) return false;
      if (erode_ > 0) {
        if (allSolid(low - erode_, high + erode_)) {
          x = x0;
          return true;
        }
        // The box that the surroundings of every point of the hull have in common: is there something empty
        // in it?
        const dvec3 core_low = high - erode_, core_high = low + erode_;
        if (core_low.x <= core_high.x && core_low.y <= core_high.y && core_low.z <= core_high.z &&
            !allSolid(core_low, core_high))
          return false;
      }
    }
    const double middle = 0.5 * (x0 + x1);
    if (longest < 1e-6 || middle <= x0 || middle >= x1) {
      x = x0;
      return erode_ <= 0 || allSolid(q_.at(x0) - erode_, q_.at(x0) + erode_);
    }
    return first(x0, middle, x, voxel) || first(middle, x1, x, voxel);
  }

 private:
  void hull(double x0, double x1, dvec3& low, dvec3& high) const {
    const double w = x1 - x0;
    const dvec3 p0 = q_.at(x0);
    const dvec3 d1 = q_.k[1] + x0 * (2.0 * q_.k[2] + 3.0 * x0 * q_.k[3]);
    const dvec3 d2 = 2.0 * q_.k[2] + 6.0 * x0 * q_.k[3];
    const dvec3 a = w * d1, b = 0.5 * w * w * d2, c = w * w * w * q_.k[3];
    const std::array<dvec3, 4> bezier{p0, p0 + a / 3.0, p0 + 2.0 / 3.0 * a + b / 3.0, p0 + a + b + c};
    low = high = bezier[0];
    for (const dvec3& p : bezier) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }

  bool meetsVolume(const dvec3& low, const dvec3& high) const {
    return low.x <= extent_.x && low.y <= extent_.y && low.z <= extent_.z && high.x >= 0 && high.y >= 0 &&
           high.z >= 0;
  }

  // Voxels whose closed cubes meet the box; those of a coarse level end where the volume does.
  void voxelsOf(const dvec3& low, const dvec3& high, glm::ivec3& from, glm::ivec3& to) const {
    for (int a = 0; a < 3; ++a) {
      from[a] = std::max(static_cast<int>(std::ceil(low[a])) - 1, 0);
      to[a] = std::min(static_cast<int>(std::floor(high[a])), volume_.size[a] - 1);
    }
  }

  bool isSolid(int x, int y, int z) const {
    const bool tiled = volume_.tile.x > 0;
    const glm::ivec3 v = tiled ? glm::ivec3(x, y, z) % volume_.tile : glm::ivec3(x, y, z);
    const glm::ivec3& size = tiled ? volume_.tile : volume_.size;
    return volume_.solid[static_cast<std::size_t>(v.x) +
                         static_cast<std::size_t>(size.x) *
                             (static_cast<std::size_t>(v.y) +
                              static_cast<std::size_t>(size.y) * static_cast<std::size_t>(v.z))] != 0;
  }

  bool anySolid(const dvec3& low, const dvec3& high, glm::ivec3& voxel) const {
    glm::ivec3 from, to;
    voxelsOf(low, high, from, to);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          if (!isSolid(x, y, z)) continue;
          voxel = {x, y, z};
          return true;
        }
      }
    }
    return false;
  }

  // Whether the whole box is inside the union of the solid voxels. What is outside the volume is empty.
  bool allSolid(const dvec3& low, const dvec3& high) const {
    if (low.x < 0 || low.y < 0 || low.z < 0 || high.x > extent_.x || high.y > extent_.y || high.z > extent_.z)
      return false;
    glm::ivec3 from, to;
    voxelsOf(low, high, from, to);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          if (!isSolid(x, y, z)) return false;
        }
      }
    }
    return true;
  }

  const Volume& volume_;
  const Cubic& q_;
  double erode_;
  dvec3 extent_;
};

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
