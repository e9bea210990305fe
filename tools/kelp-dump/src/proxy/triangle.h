// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace kelp::dump {

struct Triangle {
  glm::dvec3 a, b, c;

  glm::dvec3 middle() const { return (a + b + c) / 3.0; }
  glm::dvec3 twiceArea() const { return glm::cross(b - a, c - a); }
  // The distance from middle() to the farthest corner.
  double radius() const {
    const glm::dvec3 m = middle();
    return std::max({glm::distance(m, a), glm::distance(m, b), glm::distance(m, c)});
  }
  // Two triangles, cut at the middle of the longest edge.
  void split(Triangle& one, Triangle& two) const {
    const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
    const Triangle turned = ab >= bc && ab >= ca ? *this : bc >= ca ? Triangle{b, c, a} : Triangle{c, a, b};
    const glm::dvec3 cut = (turned.a + turned.b) * 0.5;
    one = {turned.a, cut, turned.c};
    two = {cut, turned.b, turned.c};
  }
};

// Christer Ericson, Real-Time Collision Detection, section 5.1.5. Degenerate triangles are handled as the
// edges that they are.
inline double squaredDistance(const glm::dvec3& p, const Triangle& t) {
  const auto toEdge = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    const double length = glm::dot(along, along);
    const double at = length > 0 ? glm::clamp(glm::dot(p - from, along) / length, 0.0, 1.0) : 0.0;
    const glm::dvec3 apart = p - (from + at * along);
    return glm::dot(apart, apart);
  };
  const glm::dvec3 normal = t.twiceArea();
  const double area = glm::dot(normal, normal);
  if (area > 0) {
    const double u = glm::dot(glm::cross(t.c - t.b, p - t.b), normal);
    const double v = glm::dot(glm::cross(t.a - t.c, p - t.c), normal);
    const double w = glm::dot(glm::cross(t.b - t.a, p - t.a), normal);
    if (u >= 0 && v >= 0 && w >= 0) {
      const double height = glm::dot(p - t.a, normal);
      return height * height / area;
    }
  }
  return std::min({toEdge(t.a, t.b), toEdge(t.b, t.c), toEdge(t.c, t.a)});
}

}  // namespace kelp::dump
