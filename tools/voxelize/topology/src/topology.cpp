// SPDX-License-Identifier: MIT
#include "kelp/voxelize/topology/topology.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>

#include "caps.h"
#include "kelp/voxelize/topology/reasons.h"
#include "lines.h"

namespace kelp::bake {
namespace {

struct LatticeHash {
  std::size_t operator()(const glm::i64vec3& p) const {
    std::uint64_t h = static_cast<std::uint64_t>(p.x) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 29)) + static_cast<std::uint64_t>(p.y) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 32)) + static_cast<std::uint64_t>(p.z) * 0x94d049bb133111ebu;
    return static_cast<std::size_t>(h ^ (h >> 31));
  }
};

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller index becomes the root, so that roots do not depend on the order of calls.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// One side of a triangle. `forward`: the triangle runs along it from low to high. Walls share edges with
// walls only.
struct Edge {
  std::uint32_t low = 0, high = 0, triangle = 0;
  bool forward = false;
  bool wall = false;

  auto place() const { return std::tie(low, high, wall); }
};

// Calls visit(begin, end) for each run of equal edges; edges must be sorted.
template <class Visit>
void forEachEdge(const std::vector<Edge>& edges, const Visit& visit) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].place() == edges[begin].place()) ++end;
    visit(begin, end);
    begin = end;
  }
}

void weld(const TriangleSoup& soup, const Frame& frame, Topology& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffffu;
  std::vector<std::uint32_t> welded(soup.positions.size(), kUnused);
  std::unordered_map<glm::i64vec3, std::uint32_t, LatticeHash> known;
  known.reserve(soup.positions.size());
  const auto vertexOf = [&](std::uint32_t source) {
    if (welded[source] == kUnused) {
      const glm::dvec3 p(frame.node_to_voxel * glm::dvec4(glm::dvec3(soup.positions[source]), 1.0));
      const glm::i64vec3 snapped(std::llround(p.x / kLatticeStep), std::llround(p.y / kLatticeStep),
                                 std::llround(p.z / kLatticeStep));
      const auto [at, fresh] = known.try_emplace(snapped, static_cast<std::uint32_t>(mesh.lattice.size()));
      if (fresh) mesh.lattice.push_back(snapped);
      welded[source] = at->second;
    }
    return welded[source];
  };
  mesh.triangles.reserve(soup.triangles.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    SolidTriangle t;
    for (int k = 0; k < 3; ++k)
      t.vertex[static_cast<std::size_t>(k)] = vertexOf(soup.triangles[i].vertex[static_cast<std::size_t>(k)]);
    t.source = i;
    mesh.triangles.push_back(t);
  }
}

// Whether the corners ascend, up to a rotation.
bool runsUpward(const std::array<std::uint32_t, 3>& v) {
  return (v[0] < v[1]) + (v[1] < v[2]) + (v[2] < v[0]) == 2;
}

// A face modelled twice (once for each side, or by mistake) would make every edge look closed and the inside
// vanish: the first one stays, marked as a wall if there were as many for one side as for the other.
// Triangles that have collapsed to a line or a point go where others have that as a side or a corner.
void removeDuplicates(Topology& mesh) {
  std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>> keys;
  keys.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<std::uint32_t, 3> v = mesh.triangles[i].vertex;
    std::sort(v.begin(), v.end());
    keys.emplace_back(v[0], v[1], v[2], i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> drop(mesh.triangles.size(), false);
  std::size_t first = 0;
  int upward = 0;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto& [a, b, c, i] = keys[k];
    const bool twice =
        k > 0 && std::tie(a, b, c) ==
                     std::tie(std::get<0>(keys[k - 1]), std::get<1>(keys[k - 1]), std::get<2>(keys[k - 1]));
    if (!twice) {
      first = k;
      upward = 0;
    }
    upward += runsUpward(mesh.triangles[i].vertex) ? 1 : -1;
    mesh.triangles[std::get<3>(keys[first])].wall = upward == 0;
    if (twice || a == b || b == c) drop[i] = true;
  }
  keepLoneLines(mesh, drop);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!drop[i]) mesh.triangles[kept++] = mesh.triangles[i];
  }
  mesh.triangles.resize(kept);
}

std::vector<Edge> sortedEdges(const Topology& mesh, bool separate_walls) {
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i].vertex[k];
      const std::uint32_t b = mesh.triangles[i].vertex[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), i, a < b, separate_walls && mesh.triangles[i].wall});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.low, x.high, x.wall, x.triangle) < std::tie(y.low, y.high, y.wall, y.triangle);
  });
  return edges;
}

