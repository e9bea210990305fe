// SPDX-License-Identifier: MIT
// Half-edge meshes of soups that are no surfaces, against what is true of any, by brute force over all pairs.
#include "faulty_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include <OpenMesh/Tools/Utils/MeshCheckerT.hh>

#include "support/all_tests.h"

namespace kelp::bake {
namespace {

using Triple = std::array<std::uint32_t, 3>;
using Side = std::pair<std::uint32_t, std::uint32_t>;

Side sideOf(const Triple& t, std::size_t k) { return {t[k], t[(k + 1) % 3]}; }
Side turned(const Side& s) { return {s.second, s.first}; }
bool shareAnEdge(const Triple& a, const Triple& b) {
  return std::count_if(a.begin(), a.end(),
                       [&](std::uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); }) >= 2;
}
std::size_t index(OpenMesh::BaseHandle handle) { return static_cast<std::size_t>(handle.idx()); }

// The same for all that hang together.
std::vector<std::size_t> pieces(std::size_t count,
                                const std::function<bool(std::size_t, std::size_t)>& meet) {
  std::vector<std::size_t> piece(count, count);
  for (std::size_t seed = 0, next = 0; seed < count; ++seed) {
    if (piece[seed] != count) continue;
    std::vector<std::size_t> front{seed};
    piece[seed] = next;
    for (std::size_t at = 0; at < front.size(); ++at) {
      for (std::size_t i = 0; i < count; ++i) {
        if (piece[i] != count || !meet(front[at], i)) continue;
        piece[i] = next;
        front.push_back(i);
      }
    }
    ++next;
  }
  return piece;
}

Topology topologyOf(const std::vector<glm::i64vec3>& points, const std::vector<Triple>& triangles) {
  Topology mesh;
  mesh.lattice = points;
  const std::vector<std::size_t> piece = pieces(triangles.size(), [&](std::size_t a, std::size_t b) {
    return shareAnEdge(triangles[a], triangles[b]);
  });
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    SolidTriangle& t = mesh.triangles.emplace_back();
    t.vertex = triangles[i];
    t.source = static_cast<std::uint32_t>(i);
    t.component = static_cast<std::uint32_t>(piece[i]);
    mesh.components.resize(std::max<std::size_t>(mesh.components.size(), piece[i] + 1));
  }
  return mesh;
}

struct Made {
  Topology mesh;
  FaultyMesh faulty;
  std::vector<Hole> holes;

  Made(const std::vector<glm::i64vec3>& points, const std::vector<Triple>& triangles)
      : mesh(topologyOf(points, triangles)),
        faulty(makeFaultyMesh(mesh, sortedEdges(mesh, true))),
        holes(findHoles(mesh, faulty)) {}
  EdgeCounts all() const {
    EdgeCounts sum;
    for (const Component& c : mesh.components) sum += c.diagnosis;
    return sum;
  }
  // V - E + F
  long euler() const {
    const HalfEdgeMesh& m = faulty.half_edges;
    return static_cast<long>(m.n_vertices()) - static_cast<long>(m.n_edges()) +
           static_cast<long>(m.n_faces());
  }
};

// How many triangles run along each side, by component.
using Sides = std::map<std::pair<std::uint32_t, Side>, int>;
Sides sidesOf(const Topology& mesh) {
  Sides sides;
  for (const SolidTriangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t.component, sideOf(t.vertex, k)}];
  }
  return sides;
}
int countOf(const Sides& sides, std::uint32_t component, const Side& side) {
  const auto at = sides.find({component, side});
  return at == sides.end() ? 0 : at->second;
}

