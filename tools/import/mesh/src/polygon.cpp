// SPDX-License-Identifier: MIT
// Cuts polygons into triangles by clipping ears. Source: Eberly, "Triangulation by Ear Clipping". A hole is
// joined to the outline by a bridge of two equal edges.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kelp/import/mesh/soup.h"

namespace kelp::bake {
namespace {

// Twice the area of a, b, c: positive if they are wound counter-clockwise, exactly 0 if two of them are
// equal.
double cross2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  if (a == b || b == c || c == a) return 0;
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Ear {
  glm::dvec2 a, b, c;

  double area() const { return cross2(a, b, c); }
  // Positive to the left of each side; inside where all three are.
  std::array<double, 3> sides(const glm::dvec2& p) const {
    return {cross2(a, b, p), cross2(b, c, p), cross2(c, a, p)};
  }

  // True if a point is in the ear or on its rim.
  bool holds(const glm::dvec2& p) const {
    const std::array<double, 3> left = sides(p);
    return left[0] >= 0 && left[1] >= 0 && left[2] >= 0;
  }
  // The same for points that are not corners.
  bool touches(const glm::dvec2& p) const { return p != a && p != b && p != c && holds(p); }

  // True if an edge crosses the inside by more than rounding.
  bool isCrossed(const glm::dvec2& p, const glm::dvec2& q) const {
    const std::array<double, 3> from = sides(p), to = sides(q);
    double begin = 0, end = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      if (from[i] <= 0 && to[i] <= 0) return false;
      const double crossing = from[i] / (from[i] - to[i]);
      if (from[i] < 0) begin = std::max(begin, crossing);
      if (to[i] < 0) end = std::min(end, crossing);
    }
    return end - begin > 1e-9;
  }
};

// Tests for an ear, the strictest first. A polygon with a hole walks its bridge twice, so its corners and
// edges touch each other. Such a polygon may have no ear of the first kind, but if nothing crosses it has one
// of the first three.
enum class Ask { kNothingTouches, kNothingCrosses, kNoArea, kAnything };

bool isEar(const std::vector<glm::dvec2>& flat, const std::vector<std::uint32_t>& left, std::size_t at,
           Ask ask) {
  const std::size_t n = left.size();
  const Ear ear{flat[left[(at + n - 1) % n]], flat[left[at]], flat[left[(at + 1) % n]]};
  const double area = ear.area();
  if (ask == Ask::kAnything || (ask == Ask::kNoArea && area == 0)) return true;
  if (!(area > 0)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 &p = flat[left[i]], &q = flat[left[(i + 1) % n]];
    if ((ask == Ask::kNothingTouches && ear.touches(p)) || ear.isCrossed(p, q)) return false;
  }
  return true;
}

// An index of the remaining corners of a large polygon: finds those in a triangle.
class CornerTree {
 public:
  explicit CornerTree(const std::vector<glm::dvec2>& flat)
      : flat_(flat), order_(flat.size()), leaf_of_(flat.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(order_.size()), kNone);
  }

  void remove(std::uint32_t corner) {
    Node& leaf = nodes_[leaf_of_[corner]];
    const auto begin = order_.begin() + leaf.begin;
    std::iter_swap(std::find(begin, begin + leaf.left, corner), begin + (leaf.left - 1));
    for (std::uint32_t at = leaf_of_[corner]; at != kNone; at = nodes_[at].parent) --nodes_[at].left;
  }

