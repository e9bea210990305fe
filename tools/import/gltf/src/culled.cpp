// SPDX-License-Identifier: MIT
#include "culled.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Points of a component that are looked at: most of them must be inside another one.
constexpr std::size_t kWitnesses = 9;
// The largest shells that are looked at, and of each the largest components in its box, and around it: the
// work stays in proportion to the file.
constexpr std::size_t kMostShells = 4096, kMostTried = 64;
// Of a shell's extent: how far out of its box something inside it may reach.
constexpr double kBeyond = 0.1, kRounding = 1e-4;

struct Scene {
  std::span<const SourcePart> parts;
  const std::vector<SurfaceMaterial>& materials;
};

using Corners = std::array<glm::dvec3, 3>;

// Triangles that share corners, of one part.
struct Shell {
  std::size_t part = 0;
  std::span<const std::uint32_t> triangles;
  double volume = 0;             // signed: negative if it is turned inside out
  bool single_sided = true;      // all of it
  std::optional<bool> closed{};  // once it was asked for
  glm::dvec3 low{kInfinity}, high{-kInfinity};

  // True if the other's box is in this one, or beyond it by no more than such a share of its extent.
  bool contains(const Shell& other, double beyond) const {
    const double room = beyond * extent();
    return glm::all(glm::lessThanEqual(low - room, other.low)) &&
           glm::all(glm::greaterThanEqual(high + room, other.high));
  }
  double extent() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

// The corners of a triangle, in the object.
class Places {
 public:
  explicit Places(const Scene& scene) : scene_(scene) {}
  Corners of(const Shell& shell, std::uint32_t triangle) const {
    const SourcePart& part = scene_.parts[shell.part];
    const glm::dmat4x3 to_object(part.to_object);
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = to_object * glm::dvec4(part.soup.positions[part.soup.triangles[triangle].vertex[i]], 1);
    return corners;
  }

 private:
  const Scene& scene_;
};

// Sorts triangles by what `groupOf` says of each, and appends a shell for each group.
template <class GroupOf>
void appendShells(const Scene& scene, std::size_t part, const Places& places,
                  std::span<std::uint32_t> triangles, const GroupOf& groupOf, std::vector<Shell>& out) {
  const TriangleSoup& soup = scene.parts[part].soup;
  // A mirrored place turns triangles, and nobody sees that.
  const double sign = glm::determinant(glm::dmat3(glm::dmat4x3(scene.parts[part].to_object))) < 0 ? -1 : 1;
  std::ranges::stable_sort(triangles, std::less<>(), groupOf);
  for (std::size_t begin = 0, end = 0; begin < triangles.size(); begin = end) {
    while (end < triangles.size() && groupOf(triangles[end]) == groupOf(triangles[begin])) ++end;
    Shell& shell = out.emplace_back();
    shell.part = part;
    shell.triangles = triangles.subspan(begin, end - begin);
    // Around a point of its own: far from the origin the terms would cancel badly.
    const glm::dvec3 origin = places.of(shell, triangles[begin])[0];
    for (const std::uint32_t t : shell.triangles) {
      shell.single_sided = shell.single_sided && !scene.materials[soup.triangles[t].material].double_sided;
      const Corners at = places.of(shell, t);
      for (const glm::dvec3& corner : at) {
        shell.low = glm::min(shell.low, corner);
        shell.high = glm::max(shell.high, corner);
      }
      shell.volume += sign * glm::dot(at[0] - origin, glm::cross(at[1] - origin, at[2] - origin)) / 6;
    }
  }
}

// Sets of numbers from 0, joined step by step.
class Sets {
 public:
  explicit Sets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }
  std::uint32_t find(std::uint32_t at) {
    while (root_[at] != at) at = root_[at] = root_[root_[at]];
    return at;
  }
  void join(std::uint32_t a, std::uint32_t b) { root_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> root_;
};

// An edge: its lower corner and the higher, the triangle, and whether it runs upwards there.
struct Edge {
  std::uint64_t corners;
  std::uint32_t triangle;  // of the shell's
  bool upwards;
};
std::vector<Edge> sortedEdges(const TriangleSoup& soup, std::span<const std::uint32_t> triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t k = 0; k < triangles.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& vertex = soup.triangles[triangles[k]].vertex;
      const std::uint32_t from = vertex[i], to = vertex[(i + 1) % 3];
      edges.push_back({std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), k, from < to});
    }
  std::ranges::stable_sort(edges, std::less<>(), &Edge::corners);
  return edges;
}