// Faces are the faulty components' triangles, each once, as they are wound now.
void checkFaces(const Made& made, const std::vector<Triple>& before) {
  const Sides sides = sidesOf(made.mesh);
  std::set<std::uint32_t> faulty;
  for (const auto& [place, count] : sides) {
    if (count != 1 || countOf(sides, place.first, turned(place.second)) != 1) faulty.insert(place.first);
  }
  std::map<std::uint32_t, int> seen;
  for (const OpenMesh::SmartFaceHandle face : made.faulty.half_edges.faces()) {
    const std::uint32_t triangle = made.faulty.triangles[index(face)];
    ++seen[triangle];
    Triple corners{};
    std::size_t k = 0;
    for (const OpenMesh::VertexHandle v : face.vertices()) corners.at(k++) = made.faulty.vertices[index(v)];
    ASSERT_EQ(k, 3u);
    EXPECT_TRUE(std::is_permutation(corners.begin(), corners.end(), before[triangle].begin()));
    std::rotate(corners.begin(),
                std::find(corners.begin(), corners.end(), made.mesh.triangles[triangle].vertex[0]),
                corners.end());
    EXPECT_EQ(corners, made.mesh.triangles[triangle].vertex);
  }
  for (std::uint32_t i = 0; i < made.mesh.triangles.size(); ++i) {
    const SolidTriangle& t = made.mesh.triangles[i];
    // Components that only had to be wound are faces too.
    if (faulty.count(t.component)) {
      EXPECT_EQ(seen[i], 1);
    }
    EXPECT_LE(seen[i], 1);
    EXPECT_EQ(t.swapped, t.vertex != before[i]);
  }
}

// Of an edge along which u triangles run up and d down, min(u, d) lie between two faces and the rest is open.
void checkEdges(const Made& made) {
  std::map<std::pair<std::uint32_t, Side>, int> inner, open;
  for (const OpenMesh::SmartHalfedgeHandle h : made.faulty.half_edges.halfedges()) {
    const auto face = h.is_boundary() ? h.opp().face() : h.face();
    ASSERT_TRUE(face.is_valid());
    const std::uint32_t component = made.mesh.triangles[made.faulty.triangles[index(face)]].component;
    const Side side{made.faulty.vertices[index(h.from())], made.faulty.vertices[index(h.to())]};
    if (h.is_boundary())
      ++open[{component, side}];
    else if (!h.opp().is_boundary())
      ++inner[{component, side}];
    EXPECT_EQ(h.next().from(), h.to());
    EXPECT_EQ(h.next().prev(), h);
    EXPECT_EQ(h.next().is_boundary(), h.is_boundary());
  }
  std::map<std::uint32_t, EdgeCounts> expected;
  const Sides sides = sidesOf(made.mesh);
  std::size_t edges = 0;
  for (const auto& [place, count] : sides) {
    const auto& [component, side] = place;
    if (made.faulty.half_edges.n_faces() == 0) continue;
    const int back = countOf(sides, component, turned(side));
    if (!inner.count(place) && !open.count({component, turned(side)})) continue;  // of a sound component
    EXPECT_EQ(inner[place], std::min(count, back));
    const int left = open[{component, turned(side)}];
    EXPECT_EQ(left, std::max(0, count - back));
    edges += static_cast<std::size_t>(left);
    if (side.first < side.second) edges += static_cast<std::size_t>(inner[place]);
    if (back > 0 && side.first > side.second) continue;
    expected[component].open_edges += count + back == 1;
    expected[component].split_edges += count + back > 2;
    expected[component].cut_edges += count + back == 2 && count != back;
  }
  EXPECT_EQ(edges, made.faulty.half_edges.n_edges());
  for (std::uint32_t c = 0; c < made.mesh.components.size(); ++c) {
    const EdgeCounts& diagnosis = made.mesh.components[c].diagnosis;
    EXPECT_EQ(diagnosis.open_edges, expected[c].open_edges);
    EXPECT_EQ(diagnosis.split_edges, expected[c].split_edges);
    EXPECT_EQ(diagnosis.cut_edges, expected[c].cut_edges);
  }
}