  // True if `test` holds for a corner. It is asked for all corners in the ear and on its rim, and for some
  // beside it.
  template <class Test>
  bool any(const Ear& ear, const Test& test) const {
    return any(0, ear, test);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu, kLeaf = 8;
  struct Node {
    glm::dvec2 low{0}, high{0};
    std::uint32_t begin = 0, left = 0;  // corners in order_ (of leaves), and how many there are still
    std::uint32_t parent = kNone, children = kNone;
  };

  void build(std::uint32_t at, std::uint32_t begin, std::uint32_t end, std::uint32_t parent) {
    Node node{flat_[order_[begin]], flat_[order_[begin]], begin, end - begin, parent, kNone};
    for (std::uint32_t i = begin; i < end; ++i) {
      node.low = glm::min(node.low, flat_[order_[i]]);
      node.high = glm::max(node.high, flat_[order_[i]]);
    }
    if (node.left > kLeaf) {
      const int axis = node.high.x - node.low.x >= node.high.y - node.low.y ? 0 : 1;
      const std::uint32_t middle = begin + node.left / 2;
      const auto first = order_.begin();
      std::nth_element(first + begin, first + middle, first + end,
                       [&](std::uint32_t a, std::uint32_t b) { return flat_[a][axis] < flat_[b][axis]; });
      node.children = static_cast<std::uint32_t>(nodes_.size());
      nodes_.resize(nodes_.size() + 2);
      build(node.children, begin, middle, at);
      build(node.children + 1, middle, end, at);
    } else {
      for (std::uint32_t i = begin; i < end; ++i) leaf_of_[order_[i]] = at;
    }
    nodes_[at] = node;
  }

  // True if a box lies outside the ear's own box, or to the right of one of the ear's sides. Rounding is
  // safe: no corner in the box has a larger sum of products.
  static bool isBeside(const Ear& ear, const Node& node) {
    const glm::dvec2 low = glm::min(glm::min(ear.a, ear.b), ear.c),
                     high = glm::max(glm::max(ear.a, ear.b), ear.c);
    if (node.high.x < low.x || node.high.y < low.y || node.low.x > high.x || node.low.y > high.y) return true;
    const glm::dvec2* corner[3] = {&ear.a, &ear.b, &ear.c};
    for (int i = 0; i < 3; ++i) {
      const glm::dvec2 &from = *corner[i], along = *corner[(i + 1) % 3] - from;
      const glm::dvec2 leftmost(along.y > 0 ? node.low.x : node.high.x,
                                along.x > 0 ? node.high.y : node.low.y);
      if (along.x * (leftmost.y - from.y) - along.y * (leftmost.x - from.x) < 0) return true;
    }
    return false;
  }

  template <class Test>
  bool any(std::uint32_t at, const Ear& ear, const Test& test) const {
    const Node& node = nodes_[at];
    if (node.left == 0 || isBeside(ear, node)) return false;
    if (node.children != kNone) return any(node.children, ear, test) || any(node.children + 1, ear, test);
    return std::any_of(order_.begin() + node.begin, order_.begin() + node.begin + node.left, test);
  }

  const std::vector<glm::dvec2>& flat_;
  std::vector<std::uint32_t> order_, leaf_of_;
  std::vector<Node> nodes_;
};

// Large polygons, in n log n if few corners lie in ears. Each round clips every second ear, so that round
// outlines get wide triangles: a fan of a hundred thousand slivers would slow down all later stages.
class LargePolygon {
 public:
  explicit LargePolygon(const std::vector<glm::dvec2>& flat)
      : flat_(flat),
        tree_(flat),
        before_(flat.size()),
        after_(flat.size()),
        waits_(flat.size(), 0),
        left_(flat.size()),
        looks_left_(std::uint64_t{256} * flat.size()) {
    for (std::uint32_t i = 0; i < left_; ++i) {
      before_[i] = (i + left_ - 1) % static_cast<std::uint32_t>(left_);
      after_[i] = (i + 1) % static_cast<std::uint32_t>(left_);
    }
  }

  std::vector<std::array<std::uint32_t, 3>> cut() {
    Ask ask = Ask::kNothingTouches;
    std::vector<std::uint32_t> now = all();
    while (left_ > 3) {
      for (const std::uint32_t corner : now) {
        // Corners beside an ear that this round has clipped wait for the next round.
        if (!waits_[corner] && left_ > 3 && isEar(corner, ask)) clip(corner);
      }
      if (later_.empty() && ask == Ask::kNoArea) {
        clip(start_);  // no polygon at all: any corner is as good
      } else if (later_.empty()) {
        ask = static_cast<Ask>(static_cast<int>(ask) + 1);
        now = all();
        continue;
      }
      // Clipping an ear can only make the corners beside it ears.
      now.clear();
      for (const std::uint32_t corner : later_) {
        if (after_[corner] != kGone) now.push_back(corner);
        waits_[corner] = 0;
      }
      later_.clear();
    }
    triangles_.push_back({before_[start_], start_, after_[start_]});
    return std::move(triangles_);
  }