// Appends the components of a part, whose triangles are one after the other in `order`. Triangles that share
// corners are one; where these are turned inside out as a whole, those that share edges: an outline may touch
// its body in a point.
void findShells(const Scene& scene, std::size_t index, const Places& places,
                std::vector<std::uint32_t>& order, std::vector<Shell>& out) {
  const TriangleSoup& soup = scene.parts[index].soup;
  Sets by_corner(soup.positions.size());
  for (const TriangleSoup::Triangle& triangle : soup.triangles)
    for (const std::size_t i : {1, 2}) by_corner.join(triangle.vertex[i], triangle.vertex[0]);
  order.resize(soup.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Shell> rough;
  appendShells(
      scene, index, places, order,
      [&](std::uint32_t t) { return by_corner.find(soup.triangles[t].vertex[0]); }, rough);
  std::vector<std::uint32_t> group(soup.triangles.size());
  std::size_t begin = 0;
  for (const Shell& shell : rough) {
    const std::span<std::uint32_t> its = std::span(order).subspan(begin, shell.triangles.size());
    begin += its.size();
    if (shell.volume >= 0) {
      out.push_back(shell);
      continue;
    }
    const std::vector<Edge> edges = sortedEdges(soup, its);
    Sets by_edge(its.size());
    for (std::size_t i = 1; i < edges.size(); ++i)
      if (edges[i].corners == edges[i - 1].corners) by_edge.join(edges[i].triangle, edges[i - 1].triangle);
    for (std::uint32_t k = 0; k < its.size(); ++k) group[its[k]] = by_edge.find(k);
    appendShells(
        scene, index, places, its, [&](std::uint32_t t) { return group[t]; }, out);
  }
}

// True if every edge is there as often in each direction.
bool isClosed(const Scene& scene, Shell& shell) {
  if (shell.closed) return *shell.closed;
  const std::vector<Edge> edges = sortedEdges(scene.parts[shell.part].soup, shell.triangles);
  for (std::size_t i = 0; i < edges.size();) {
    std::ptrdiff_t balance = 0;
    const std::uint64_t corners = edges[i].corners;
    for (; i < edges.size() && edges[i].corners == corners; ++i) balance += edges[i].upwards ? 1 : -1;
    if (balance != 0) return *(shell.closed = false);
  }
  return *(shell.closed = true);
}

// Twice the signed area of a, b and p seen along x. (b, a) gives exactly the negative of it, so that both
// triangles at an edge agree on which side of it a point is.
double sideOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
  if (std::tie(b.y, b.z) < std::tie(a.y, a.z)) return -sideOf(b, a, p);
  return (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
}

// How often a shell is wound around a point, in its own sense: crossings of a ray along +x.
int windingAt(const Shell& shell, const Places& places, const glm::dvec3& point) {
  int winding = 0;
  for (const std::uint32_t t : shell.triangles) {
    const Corners c = places.of(shell, t);
    if (std::max({c[0].x, c[1].x, c[2].x}) <= point.x) continue;
    const double sides[3] = {sideOf(c[0], c[1], point), sideOf(c[1], c[2], point), sideOf(c[2], c[0], point)};
    const bool left = std::ranges::all_of(sides, [](double s) { return s > 0; }),
               right = std::ranges::all_of(sides, [](double s) { return s < 0; });
    if (!left && !right) continue;
    const double sum = sides[0] + sides[1] + sides[2];
    const double x = (sides[1] * c[0].x + sides[2] * c[1].x + sides[0] * c[2].x) / sum;
    if (x > point.x) winding += left ? 1 : -1;
  }
  return winding;
}

// True if most of a shell is inside another whose box contains it.
bool isInside(const Shell& inner, const Shell& outer, const Places& places) {
  const std::size_t count = std::min(kWitnesses, inner.triangles.size());
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Corners at = places.of(inner, inner.triangles[i * inner.triangles.size() / count]);
    // No simple fractions of the sides: an edge seen end on is met by chance alone.
    if (windingAt(outer, places, 0.31 * at[0] + 0.33 * at[1] + 0.36 * at[2]) != 0) ++inside;
  }
  return 2 * inside > count;
}