// The triangles around a vertex are those of its faces that have it as a corner; no two vertices of one point
// share an edge there, so that none has been split without need.
void checkVertices(const Made& made) {
  const HalfEdgeMesh& mesh = made.faulty.half_edges;
  std::vector<std::set<int>> faces(mesh.n_vertices());
  for (const OpenMesh::SmartFaceHandle face : mesh.faces()) {
    for (const OpenMesh::VertexHandle v : face.vertices()) faces[index(v)].insert(face.idx());
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> copies;
  for (const OpenMesh::SmartVertexHandle v : mesh.vertices()) {
    std::set<int> around;
    for (const OpenMesh::SmartFaceHandle face : v.faces()) EXPECT_TRUE(around.insert(face.idx()).second);
    EXPECT_EQ(around, faces[index(v)]);
    ASSERT_FALSE(around.empty());
    const auto face = static_cast<std::size_t>(*around.begin());
    const std::uint32_t component = made.mesh.triangles[made.faulty.triangles[face]].component;
    ++copies[{component, made.faulty.vertices[index(v)]}];
  }
  std::map<std::uint32_t, std::uint64_t> split;
  for (const auto& [place, count] : copies) split[place.first] += count - 1;
  for (std::uint32_t c = 0; c < made.mesh.components.size(); ++c)
    EXPECT_EQ(made.mesh.components[c].diagnosis.split_vertices, split[c]);
}

// Holes are the open edges, each once, in loops that pass through a point once. With a face for each loop the
// half-edge mesh is a closed surface with two sides, so V - E + F of each piece is even and at most 2.
void checkHoles(const Made& made) {
  std::map<std::pair<std::uint32_t, Side>, int> open;
  const Sides sides = sidesOf(made.mesh);
  for (const auto& [place, count] : sides) {
    const int left = count - countOf(sides, place.first, turned(place.second));
    if (left > 0) open[{place.first, turned(place.second)}] = left;
  }
  std::map<std::uint32_t, std::uint64_t> holes;
  for (const Hole& hole : made.holes) {
    ++holes[hole.component];
    ASSERT_GE(hole.corners.size(), 3u);
    EXPECT_EQ(std::set<std::uint32_t>(hole.corners.begin(), hole.corners.end()).size(), hole.corners.size());
    for (std::size_t i = 0; i < hole.corners.size(); ++i)
      --open[{hole.component, {hole.corners[i], hole.corners[(i + 1) % hole.corners.size()]}}];
  }
  for (const auto& [place, left] : open) EXPECT_EQ(left, 0);
  for (std::uint32_t c = 0; c < made.mesh.components.size(); ++c)
    EXPECT_EQ(made.mesh.components[c].diagnosis.holes, holes[c]);

  const HalfEdgeMesh& mesh = made.faulty.half_edges;
  std::set<int> first;  // the least half-edge of each loop
  for (const OpenMesh::SmartHalfedgeHandle h : mesh.halfedges()) {
    if (!h.is_boundary()) continue;
    int least = h.idx();
    for (OpenMesh::SmartHalfedgeHandle at = h.next(); at != h; at = at.next())
      least = std::min(least, at.idx());
    first.insert(least);
  }
  const std::vector<std::size_t> piece = pieces(mesh.n_vertices(), [&](std::size_t a, std::size_t b) {
    for (const OpenMesh::SmartVertexHandle v : mesh.vv_range(mesh.vertex_handle(static_cast<unsigned>(a)))) {
      if (index(v) == b) return true;
    }
    return false;
  });
  std::map<std::size_t, int> euler;
  for (const std::size_t p : piece) ++euler[p];
  for (const OpenMesh::SmartEdgeHandle e : mesh.edges()) --euler[piece[index(e.v0())]];
  for (const OpenMesh::SmartFaceHandle f : mesh.faces()) ++euler[piece[index(f.halfedge().to())]];
  for (const int h : first) ++euler[piece[index(mesh.to_vertex_handle(OpenMesh::HalfedgeHandle(h)))]];
  for (const auto& [p, sum] : euler) {
    EXPECT_EQ(sum % 2, 0);
    EXPECT_LE(sum, 2);
  }
}

// Triangles joined by edges of exactly two run alike if there is a way to: all ways are tried. What was
// turned has no more area than what was not.
void checkWinding(const Made& made, const std::vector<Triple>& before) {
  std::map<Side, std::vector<std::size_t>> at;
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Side s = sideOf(before[i], k);
      at[{std::min(s.first, s.second), std::max(s.first, s.second)}].push_back(i);
    }
  }
  const auto joined = [&](std::size_t a, std::size_t b) {
    return std::any_of(at.begin(), at.end(), [&](const auto& e) {
      return e.second == std::vector<std::size_t>{std::min(a, b), std::max(a, b)};
    });
  };
  const std::vector<std::size_t> patch = pieces(before.size(), joined);
  const std::size_t patches = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
  for (std::size_t p = 0; p < patches; ++p) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      if (patch[i] == p) members.push_back(i);
    }
    double kept = 0, swapped = 0;
    for (const std::size_t i : members)
      (made.mesh.triangles[i].swapped ? swapped : kept) +=
          glm::length(made.mesh.areaVector(made.mesh.triangles[i]));
    EXPECT_LE(swapped, kept * (1 + 1e-12));
    if (members.size() > 10) continue;
    const auto clashes = [&](const std::function<bool(std::size_t)>& turn) {
      int count = 0;
      for (const auto& [side, triangles] : at) {
        if (triangles.size() != 2 || patch[triangles[0]] != p) continue;
        int net = 0;
        for (const std::size_t i : triangles) {
          for (std::size_t k = 0; k < 3; ++k) {
            const int sense = turn(i) ? -1 : 1;
            if (sideOf(before[i], k) == side) net += sense;
            if (sideOf(before[i], k) == turned(side)) net -= sense;
          }
        }
        count += net != 0;
      }
      return count;
    };
    bool two_sided = false;
    for (std::uint32_t way = 0; way < 1u << members.size() && !two_sided; ++way) {
      std::map<std::size_t, bool> turn;
      for (std::size_t i = 0; i < members.size(); ++i) turn[members[i]] = way >> i & 1;
      two_sided = clashes([&](std::size_t i) { return turn[i]; }) == 0;
    }
    const int left = clashes([&](std::size_t i) { return made.mesh.triangles[i].swapped; });
    EXPECT_EQ(left == 0, two_sided);
  }
}

