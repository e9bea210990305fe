// SPDX-License-Identifier: MIT
#include "kelp/voxelize/topology/topology.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "bucket_sort.h"
#include "edges.h"
#include "faulty_mesh.h"
#include "kelp/common/point_index.h"
#include "kelp/voxelize/topology/fill_report.h"

namespace kelp::bake {
namespace {

void weld(const TriangleSoup& soup, const Frame& frame, Topology& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffffu;
  std::vector<std::uint32_t> welded(soup.positions.size(), kUnused);
  PointIndex<glm::i64vec3> known;
  const auto vertexOf = [&](std::uint32_t source) {
    if (welded[source] == kUnused) {
      const glm::dvec3 p(frame.node_to_voxel * glm::dvec4(glm::dvec3(soup.positions[source]), 1.0));
      const glm::i64vec3 snapped(std::llround(p.x / kLatticeStep), std::llround(p.y / kLatticeStep),
                                 std::llround(p.z / kLatticeStep));
      welded[source] = known.of(snapped, mesh.lattice);
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

// True if the corners ascend, up to a rotation.
bool runsUpward(const std::array<std::uint32_t, 3>& v) {
  return (v[0] < v[1]) + (v[1] < v[2]) + (v[2] < v[0]) == 2;
}

// A face modeled twice (once for each side, or by mistake) would make every edge look closed and the inside
// vanish: the first one stays, marked as a wall if there were as many for one side as for the other.
// Triangles that have collapsed to a line or a point go.
void removeDuplicates(Topology& mesh, int threads) {
  using Key = std::array<std::uint32_t, 4>;  // the corners from low to high, the triangle
  const auto make = [&](const auto& take) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      std::array<std::uint32_t, 3> v = mesh.triangles[i].vertex;
      std::sort(v.begin(), v.end());
      take(v[0], Key{v[0], v[1], v[2], i});
    }
  };
  const std::vector<Key> keys = sortedByVertex<Key>(mesh.lattice.size(), threads, make, std::less<>());
  std::vector<bool> drop(mesh.triangles.size(), false);
  std::size_t first = 0;
  int upward = 0;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto& [a, b, c, i] = keys[k];
    const bool twice = k > 0 && std::equal(keys[k].begin(), keys[k].begin() + 3, keys[k - 1].begin());
    if (!twice) {
      first = k;
      upward = 0;
    }
    upward += runsUpward(mesh.triangles[i].vertex) ? 1 : -1;
    mesh.triangles[keys[first][3]].wall = upward == 0;
    if (twice || a == b || b == c) drop[i] = true;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!drop[i]) mesh.triangles[kept++] = mesh.triangles[i];
  }
  mesh.triangles.resize(kept);
}

DisjointSets joinedByEdges(const Topology& mesh, const std::vector<Edge>& edges) {
  DisjointSets sets(mesh.triangles.size());
  forEachEdge(edges, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin + 1; i < end; ++i) sets.join(edges[begin].triangle, edges[i].triangle);
  });
  return sets;
}

// A face modeled from both sides is the skin of a body (all of it is modeled so), a sheet, a leaf on a
// body, or the wall between two bodies that touch. The last two are no part of any skin, and known by this:
// the rest of what hangs together has a shorter boundary without them.
void findWalls(Topology& mesh, int threads) {
  if (std::none_of(mesh.triangles.begin(), mesh.triangles.end(),
                   [](const SolidTriangle& t) { return t.wall; }))
    return;
  struct Boundary {
    double with = 0, without = 0;
    bool rest = false;
  };
  const std::vector<Edge> edges = sortedEdges(mesh, false, threads);
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

std::vector<Hole> mend(Topology& mesh, int threads) {
  std::vector<Edge> edges = sortedEdges(mesh, true, threads);
  findComponents(mesh, edges);
  return findHoles(mesh, makeFaultyMesh(mesh, std::move(edges)));
}

void measure(Topology& mesh, const std::vector<SolidTriangle>& fans) {
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
  for (const SolidTriangle& t : fans) {
    add(t, mesh.components[t.component].cap_area);
    mesh.components[t.component].closed = false;
  }
}

}  // namespace

Topology analyze(const TriangleSoup& soup, const Frame& frame, Fill fill, int threads) {
  Topology mesh;
  weld(soup, frame, mesh);
  removeDuplicates(mesh, threads);
  findWalls(mesh, threads);
  const std::vector<SolidTriangle> fans = makeFans(mesh, mend(mesh, threads));
  measure(mesh, fans);
  mesh.closed = true;
  for (Component& c : mesh.components) {
    mesh.closed = mesh.closed && (c.closed || c.wall);
    c.solid = fill == Fill::kSolid ||
              (fill == Fill::kAuto && !c.wall && (c.closed || c.cap_area <= kMaxHoleShare * c.area));
    // 2 V / A is a plate's thickness and a wire's radius; below, centers alone would miss much of either.
    c.thin = !c.solid || 2.0 * std::abs(c.volume) <= 0.75 * (c.area + c.cap_area);
  }
  for (const SolidTriangle& t : fans) {
    if (mesh.components[t.component].solid) mesh.triangles.push_back(t), ++mesh.caps;
  }
  for (SolidTriangle& t : mesh.triangles) {
    if (mesh.components[t.component].solid && mesh.components[t.component].volume < 0) t.turn();
  }
  mesh.summary = summarizeFill(mesh, fill);
  return mesh;
}

void openCutOuts(Topology& mesh) {
  for (Component& c : mesh.components)
    if (c.solid && c.cut_area >= kMaxCutShare * c.area && c.cut_area > 0) {
      c.solid = false;
      c.thin = true;
    }
  mesh.caps -= std::erase_if(mesh.triangles, [&](const SolidTriangle& t) {
    return t.source == kCap && !mesh.components[t.component].solid;
  });
  mesh.summary = summarizeFill(mesh, Fill::kAuto);
}

}  // namespace kelp::bake
