// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/winding.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <unordered_set>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr double kFullTurn = 4 * 3.14159265358979323846;
// On a flat cap the solid angle is one half of all around, but for rounding: that is no reason to doubt it.
constexpr double kDoubtful = 0.502;

// The solid angle of many triangles at a point. Those far away count as one dipole.
// Source: Barill, Dickson, Schmidt, Levin, Jacobson, "Fast Winding Numbers for Soups and Clouds", 2018.
// Deviation: the first term of the series alone, at a distance that makes up for it.
class CapTree {
 public:
  CapTree(const Topology& mesh, std::span<const SolidTriangle> caps) {
    for (const SolidTriangle& cap : caps)
      triangles_.push_back(
          {mesh.position(cap.vertex[0]), mesh.position(cap.vertex[1]), mesh.position(cap.vertex[2])});
    nodes_.reserve(2 * triangles_.size());
    nodes_.emplace_back();
    build(0, 0, triangles_.size());
  }

  // In full turns: 1 for what surrounds p and faces outward.
  double angle(const glm::dvec3& p) const {
    // Rough is enough nearly everywhere.
    const double rough = sum(0, p, kRough) / kFullTurn;
    return std::abs(std::abs(rough) - 0.5) > 0.05 ? rough : sum(0, p, kFine) / kFullTurn;
  }

 private:
  static constexpr double kRough = 2.5, kFine = 8;  // radii of a node away, from where on it is a dipole
  static constexpr std::size_t kLeaf = 4;

  struct Triangle {
    glm::dvec3 a, b, c;
    glm::dvec3 centre() const { return (a + b + c) / 3.0; }
    glm::dvec3 areaVector() const { return 0.5 * glm::cross(b - a, c - a); }
  };
  struct Node {
    glm::dvec3 centre{0}, area{0};
    double radius = 0;
    std::size_t begin = 0, end = 0;  // triangles
    std::size_t children = 0;        // two adjacent ones; 0: a leaf
  };

  void build(std::size_t index, std::size_t begin, std::size_t end) {
    Node node;
    node.begin = begin;
    node.end = end;
    glm::dvec3 low(1e30), high(-1e30);
    double weight = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 centre = triangles_[i].centre(), area = triangles_[i].areaVector();
      const double size = glm::length(area) + 1e-12;
      node.area += area;
      node.centre += size * centre;
      weight += size;
      low = glm::min(low, centre);
      high = glm::max(high, centre);
    }
    node.centre /= weight;
    for (std::size_t i = begin; i < end; ++i) {
      for (const glm::dvec3& p : {triangles_[i].a, triangles_[i].b, triangles_[i].c})
        node.radius = std::max(node.radius, glm::distance(p, node.centre));
    }
    if (end - begin > kLeaf) {
      const glm::dvec3 extent = high - low;
      const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
      const std::size_t middle = (begin + end) / 2;
      const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(begin), at(middle), at(end), [&](const Triangle& s, const Triangle& t) {
        return s.centre()[axis] < t.centre()[axis];
      });
      node.children = nodes_.size();
      nodes_.resize(nodes_.size() + 2);
      build(node.children, begin, middle);
      build(node.children + 1, middle, end);
    }
    nodes_[index] = node;
  }

  // By the formula of Van Oosterom and Strackee.
  static double solidAngle(const Triangle& t, const glm::dvec3& p) {
    const glm::dvec3 a = t.a - p, b = t.b - p, c = t.c - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }

  double sum(std::size_t index, const glm::dvec3& p, double far) const {
    const Node& node = nodes_[index];
    const glm::dvec3 away = node.centre - p;
    const double squared = glm::dot(away, away);
    if (squared > far * far * node.radius * node.radius)
      return glm::dot(node.area, away) / (squared * std::sqrt(squared));
    if (node.children > 0) return sum(node.children, p, far) + sum(node.children + 1, p, far);
    double angle = 0;
    for (std::size_t i = node.begin; i < node.end; ++i) angle += solidAngle(triangles_[i], p);
    return angle;
  }

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