void check(const Made& made, const std::vector<Triple>& before) {
  checkFaces(made, before);
  checkEdges(made);
  checkVertices(made);
  checkHoles(made);
  checkWinding(made, before);
  HalfEdgeMesh copy = made.faulty.half_edges;
  std::ostringstream said;
  EXPECT_TRUE(OpenMesh::Utils::MeshCheckerT<HalfEdgeMesh>(copy).check(
      OpenMesh::Utils::MeshCheckerT<HalfEdgeMesh>::CHECK_ALL, said))
      << said.str();
}

std::vector<glm::i64vec3> somePoints(std::size_t count, std::mt19937& random) {
  std::vector<glm::i64vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(random() % 100000, random() % 100000, random() % 100000);
  return points;
}

// Triangles thrown at a few points: edges of many, bow-ties of many, surfaces with one side and that touch
// themselves along an edge.
TEST(FaultyMesh, OfAnySoupIsASurfaceOfItsTriangles) {
  std::size_t double_edges = 0, split_edges = 0, split_vertices = 0, cut = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(test::shareOf(4000)); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t points = 4 + random() % 9, most = 1 + random() % 24;
    std::set<Triple> known;
    std::vector<Triple> triangles;
    for (std::size_t i = 0; i < most; ++i) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random() % points); };
      Triple t{corner(), corner(), corner()}, key = t;
      std::sort(key.begin(), key.end());
      if (key[0] == key[1] || key[1] == key[2] || !known.insert(key).second) continue;
      triangles.push_back(t);
    }
    const Made made(somePoints(points, random), triangles);
    check(made, triangles);
    std::set<std::pair<int, int>> ends;
    for (const OpenMesh::SmartEdgeHandle e : made.faulty.half_edges.edges())
      double_edges += !ends.insert(std::minmax(e.v0().idx(), e.v1().idx())).second;
    split_edges += made.all().split_edges;
    split_vertices += made.all().split_vertices;
    cut += made.all().cut_edges;
  }
  // Every kind came up.
  for (const std::size_t count : {double_edges, split_edges, split_vertices, cut}) EXPECT_GT(count, 0u);
}