DisjointSets joinedByEdges(const Topology& mesh, const std::vector<Edge>& edges) {
  DisjointSets sets(mesh.triangles.size());
  forEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin + 1; i < end; ++i) sets.join(edges[begin].triangle, edges[i].triangle);
  });
  return sets;
}

// A face modelled from both sides is the skin of a body (all of it is modelled so), a sheet, a leaf on a
// body, or the wall between two bodies that touch. The last two are no part of any skin, and known by this:
// the rest of what hangs together has a shorter boundary without them.
void findWalls(Topology& mesh) {
  if (std::none_of(mesh.triangles.begin(), mesh.triangles.end(),
                   [](const SolidTriangle& t) { return t.wall; }))
    return;
  struct Boundary {
    double with = 0, without = 0;
    bool rest = false;
  };
  const std::vector<Edge> edges = sortedEdges(mesh, false);
  DisjointSets sets = joinedByEdges(mesh, edges);
  std::vector<Boundary> boundaries(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!mesh.triangles[i].wall) boundaries[sets.find(i)].rest = true;
  }
  forEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    const auto walls = std::count_if(edges.begin() + static_cast<std::ptrdiff_t>(begin),
                                     edges.begin() + static_cast<std::ptrdiff_t>(end),
                                     [&](const Edge& e) { return mesh.triangles[e.triangle].wall; });
    const std::size_t rest = end - begin - static_cast<std::size_t>(walls);
    const double length = glm::length(mesh.position(edges[begin].high) - mesh.position(edges[begin].low));
    Boundary& boundary = boundaries[sets.find(edges[begin].triangle)];
    boundary.with += (end - begin) % 2 == 1 ? length : 0.0;
    boundary.without += rest % 2 == 1 ? length : 0.0;
  });
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Boundary& boundary = boundaries[sets.find(i)];
    mesh.triangles[i].wall = mesh.triangles[i].wall && boundary.rest && boundary.without < boundary.with;
  }
}

// Winds each patch (triangles joined by edges of exactly two faces) in one sense: that of the larger part of
// its area. A patch that has no two sides stays as it is.
void windConsistently(Topology& mesh, const std::vector<Edge>& edges) {
  struct Neighbour {
    std::uint32_t triangle = 0;
    bool same = false;  // wound alike
  };
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint32_t> first(count + 1, 0);
  std::vector<Neighbour> neighbours;
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<std::uint32_t> cursor(first);
    forEachEdge(edges, [&](std::size_t begin, std::size_t end) {
      if (end - begin != 2 || edges[begin].triangle == edges[begin + 1].triangle) return;
      const Edge& e = edges[begin];
      const Edge& f = edges[begin + 1];
      if (pass == 0) {
        ++first[e.triangle + 1];
        ++first[f.triangle + 1];
      } else {
        neighbours[cursor[e.triangle]++] = {f.triangle, e.forward != f.forward};
        neighbours[cursor[f.triangle]++] = {e.triangle, e.forward != f.forward};
      }
    });
    if (pass == 0) {
      for (std::size_t i = 0; i < count; ++i) first[i + 1] += first[i];
      neighbours.resize(first[count]);
    }
  }
  enum : std::uint8_t { kUnseen, kKeep, kFlip };
  std::vector<std::uint8_t> state(count, kUnseen);
  std::vector<std::uint32_t> patch;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (state[seed] != kUnseen) continue;
    state[seed] = kKeep;
    patch.assign(1, seed);
    bool two_sided = true;
    double keep_area = 0, flip_area = 0;
    for (std::size_t at = 0; at < patch.size(); ++at) {
      const std::uint32_t i = patch[at];
      (state[i] == kKeep ? keep_area : flip_area) += glm::length(mesh.areaVector(mesh.triangles[i]));
      for (std::uint32_t n = first[i]; n < first[i + 1]; ++n) {
        const std::uint8_t wanted = (state[i] == kKeep) == neighbours[n].same ? kKeep : kFlip;
        std::uint8_t& its = state[neighbours[n].triangle];
        if (its == kUnseen) {
          its = wanted;
          patch.push_back(neighbours[n].triangle);
        } else if (its != wanted) {
          two_sided = false;
        }
      }
    }
    if (!two_sided) continue;
    const std::uint8_t flipped = flip_area <= keep_area ? kFlip : kKeep;
    for (const std::uint32_t i : patch) {
      if (state[i] == flipped) mesh.triangles[i].turn();
    }
  }
}

