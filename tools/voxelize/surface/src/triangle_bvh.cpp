// SPDX-License-Identifier: MIT
#include "kelp/voxelize/surface/triangle_bvh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

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

bool TriangleBvh::meets(const Corners& triangle, const glm::dvec3& p, int axis, Nearest& hit) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  // Twice the areas of the three triangles that p makes with the sides, as seen along the axis.
  const auto area = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return (a[u] - p[u]) * (b[v] - p[v]) - (a[v] - p[v]) * (b[u] - p[u]);
  };
  const double a = area(triangle.b, triangle.c), b = area(triangle.c, triangle.a),
               c = area(triangle.a, triangle.b), sum = a + b + c;
  if (sum == 0 || (sum > 0 ? std::min({a, b, c}) < 0 : std::max({a, b, c}) > 0)) return false;
  hit.point = p;
  hit.point[axis] = (a * triangle.a[axis] + b * triangle.b[axis] + c * triangle.c[axis]) / sum;
  hit.weights = glm::dvec3(a, b, c) / sum;
  return true;
}

// Halves by number of triangles along the widest spread of their centers, twice for a node: any soup, in any
// order, gives a balanced tree. What lies below the upper nodes grows on all threads.
class TriangleBvh::Builder {
 public:
  Builder(const Topology& mesh, TriangleBvh& bvh) : mesh_(mesh), bvh_(bvh), items_(mesh.triangles.size()) {
    double farthest = 0;
    for (const glm::i64vec3& vertex : mesh.lattice) {
      const glm::i64vec3 size = glm::abs(vertex);
      farthest = std::max(farthest, kLatticeStep * static_cast<double>(std::max({size.x, size.y, size.z})));
    }
    slack_ = static_cast<float>(0.001 + farthest / (1 << 22));
  }

  void build(int threads) {
    parallelRanges(items_.size(), 1 << 14, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        items_[i] = {glm::vec3(center(static_cast<std::uint32_t>(i))), static_cast<std::uint32_t>(i)};
    });
    bvh_.order_.resize(items_.size());
    bvh_.corners_.resize(items_.size());
    const Range all{0, static_cast<std::uint32_t>(items_.size())};
    bvh_.nodes_.assign(nodesOf(all.count()), emptyNode());
    std::vector<Branch> branches;
    // As few nodes as give every thread some branches: this thread halves their ranges alone.
    const auto shares = static_cast<std::uint32_t>(2 * threadCount(threads));
    const std::uint32_t upper = grow(0, all, std::max<std::uint32_t>(1024, all.count() / shares), &branches);
    std::uint32_t next = upper;
    for (Branch& branch : branches) {
      branch.root = next;
      bvh_.nodes_[branch.parent].child[branch.lane] = next;
      next += nodesOf(branch.range.count());
    }
    parallelRanges(branches.size(), 1, threads, [&](std::size_t i, std::size_t) {
      const std::uint32_t end = grow(branches[i].root, branches[i].range, 0, nullptr);
      enclose(branches[i].root, end);
    });
    enclose(0, upper);
  }

  static Node emptyNode() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {{all(kInfinity), all(kInfinity), all(kInfinity)},
            {all(-kInfinity), all(-kInfinity), all(-kInfinity)},
            {kNothing, kNothing, kNothing, kNothing}};
  }

 private:
  struct Item {
    glm::vec3 center;
    std::uint32_t triangle;
  };
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t count() const { return end - begin; }
  };
  struct Branch {
    std::uint32_t parent;
    int lane;
    Range range;
    std::uint32_t root = 0;
  };

  glm::dvec3 center(std::uint32_t triangle) const {
    const auto& v = mesh_.triangles[triangle].vertex;
    return (mesh_.position(v[0]) + mesh_.position(v[1]) + mesh_.position(v[2])) / 3.0;
  }

  std::uint32_t halve(const Range& range) {
    const auto begin = items_.begin() + range.begin, end = items_.begin() + range.end;
    glm::vec3 low(1e30f), high(-1e30f);
    for (auto item = begin; item != end; ++item) {
      low = glm::min(low, item->center);
      high = glm::max(high, item->center);
    }
    const glm::vec3 spread = high - low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : (spread.y >= spread.z ? 1 : 2);
    const std::uint32_t middle = range.count() / 2;
    std::nth_element(begin, begin + middle, end, [axis](const Item& a, const Item& b) {
      return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.triangle < b.triangle;
    });
    return range.begin + middle;
  }

  // Two to four parts; one of a single triangle.
  int divide(const Range& range, Range (&parts)[4]) {
    int count = 0;
    const auto add = [&](const Range& half) {
      if (half.count() <= 1) {
        if (half.count() == 1) parts[count++] = half;
        return;
      }
      const std::uint32_t middle = halve(half);
      parts[count++] = {half.begin, middle};
      parts[count++] = {middle, half.end};
    };
    if (range.count() <= 1) {
      add(range);
    } else {
      const std::uint32_t middle = halve(range);
      add({range.begin, middle});
      add({middle, range.end});
    }
    return count;
  }

  // The number of nodes that divide() makes of so many triangles, and of the parts.
  static std::uint32_t nodesOf(std::uint32_t triangles) {
    std::uint32_t nodes = 1;
    for (const std::uint32_t half : {triangles / 2, triangles - triangles / 2}) {
      if (half <= 1) continue;
      for (const std::uint32_t part : {half / 2, half - half / 2}) nodes += part > 1 ? nodesOf(part) : 0;
    }
    return nodes;
  }

  // Makes the nodes of a range, from `root` on, each before those below it. Ranges of no more than `least`
  // triangles are left for `later`. Answers the end of the nodes.
  std::uint32_t grow(std::uint32_t root, const Range& range, std::uint32_t least,
                     std::vector<Branch>* later) {
    std::vector<std::pair<std::uint32_t, Range>> tasks{{root, range}};
    std::uint32_t end = root + 1;
    while (!tasks.empty()) {
      const auto [at, its] = tasks.back();
      tasks.pop_back();
      Node& node = bvh_.nodes_[at];
      Range parts[4];
      const int count = divide(its, parts);
      for (int k = 0; k < count; ++k) {
        if (parts[k].count() == 1) {
          node.child[k] = kLeaf | parts[k].begin;
          setLeaf(node, k, parts[k].begin);
        } else if (later != nullptr && parts[k].count() <= least) {
          later->push_back({at, k, parts[k]});
        } else {
          node.child[k] = end;
          tasks.emplace_back(end++, parts[k]);
        }
      }
    }
    return end;
  }

  // The boxes of what is below the nodes [begin, end), the last first.
  void enclose(std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = end; i-- > begin;) {
      Node& node = bvh_.nodes_[i];
      for (int k = 0; k < 4; ++k) {
        if ((node.child[k] & kLeaf) != 0) continue;
        const Node& below = bvh_.nodes_[node.child[k]];
        for (int axis = 0; axis < 3; ++axis) {
          const Floats low = below.low[axis], high = below.high[axis];
          node.low[axis][k] = std::min({low[0], low[1], low[2], low[3]});
          node.high[axis][k] = std::max({high[0], high[1], high[2], high[3]});
        }
      }
    }
  }

  void setLeaf(Node& node, int lane, std::uint32_t place) {
    const std::uint32_t triangle = items_[place].triangle;
    const auto& v = mesh_.triangles[triangle].vertex;
    const Corners corners{mesh_.position(v[0]), mesh_.position(v[1]), mesh_.position(v[2])};
    bvh_.order_[place] = triangle;
    bvh_.corners_[place] = corners;
    const glm::vec3 low(glm::min(glm::min(corners.a, corners.b), corners.c)),
        high(glm::max(glm::max(corners.a, corners.b), corners.c));
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = low[axis] - slack_;
      node.high[axis][lane] = high[axis] + slack_;
    }
  }

  const Topology& mesh_;
  TriangleBvh& bvh_;
  std::vector<Item> items_;
  float slack_ = 0;
};