// Two tetrahedra that share an edge are closed, each for itself; only the edge and its ends are split.
TEST(FaultyMesh, BodiesThatTouchAlongAnEdgeComeApartThere) {
  std::mt19937 random(1);
  const std::vector<Triple> triangles{{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2},
                                      {0, 1, 4}, {1, 0, 5}, {0, 4, 5}, {1, 5, 4}};
  const Made made(somePoints(6, random), triangles);
  check(made, triangles);
  EXPECT_EQ(made.mesh.components.size(), 1u);
  EXPECT_EQ(made.all().split_edges, 1u);
  EXPECT_EQ(made.all().split_vertices, 2u);
  EXPECT_EQ(made.all().open_edges, 0u);
  EXPECT_TRUE(made.holes.empty());
  EXPECT_EQ(made.euler(), 2 + 2);
}

// A strip of 2 n triangles, with half a turn or without.
std::vector<Triple> strip(std::uint32_t n, bool half_turn) {
  std::vector<Triple> triangles;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * i + 1;
    std::uint32_t c = 2 * i + 2, d = 2 * i + 3;
    if (i + 1 == n) c = half_turn ? 1 : 0, d = half_turn ? 0 : 1;
    triangles.push_back({a, b, c});
    triangles.push_back({c, b, d});
  }
  return triangles;
}

TEST(FaultyMesh, AMoebiusStripIsCutAcross) {
  for (const std::uint32_t n : {3u, 4u, 12u, 101u}) {
    SCOPED_TRACE(n);
    std::mt19937 random(n);
    const std::vector<Triple> triangles = strip(n, true);
    const Made made(somePoints(2 * n, random), triangles);
    check(made, triangles);
    EXPECT_EQ(made.all().cut_edges, 1u);
    EXPECT_EQ(made.all().open_edges, 2 * n);
    EXPECT_EQ(made.all().split_vertices, 2u);
    EXPECT_EQ(made.euler(), 1);  // a disc
    const std::vector<Triple> ring = strip(n, false);
    const Made plain(somePoints(2 * n, random), ring);
    check(plain, ring);
    EXPECT_EQ(plain.all().cut_edges, 0u);
    EXPECT_EQ(plain.all().split_vertices, 0u);
    EXPECT_EQ(plain.all().holes, 2u);
    EXPECT_EQ(plain.euler(), 0);
  }
}

// A closed mesh needs no half-edges; one wound at random does, and is a sphere then, all wound alike.
TEST(FaultyMesh, OnlyWhatHasFaultsIsBuilt) {
  const std::vector<Triple> octahedron{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                       {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  std::mt19937 random(1);
  const auto points = somePoints(6, random);
  EXPECT_EQ(Made(points, octahedron).faulty.half_edges.n_faces(), 0u);
  for (int round = 0; round < 50; ++round) {
    std::vector<Triple> wild = octahedron;
    for (Triple& t : wild) {
      if (random() % 2) std::swap(t[0], t[1]);
    }
    const Made made(points, wild);
    check(made, wild);
    const EdgeCounts diagnosis = made.all();
    EXPECT_EQ(diagnosis.open_edges + diagnosis.split_edges + diagnosis.cut_edges + diagnosis.split_vertices +
                  diagnosis.holes,
              0u);
    if (made.faulty.half_edges.n_faces() > 0) {
      EXPECT_EQ(made.euler(), 2);
    }
  }
}

}  // namespace
}  // namespace kelp::bake