std::string nameOf(const Scene& scene, const Shell& shell) {
  const std::uint32_t index = scene.parts[shell.part].soup.triangles[shell.triangles.front()].material;
  const std::string& name = scene.materials[index].name;
  return name.empty() ? fmt::format("materials[{}]", index) : "'" + name + "'";
}

// The soup without the triangles that are marked, and without the positions that only these had.
void removeTriangles(TriangleSoup& soup, const std::vector<bool>& removed) {
  const auto keep = [&](auto& list) {
    if (list.empty()) return;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < removed.size(); ++t)
      if (!removed[t]) list[kept++] = list[t];
    list.resize(kept);
  };
  keep(soup.uvs);
  for (auto& uvs : soup.more_uvs) keep(uvs);
  keep(soup.colors);
  keep(soup.skinned);
  keep(soup.triangles);
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> place(soup.positions.size(), kNone);
  std::vector<glm::vec3> positions;
  for (TriangleSoup::Triangle& triangle : soup.triangles)
    for (std::uint32_t& vertex : triangle.vertex) {
      if (place[vertex] == kNone) {
        place[vertex] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(soup.positions[vertex]);
      }
      vertex = place[vertex];
    }
  soup.positions = std::move(positions);
}

}  // namespace

void removeCulled(std::span<SourcePart> parts, const std::vector<SurfaceMaterial>& materials,
                  std::vector<std::string>& notices) {
  const Scene scene{parts, materials};
  const Places places(scene);
  std::vector<Shell> shells;
  std::vector<std::vector<std::uint32_t>> orders(scene.parts.size());
  for (std::size_t i = 0; i < scene.parts.size(); ++i) findShells(scene, i, places, orders[i], shells);
  std::ranges::stable_sort(shells, std::greater<>(), &Shell::extent);
  // The sign of the volume of an open one means nothing.
  const auto isTurned = [&](Shell& shell) {
    return shell.single_sided && shell.volume < 0 && isClosed(scene, shell);
  };
  // The first ones for which `inBox` is true.
  const auto anyOf = [&](const auto& inBox, const auto& test) {
    std::size_t tried = 0;
    for (Shell& other : shells) {
      if (!inBox(other)) continue;
      if (test(other)) return true;
      if (++tried == kMostTried) break;
    }
    return false;
  };
  std::vector<const Shell*> culled;
  std::size_t looked_at = 0;
  for (Shell& shell : shells) {
    if (!isTurned(shell) || ++looked_at > kMostShells) continue;
    const bool stands_around =
        anyOf([&](const Shell& other) { return &other != &shell && shell.contains(other, kBeyond); },
              [&](Shell& other) { return !isTurned(other) && isInside(other, shell, places); });
    const auto isWall = [&](Shell& other) {
      return isClosed(scene, other) && isInside(shell, other, places);
    };
    if (stands_around &&
        !anyOf([&](const Shell& other) { return other.volume > 0 && other.contains(shell, kRounding); },
               isWall))
      culled.push_back(&shell);
  }
  std::map<std::string, std::pair<std::size_t, glm::dvec3>> noted;  // by material: how many, the largest
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    std::vector<bool> removed(scene.parts[i].soup.triangles.size(), false);
    bool any = false;
    for (const Shell* const shell : culled) {
      if (shell->part != i) continue;
      any = true;
      for (const std::uint32_t t : shell->triangles) removed[t] = true;
      auto& [count, size] = noted[nameOf(scene, *shell)];
      if (++count == 1) size = shell->high - shell->low;
    }
    if (any) removeTriangles(parts[i].soup, removed);
  }
  for (const auto& [name, its] : noted)
    notices.push_back(fmt::format(
        "{} closed surface{} of {} (up to {:.3g} x {:.3g} x {:.3g}) of one side, turned inside out around "
        "something: viewers do not show that from outside, so it is left out; --keep-culled bakes it",
        its.first, its.first == 1 ? "" : "s", name, its.second.x, its.second.y, its.second.z));
}

}  // namespace kelp::bake
