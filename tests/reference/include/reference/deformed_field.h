// SPDX-License-Identifier: MIT
// Ground truth for normals, in double precision and independent of shaders/trace.glsl and of kelp's spline
// code: an implicit shape, the map that deforms it (straight from the definition of Hermite splines), and the
// gradient of the deformed field by finite differences, which knows nothing of how normals transform.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/formats/spline.h"
#include "reference/ground_truth.h"

namespace kelp::reference {

// Between part space (deformed) and the undeformed volume, both in voxels.
class SplineMap {
 public:
  SplineMap(std::span<const Knot> knots, const glm::ivec3& size) : segments_(segmentsOf(knots, size)) {
    low_ = segments_.front().p0.y;
    high_ = segments_.back().p1.y;
    stretch_ = double{static_cast<double>(size.y)} / (high_ - low_);
  }
  double low() const { return low_; }
  double high() const { return high_; }
  double stretch() const { return stretch_; }  // the volume's height over the spline's
  // How far a height is from the nearest knot's.
  double toKnot(double y) const {
    double nearest = std::abs(y - low_);
    for (const Segment& segment : segments_) nearest = std::min(nearest, std::abs(y - double{segment.p1.y}));
    return nearest;
  }

  // Where on the spline a height is.
  struct Place {
    int segment = 0;
    double t = 0;
    glm::dvec3 at{0};     // S(t)
    glm::dvec3 slope{0};  // S'(t)
  };
  Place placeOf(double y) const {
    Place place;
    const int last = static_cast<int>(segments_.size()) - 1;
    while (place.segment < last && y > double{segments_[static_cast<std::size_t>(place.segment)].p1.y})
      ++place.segment;
    double low = 0, high = 1;
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (spline(place.segment, middle).y < y ? low : high) = middle;
    }
    place.t = low;
    place.at = spline(place.segment, low);
    place.slope = slope(place.segment, low);
    return place;
  }

  glm::dvec3 toRest(const glm::dvec3& p) const {
    const glm::dvec3 s = placeOf(p.y).at;
    return {p.x - s.x, (p.y - low_) * stretch_, p.z - s.z};
  }
  glm::dvec3 toDeformed(const glm::dvec3& q) const {
    const double y = low_ + q.y / stretch_;
    const glm::dvec3 s = placeOf(y).at;
    return {q.x + s.x, y, q.z + s.z};
  }

 private:
  glm::dvec3 spline(int segment, double t) const {
    const Segment& s = segments_[static_cast<std::size_t>(segment)];
    const double u = 1 - t;
    return u * u * (1 + 2 * t) * glm::dvec3(s.p0) + t * u * u * glm::dvec3(s.m0) +
           t * t * (3 - 2 * t) * glm::dvec3(s.p1) - t * t * u * glm::dvec3(s.m1);
  }
  glm::dvec3 slope(int segment, double t) const {
    const Segment& s = segments_[static_cast<std::size_t>(segment)];
    const double u = 1 - t;
    return 6 * t * u * (glm::dvec3(s.p1) - glm::dvec3(s.p0)) + u * (1 - 3 * t) * glm::dvec3(s.m0) +
           t * (3 * t - 2) * glm::dvec3(s.m1);
  }

  std::vector<Segment> segments_;
  double low_ = 0, high_ = 0, stretch_ = 1;
};

using Field = std::function<double(const glm::dvec3&)>;  // negative inside

// The outward unit normal of the deformed field at p, part space: central differences of two widths,
// extrapolated. The width follows the distance to the nearest knot, where the map may have a corner of
// infinite slope; nearer than kRoom there is none to speak of.
inline constexpr double kRoom = 1e-3;  // voxels
inline glm::dvec3 differenceNormal(const Field& field, const SplineMap& map, const glm::dvec3& p) {
  const double width = 1e-3 * std::min(1.0, map.toKnot(p.y));
  glm::dvec3 gradient(0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto difference = [&](double h) {
      glm::dvec3 step(0);
      step[axis] = h;
      return (field(map.toRest(p + step)) - field(map.toRest(p - step))) / (2 * h);
    };
    gradient[axis] = (4 * difference(0.5 * width) - difference(width)) / 3;
  }
  return glm::normalize(gradient);
}