 private:
  static constexpr std::uint32_t kGone = 0xffffffffu;

  std::vector<std::uint32_t> all() const {
    std::vector<std::uint32_t> corners{start_};
    for (std::uint32_t i = after_[start_]; i != start_; i = after_[i]) corners.push_back(i);
    return corners;
  }

  bool isEar(std::uint32_t at, Ask ask) const {
    const Ear ear{flat_[before_[at]], flat_[at], flat_[after_[at]]};
    const double area = ear.area();
    if (ask == Ask::kNoArea && area == 0) return true;
    if (!(area > 0)) return false;
    if (looks_left_ == 0) return true;
    // An edge that crosses an ear of a polygon has a corner in it or on its rim.
    return !tree_.any(ear, [&](std::uint32_t i) {
      if (looks_left_ > 0) --looks_left_;
      if (!ear.holds(flat_[i])) return false;
      return (ask == Ask::kNothingTouches && ear.touches(flat_[i])) ||
             ear.isCrossed(flat_[before_[i]], flat_[i]) || ear.isCrossed(flat_[i], flat_[after_[i]]);
    });
  }

  void clip(std::uint32_t at) {
    const std::uint32_t a = before_[at], c = after_[at];
    triangles_.push_back({a, at, c});
    after_[a] = c;
    before_[c] = a;
    after_[at] = kGone;
    tree_.remove(at);
    --left_;
    start_ = c;
    for (const std::uint32_t beside : {a, c}) {
      if (!waits_[beside]) later_.push_back(beside);
      waits_[beside] = 1;
    }
  }

  const std::vector<glm::dvec2>& flat_;
  CornerTree tree_;
  std::vector<std::uint32_t> before_, after_, later_;
  std::vector<std::uint8_t> waits_;  // is in later_
  std::size_t left_;
  // corners, for degenerate or crossing outlines; beyond that any convex corner is an ear
  mutable std::uint64_t looks_left_;
  std::uint32_t start_ = 0;  // a corner that is there
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

// The polygon in its plane, wound counter-clockwise: drops the axis along which Newell's normal is longest.
std::vector<glm::dvec2> flatten(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - glm::dvec3(corners[0]);
    const glm::dvec3 b = glm::dvec3(corners[(i + 1) % corners.size()]) - glm::dvec3(corners[0]);
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  int drop = 2;
  if (size.x >= size.y && size.x >= size.z)
    drop = 0;
  else if (size.y >= size.z)
    drop = 1;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const glm::vec3& corner : corners) {
    const glm::dvec3 p = glm::dvec3(corner) - glm::dvec3(corners[0]);
    flat.emplace_back(p[u], p[v]);
  }
  return flat;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulatePolygon(std::span<const glm::vec3> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  if (corners.size() == 3) return {{0, 1, 2}};
  std::vector<glm::dvec2> flat = flatten(corners);
  // This way is cubic in the worst case: with more corners the other way may be faster.
  constexpr std::size_t kLarge = 32;
  if (corners.size() > kLarge) {
    // Triangles with a corner that is not finite are dropped later. Here their coordinates only need an
    // order.
    for (glm::dvec2& p : flat)
      if (!std::isfinite(p.x) || !std::isfinite(p.y)) p = glm::dvec2(0);
    return LargePolygon(flat).cut();
  }
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  // From the second corner on: convex polygons become a fan around the first corner, as in other readers.
  // Quads are seldom flat, so the choice of the diagonal shows.
  std::size_t at = 1, tried = 0;
  Ask ask = Ask::kNothingTouches;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    if (isEar(flat, left, at, ask)) {
      triangles.push_back({left[(at + n - 1) % n], left[at], left[(at + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      at %= left.size();
      tried = 0;
      ask = Ask::kNothingTouches;
    } else {
      at = (at + 1) % n;
      if (++tried == n) {
        ask = static_cast<Ask>(static_cast<int>(ask) + 1);
        tried = 0;
      }
    }
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace kelp::bake