TriangleBvh::TriangleBvh(const Topology& mesh, int threads) { Builder(mesh, *this).build(threads); }

TriangleBvh::Around TriangleBvh::around(const glm::dvec3& low, const glm::dvec3& high,
                                        double distance) const {
  struct Box {
    std::uint32_t child;
    const Node* node;
    int lane;
  };
  const auto isNear = [&](const Node& node, int k) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double apart = std::max({static_cast<double>(node.low[axis][k]) - high[axis],
                                     low[axis] - static_cast<double>(node.high[axis][k]), 0.0});
      squared += apart * apart;
    }
    return squared <= distance * distance;
  };
  constexpr int kLanes = 4 * Around::kMost;
  Box boxes[kLanes];
  int count = 0;
  const auto open = [&](const Node& node) {
    for (int k = 0; k < 4; ++k)
      if (node.child[k] != kNothing && isNear(node, k)) boxes[count++] = {node.child[k], &node, k};
  };
  open(nodes_[0]);
  // Round by round, so that what is left are nodes of about the same size.
  for (bool opened = true; opened;) {
    opened = false;
    for (int i = count - 1; i >= 0 && count + 3 <= kLanes; --i) {
      if ((boxes[i].child & kLeaf) != 0) continue;
      opened = true;
      const Node& node = nodes_[boxes[i].child];
      boxes[i] = boxes[--count];
      open(node);
    }
  }
  Around found;
  found.count_ = (count + 3) / 4;
  for (int i = 0; i < 4 * found.count_; ++i) {
    Node& node = found.nodes_[static_cast<std::size_t>(i / 4)];
    if (i % 4 == 0) node = Builder::emptyNode();
    if (i >= count) continue;
    node.child[i % 4] = boxes[i].child;
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][i % 4] = boxes[i].node->low[axis][boxes[i].lane];
      node.high[axis][i % 4] = boxes[i].node->high[axis][boxes[i].lane];
    }
  }
  return found;
}

Nearest TriangleBvh::nearest(const Around& around, const glm::dvec3& p, Nearest guess) const {
  search(
      around.nodes_.data(), around.count_, p, [](std::uint32_t) { return true; }, guess);
  return guess;
}

}  // namespace kelp::bake