// A shape with points on its surface, spread evenly enough. All shapes stay inside the volume.
struct Shape {
  const char* name;
  Field field;
  std::function<glm::dvec3(std::mt19937&)> surfacePoint;
  std::function<glm::dvec3(const glm::dvec3&)> normal;  // analytic, at a surface point
};

inline std::vector<Shape> shapesIn(const glm::ivec3& size) {
  const glm::dvec3 center = 0.5 * glm::dvec3(size);
  const double least = std::min({size.x, size.y, size.z});
  const auto direction = [](std::mt19937& random) {
    std::normal_distribution<double> n;
    return glm::normalize(glm::dvec3(n(random), n(random), n(random)));
  };
  const double radius = 0.45 * least;
  Shape sphere{"sphere", [=](const glm::dvec3& q) { return glm::distance(q, center) - radius; },
               [=](std::mt19937& random) { return center + radius * direction(random); },
               [=](const glm::dvec3& q) { return glm::normalize(q - center); }};

  // A torus that leans, so that it is symmetric to no axis of the map.
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.4, 1, -0.3));
  const glm::dvec3 across = glm::normalize(glm::cross(axis, glm::dvec3(1, 0, 0))),
                   beside = glm::cross(axis, across);
  const double ring = 0.3 * least, tube = 0.12 * least;
  const auto onRing = [=](const glm::dvec3& q) {
    const glm::dvec3 d = q - center - glm::dot(q - center, axis) * axis;
    return center + ring * glm::normalize(d);
  };
  Shape torus{"torus", [=](const glm::dvec3& q) { return glm::distance(q, onRing(q)) - tube; },
              [=](std::mt19937& random) {
                std::uniform_real_distribution<double> turn(0, 6.283185307179586), unit(0, 1);
                double b = turn(random);
                // evenly in area
                while (unit(random) * (ring + tube) > ring + tube * std::cos(b)) b = turn(random);
                const double a = turn(random);
                const glm::dvec3 out = std::cos(a) * across + std::sin(a) * beside;
                return center + (ring + tube * std::cos(b)) * out + tube * std::sin(b) * axis;
              },
              [=](const glm::dvec3& q) { return glm::normalize(q - onRing(q)); }};

  // Touches all six faces of the box, so that it has normals up to the ends of the map.
  const glm::dvec3 half = 0.499 * glm::dvec3(size);
  Shape ellipsoid{"ellipsoid", [=](const glm::dvec3& q) { return glm::length((q - center) / half) - 1; },
                  [=](std::mt19937& random) { return center + half * direction(random); },
                  [=](const glm::dvec3& q) { return glm::normalize((q - center) / (half * half)); }};
  return {sphere, torus, ellipsoid};
}

// Degrees between two vectors of any length; 90 for a zero vector, which says nothing. Exact for small angles
// too.
inline double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
  if (!(glm::dot(a, a) > 0) || !(glm::dot(b, b) > 0)) return 90;
  const glm::dvec3 u = glm::normalize(a), v = glm::normalize(b);
  return glm::degrees(2 * std::atan2(glm::length(u - v), glm::length(u + v)));
}

// Mean, 99th percentile and maximum.
struct Spread {
  double mean = 0, p99 = 0, worst = 0;
};
inline Spread spreadOf(std::vector<double> values) {
  Spread spread;
  if (values.empty()) return spread;
  for (const double v : values) spread.mean += v / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  spread.p99 = values[std::min(values.size() - 1, values.size() * 99 / 100)];
  spread.worst = values.back();
  return spread;
}

}  // namespace kelp::reference