void findComponents(Topology& mesh, const std::vector<Edge>& edges) {
  DisjointSets sets = joinedByEdges(mesh, edges);
  std::vector<std::uint32_t> number(mesh.triangles.size(), 0);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t root = sets.find(i);
    if (root == i) {
      number[i] = static_cast<std::uint32_t>(mesh.components.size());
      mesh.components.emplace_back();
      mesh.components.back().closed = true;
      mesh.components.back().wall = mesh.triangles[i].wall;
    }
    mesh.triangles[i].component = number[root];
  }
}

// By component; in each it is a cycle.
std::vector<BoundaryEdge> findBoundary(const Topology& mesh, const std::vector<Edge>& edges) {
  std::vector<BoundaryEdge> boundary;
  forEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    int net = 0;
    for (std::size_t i = begin; i < end; ++i) {
      // Flips since the edges were sorted are visible in the triangle only.
      const SolidTriangle& t = mesh.triangles[edges[i].triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        if (t.vertex[k] == edges[i].low && t.vertex[(k + 1) % 3] == edges[i].high) ++net;
        if (t.vertex[k] == edges[i].high && t.vertex[(k + 1) % 3] == edges[i].low) --net;
      }
    }
    const std::uint32_t component = mesh.triangles[edges[begin].triangle].component;
    // The cap runs against its neighbour.
    for (int i = 0; i < std::abs(net); ++i) {
      boundary.push_back(net > 0 ? BoundaryEdge{component, edges[begin].high, edges[begin].low}
                                 : BoundaryEdge{component, edges[begin].low, edges[begin].high});
    }
  });
  std::stable_sort(boundary.begin(), boundary.end(),
                   [](const BoundaryEdge& a, const BoundaryEdge& b) { return a.component < b.component; });
  return boundary;
}

void measure(Topology& mesh, const std::vector<SolidTriangle>& caps) {
  // Volumes are summed around a point of each component: far from the origin the terms would cancel badly.
  std::vector<std::uint32_t> anchor(mesh.components.size(), kCap);
  const auto add = [&](const SolidTriangle& t, double& area) {
    std::uint32_t& at = anchor[t.component];
    if (at == kCap) at = t.vertex[0];
    const glm::dvec3 o = mesh.position(at);
    const glm::dvec3 vector = mesh.areaVector(t);
    area += glm::length(vector);
    mesh.components[t.component].volume += glm::dot(mesh.position(t.vertex[0]) - o, vector) / 3.0;
  };
  for (const SolidTriangle& t : mesh.triangles) {
    add(t, mesh.components[t.component].area);
    ++mesh.components[t.component].triangles;
  }
  for (const SolidTriangle& t : caps) {
    add(t, mesh.components[t.component].cap_area);
    mesh.components[t.component].closed = false;
  }
}

}  // namespace

Topology analyse(const TriangleSoup& soup, const Frame& frame, Fill fill) {
  Topology mesh;
  weld(soup, frame, mesh);
  removeDuplicates(mesh);
  findWalls(mesh);
  const std::vector<Edge> edges = sortedEdges(mesh, true);
  windConsistently(mesh, edges);
  findComponents(mesh, edges);
  std::vector<SolidTriangle> cones = makeCones(mesh, findBoundary(mesh, edges));
  measure(mesh, cones);
  mesh.closed = true;
  for (Component& c : mesh.components) {
    mesh.closed = mesh.closed && (c.closed || c.wall);
    c.solid = fill == Fill::kSolid ||
              (fill == Fill::kAuto && !c.wall && (c.closed || c.cap_area <= kMaxHoleShare * c.area));
    // 2 V / A is a plate's thickness and a wire's radius; below, centres alone would miss much of either. A
    // line has none of either.
    c.thin = !c.solid || 2.0 * std::abs(c.volume) <= 0.75 * (c.area + c.cap_area);
  }
  for (SolidTriangle& t : mesh.triangles) {
    if (mesh.components[t.component].solid && mesh.components[t.component].volume < 0) t.turn();
  }
  addCaps(mesh, std::move(cones));
  mesh.summary = summariseFill(mesh, fill);
  return mesh;
}

}  // namespace kelp::bake
