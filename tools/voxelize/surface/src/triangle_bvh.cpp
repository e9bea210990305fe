// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/triangle_bvh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kelp::bake {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

glm::dvec3 onSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, double& s) {
  const glm::dvec3 ab = b - a;
  const double length = glm::dot(ab, ab);
  s = length > 0 ? std::clamp(glm::dot(p - a, ab) / length, 0.0, 1.0) : 0.0;
  return a + s * ab;
}

// Corners that lie on a line have no barycentric coordinates of their own: the nearest of the three sides
// answers.
glm::dvec3 nearestOnSides(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                          glm::dvec3& weights) {
  const glm::dvec3 corner[3] = {a, b, c};
  glm::dvec3 best(0);
  double best_squared = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    double s = 0;
    const glm::dvec3 q = onSegment(p, corner[k], corner[(k + 1) % 3], s);
    const double squared = glm::dot(p - q, p - q);
    if (squared < best_squared) {
      best_squared = squared;
      best = q;
      weights = glm::dvec3(0);
      weights[k] = 1 - s;
      weights[(k + 1) % 3] = s;
    }
  }
  return best;
}

}  // namespace

glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                             const glm::dvec3& c, glm::dvec3& weights) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) {
    weights = {1, 0, 0};
    return a;
  }
  const glm::dvec3 bp = p - b;
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) {
    weights = {0, 1, 0};
    return b;
  }
  const glm::dvec3 cp = p - c;
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) {
    weights = {0, 0, 1};
    return c;
  }
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (va <= 0 || vb <= 0 || vc <= 0 || !(va + vb + vc > 0)) return nearestOnSides(p, a, b, c, weights);
  const double v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  weights = {1 - v - w, v, w};
  return a + ab * v + ac * w;
}

TriangleBvh::TriangleBvh(const Topology& mesh) {
  const std::size_t count = mesh.triangles.size();
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<glm::vec3> centre(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& v = mesh.triangles[i].vertex;
    centre[i] = glm::vec3((mesh.position(v[0]) + mesh.position(v[1]) + mesh.position(v[2])) / 3.0);
  }
  // Halves by number of triangles along the widest spread of their centres: any soup, in any order, gives a
  // balanced tree.
  struct Task {
    std::uint32_t node, begin, end;
  };
  nodes_.emplace_back();
  std::vector<Task> tasks{{0, 0, static_cast<std::uint32_t>(count)}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    glm::vec3 low(1e30f), high(-1e30f), centre_low(1e30f), centre_high(-1e30f);
    for (std::uint32_t i = task.begin; i < task.end; ++i) {
      for (const std::uint32_t vertex : mesh.triangles[order_[i]].vertex) {
        const glm::vec3 p(mesh.position(vertex));
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
      centre_low = glm::min(centre_low, centre[order_[i]]);
      centre_high = glm::max(centre_high, centre[order_[i]]);
    }
    Node& node = nodes_[task.node];
    // Lattice positions fit a float's 24 bits only up to 1024 voxels: widen by more than the rounding.
    const glm::vec3 slack(0.001f);
    node.low = low - slack;
    node.high = high + slack;
    const std::uint32_t size = task.end - task.begin;
    if (size <= kLeafTriangles) {
      node.first = task.begin;
      node.count = size;
      continue;
    }
    const glm::vec3 spread = centre_high - centre_low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : (spread.y >= spread.z ? 1 : 2);
    const std::uint32_t middle = task.begin + size / 2;
    std::nth_element(order_.begin() + task.begin, order_.begin() + middle, order_.begin() + task.end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return centre[a][axis] != centre[b][axis] ? centre[a][axis] < centre[b][axis] : a < b;
                     });
    const std::uint32_t children = static_cast<std::uint32_t>(nodes_.size());
    node.first = children;
    node.count = 0;
    nodes_.emplace_back();
    nodes_.emplace_back();
    tasks.push_back({children, task.begin, middle});
    tasks.push_back({children + 1, middle, task.end});
  }
  corners_.reserve(count);
  for (const std::uint32_t i : order_) {
    const auto& v = mesh.triangles[i].vertex;
    corners_.push_back({mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])});
  }
}

}  // namespace kelp::bake
