// SPDX-License-Identifier: MIT
#include "culled.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
// The largest shells that are looked at, and of each the largest components in its box, and around it: no
// file needs as many, and the work stays in proportion to the file.
constexpr std::size_t kMostShells = 256, kMostTried = 64;

using Corners = std::array<glm::dvec3, 3>;

// Triangles that share corners, of one part.
struct Shell {
  std::size_t part = 0;
  std::span<const std::uint32_t> triangles;
  double volume = 0;             // signed: negative if it is turned inside out
  bool single_sided = true;      // all of it
  std::optional<bool> closed{};  // once it was asked for
  glm::dvec3 low{kInfinity}, high{-kInfinity};

  bool contains(const Shell& other) const {
    return glm::all(glm::lessThan(low, other.low)) && glm::all(glm::greaterThan(high, other.high));
  }
  double extent() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

// The corners of a triangle, in the object.
class Places {
 public:
  explicit Places(const SourceModel& model) : model_(model) {}
  Corners of(const Shell& shell, std::uint32_t triangle) const {
    const SourcePart& part = model_.parts[shell.part];
    const glm::dmat4x3 to_object(part.to_object);
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = to_object * glm::dvec4(part.soup.positions[part.soup.triangles[triangle].vertex[i]], 1);
    return corners;
  }

 private:
  const SourceModel& model_;
};

// Appends the components of a part, whose triangles are one after the other in `order`.
void findShells(const SourceModel& model, std::size_t index, const Places& places,
                std::vector<std::uint32_t>& order, std::vector<Shell>& out) {
  const TriangleSoup& soup = model.parts[index].soup;
  std::vector<std::uint32_t> root(soup.positions.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t vertex) {
    while (root[vertex] != vertex) vertex = root[vertex] = root[root[vertex]];
    return vertex;
  };
  for (const TriangleSoup::Triangle& triangle : soup.triangles)
    for (const std::size_t i : {1, 2}) root[find(triangle.vertex[i])] = find(triangle.vertex[0]);
  order.resize(soup.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto shellOf = [&](std::uint32_t t) { return find(soup.triangles[t].vertex[0]); };
  std::ranges::stable_sort(order, std::less<>(), shellOf);
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && shellOf(order[end]) == shellOf(order[begin])) ++end;
    Shell& shell = out.emplace_back();
    shell.part = index;
    shell.triangles = std::span(order).subspan(begin, end - begin);
    // Around a point of its own: far from the origin the terms would cancel badly.
    const glm::dvec3 origin = places.of(shell, order[begin])[0];
    for (const std::uint32_t t : shell.triangles) {
      shell.single_sided = shell.single_sided && !model.materials[soup.triangles[t].material].double_sided;
      const Corners at = places.of(shell, t);
      for (const glm::dvec3& corner : at) {
        shell.low = glm::min(shell.low, corner);
        shell.high = glm::max(shell.high, corner);
      }
      shell.volume += glm::dot(at[0] - origin, glm::cross(at[1] - origin, at[2] - origin)) / 6;
    }
  }
}

// True if every edge is there as often in each direction.
bool isClosed(const SourceModel& model, Shell& shell) {
  if (shell.closed) return *shell.closed;
  const TriangleSoup& soup = model.parts[shell.part].soup;
  std::vector<std::pair<std::uint64_t, bool>> edges;  // the lower corner and the higher; runs upwards
  for (const std::uint32_t t : shell.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = soup.triangles[t].vertex[i], to = soup.triangles[t].vertex[(i + 1) % 3];
      edges.emplace_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), from < to);
    }
  std::ranges::sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    std::ptrdiff_t balance = 0;
    for (; end < edges.size() && edges[end].first == edges[i].first; ++end)
      balance += edges[end].second ? 1 : -1;
    if (balance != 0) return *(shell.closed = false);
    i = end;
  }
  return *(shell.closed = true);
}

// Twice the signed area of a, b and p seen along x. The same for (b, a), but for its sign: a point beside an
// edge is beside it for both of its triangles.
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

std::string nameOf(const SourceModel& model, const Shell& shell) {
  const std::uint32_t index = model.parts[shell.part].soup.triangles[shell.triangles.front()].material;
  const std::string& name = model.materials[index].name;
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

void removeCulled(SourceModel& model) {
  const Places places(model);
  std::vector<Shell> shells;
  std::vector<std::vector<std::uint32_t>> orders(model.parts.size());
  for (std::size_t i = 0; i < model.parts.size(); ++i) findShells(model, i, places, orders[i], shells);
  std::ranges::stable_sort(shells, std::greater<>(), &Shell::extent);
  const auto isTurned = [](const Shell& shell) { return shell.single_sided && shell.volume < 0; };
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
        isClosed(model, shell) &&
        anyOf([&](const Shell& other) { return !isTurned(other) && shell.contains(other); },
              [&](const Shell& other) { return isInside(other, shell, places); });
    const auto isWall = [&](Shell& other) {
      return isClosed(model, other) && isInside(shell, other, places);
    };
    if (stands_around &&
        !anyOf([&](const Shell& other) { return other.volume > 0 && other.contains(shell); }, isWall))
      culled.push_back(&shell);
  }
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    std::vector<bool> removed(model.parts[i].soup.triangles.size(), false);
    bool any = false;
    for (const Shell* const shell : culled) {
      if (shell->part != i) continue;
      any = true;
      for (const std::uint32_t t : shell->triangles) removed[t] = true;
      const glm::dvec3 size = shell->high - shell->low;
      model.notices.push_back(fmt::format(
          "a closed surface of {} ({} triangles, {:.3g} x {:.3g} x {:.3g}) has one side, is turned inside "
          "out and stands around the rest: viewers do not show it from outside, so it is left out; "
          "--keep-culled "
          "bakes it",
          nameOf(model, *shell), shell->triangles.size(), size.x, size.y, size.z));
    }
    if (any) removeTriangles(model.parts[i].soup, removed);
  }
}

}  // namespace kelp::bake