// The voxels that a triangle passes through, but for corners that it cuts off.
template <class Visit>
void forEachPassed(const Topology& mesh, const SolidTriangle& t, const Visit& visit) {
  constexpr double kStep = 0.7;
  const glm::dvec3 a = mesh.position(t.vertex[0]), b = mesh.position(t.vertex[1]),
                   c = mesh.position(t.vertex[2]);
  const auto stepsOf = [](double length) { return static_cast<std::int64_t>(std::ceil(length / kStep)) + 1; };
  const auto shareOf = [](std::int64_t step, std::int64_t steps) {
    return static_cast<double>(step) / static_cast<double>(steps);
  };
  const std::int64_t rows = stepsOf(std::max(glm::distance(a, c), glm::distance(b, c)));
  for (std::int64_t row = 0; row <= rows; ++row) {
    const glm::dvec3 from = glm::mix(a, c, shareOf(row, rows)), to = glm::mix(b, c, shareOf(row, rows));
    const std::int64_t steps = stepsOf(glm::distance(from, to));
    for (std::int64_t step = 0; step <= steps; ++step)
      visit(glm::ivec3(glm::floor(glm::mix(from, to, shareOf(step, steps)))));
  }
}

class DoubtFinder {
 public:
  DoubtFinder(const Topology& mesh, const glm::ivec3& size, int threads)
      : mesh_(mesh), size_(size), threads_(threads) {}

  // The solid angle of caps is a harmonic function away from them: wherever it is beyond one half, that
  // region reaches a cap. So looking starts at the caps, and goes on where there is doubt.
  void find(std::span<const SolidTriangle> caps, std::vector<Doubt>& doubts) {
    const CapTree tree(mesh_, caps);
    seen_ = {};  // clear() would pass over the buckets of the largest one each time
    std::vector<std::uint64_t> front, next;
    for (const SolidTriangle& cap : caps)
      forEachPassed(mesh_, cap, [&](const glm::ivec3& voxel) { add(voxel, front); });
    // A cap may pass before or behind its voxels' centres.
    for (std::size_t i = 0, count = front.size(); i < count; ++i) addAround(front[i], front);
    std::vector<double> angle;
    while (!front.empty()) {
      angle.resize(front.size());
      parallelRanges(front.size(), 256, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          angle[i] = tree.angle(glm::dvec3(voxelAt(size_, front[i])) + 0.5);
      });
      next.clear();
      for (std::size_t i = 0; i < front.size(); ++i) {
        if (std::abs(angle[i]) <= kDoubtful) continue;
        doubts.push_back({front[i], caps[0].component, angle[i]});
        addAround(front[i], next);
      }
      front.swap(next);
    }
  }

 private:
  void add(const glm::ivec3& v, std::vector<std::uint64_t>& list) {
    if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= size_.x || v.y >= size_.y || v.z >= size_.z) return;
    const std::uint64_t index = denseIndex(size_, v);
    if (seen_.insert(index).second) list.push_back(index);
  }
  void addAround(std::uint64_t index, std::vector<std::uint64_t>& list) {
    const glm::ivec3 voxel = voxelAt(size_, index);
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        glm::ivec3 neighbour = voxel;
        neighbour[axis] += side;
        add(neighbour, list);
      }
    }
  }

  const Topology& mesh_;
  glm::ivec3 size_;
  int threads_;
  std::unordered_set<std::uint64_t> seen_;
};

}  // namespace

std::vector<Doubt> findDoubts(const Topology& mesh, const glm::ivec3& size, int threads) {
  std::vector<Doubt> doubts;
  DoubtFinder finder(mesh, size, threads);
  // Caps are the last triangles, component by component.
  const std::span<const SolidTriangle> caps = std::span(mesh.triangles).last(mesh.caps);
  for (std::size_t begin = 0; begin < caps.size();) {
    std::size_t end = begin + 1;
    while (end < caps.size() && caps[end].component == caps[begin].component) ++end;
    finder.find(caps.subspan(begin, end - begin), doubts);
    begin = end;
  }
  std::sort(doubts.begin(), doubts.end(), [](const Doubt& a, const Doubt& b) {
    return std::tie(a.voxel, a.component) < std::tie(b.voxel, b.component);
  });
  return doubts;
}

}  // namespace kelp::bake
