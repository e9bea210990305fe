// SPDX-License-Identifier: MIT
#include "kelp/voxelize/topology/fill_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>

#include "bucket_sort.h"
#include "kelp/voxelize/topology/topology.h"

namespace kelp::bake {
namespace {

// Sets of vertices that boundary edges join.
class Rims {
 public:
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::uint64_t count() const { return count_; }

 private:
  std::uint32_t find(std::uint32_t vertex) {
    count_ += parent_.try_emplace(vertex, vertex).second;
    for (std::uint32_t up = parent_[vertex]; up != vertex; up = parent_[vertex])
      vertex = parent_[vertex] = parent_[up];
    return vertex;
  }
  std::unordered_map<std::uint32_t, std::uint32_t> parent_;
  std::uint64_t count_ = 0;
};

double percent(double part, double whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

// Two digits, and no exponents: "0.0066", "2.2", "17", "100".
std::string printPercent(double percent) {
  if (percent > 0 && percent < 0.001) return "less than 0.001";
  return percent < 10 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}

// The holes of a sheet, and the share that would have been closed.
std::string holesOf(double least, double most) {
  const std::string range = std::round(least) < std::round(most)
                                ? fmt::format("{:.0f} to {:.0f}", least, most)
                                : fmt::format("{:.0f}", most);
  return fmt::format("holes of {} % of {} surface, up to {:.0f} % are closed", range,
                     std::round(least) < std::round(most) ? "their" : "its", 100 * kMaxHoleShare);
}

std::string countHoles(std::uint64_t holes) { return fmt::format("{} hole{}", holes, holes == 1 ? "" : "s"); }

// Closed, but with no room inside: as where each face is there from both sides, and its quads are cut along
// two diagonals, so that no triangle is another one turned.
bool enclosesNothing(const Component& c) {
  constexpr double kThickness = 1e-4;  // voxels, in the mean
  return c.closed && !c.wall && c.area > 0 && std::abs(c.volume) < kThickness * c.area;
}

bool isCut(const Component& c) { return !c.solid && c.cut_area > 0 && c.cut_area >= kMaxCutShare * c.area; }

std::string whyOf(const Component& c, Fill fill) {
  if (fill == Fill::kSurface) return "surface as asked";
  if (c.wall) return fill == Fill::kSolid ? "solid as asked" : "a wall modeled from both sides";
  if (enclosesNothing(c)) return "closed, but encloses nothing: its faces are there from both sides";
  if (isCut(c))
    return fmt::format("{} % of its surface is cut out", printPercent(percent(c.cut_area, c.area)));
  if (c.closed) return "closed";
  if (c.solid)
    return fmt::format("{}{} closed by fans ({} % of its surface)",
                       fill == Fill::kSolid ? "solid as asked: " : "", countHoles(c.diagnosis.holes),
                       printPercent(percent(c.cap_area, c.area)));
  const double share = percent(c.cap_area, c.area);
  return "open: " + holesOf(share, share);
}

}  // namespace

MeshCounts countMesh(const TriangleSoup& soup, int threads) {
  MeshCounts counts;
  counts.vertices = soup.positions.size();
  counts.triangles = soup.triangles.size();
  counts.dropped = soup.dropped;
  using Ends = std::array<std::uint32_t, 2>;
  const auto make = [&](const auto& take) {
    for (const TriangleSoup::Triangle& triangle : soup.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(triangle.vertex[i], triangle.vertex[(i + 1) % 3]);
        take(low, Ends{low, high});
      }
    }
  };
  const std::vector<Ends> edges = sortedByVertex<Ends>(soup.positions.size(), threads, make, std::less<>());
  Rims rims;
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    if (end - begin > 2) ++counts.non_manifold_edges;
    if (end - begin == 1) {
      ++counts.boundary_edges;
      rims.join(edges[begin][0], edges[begin][1]);
    }
    begin = end;
  }
  counts.boundaries = rims.count();
  return counts;
}

FillCounts countFill(const Topology& mesh, std::uint64_t triangles) {
  FillCounts counts;
  counts.components = mesh.components.size();
  for (const Component& component : mesh.components) {
    counts.closed += component.closed;
    counts.walls += component.wall;
    counts.sheets += !component.solid && !component.wall;
    counts.capped += component.solid && !component.closed;
    counts.diagnosis += component.diagnosis;
  }
  counts.cap_triangles = mesh.caps;
  counts.doubled = triangles - (mesh.triangles.size() - mesh.caps);
  counts.turned = static_cast<std::uint64_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                    [](const SolidTriangle& t) { return t.source != kCap && t.swapped; }));
  return counts;
}

std::string summarizeFill(const Topology& mesh, Fill fill) {
  std::size_t closed = 0, capped = 0, sheets = 0, walls = 0, hollow = 0, cut = 0;
  std::uint64_t holes = 0;
  double area = 0, cap_area = 0, least = 1e30, most = 0;
  for (const Component& c : mesh.components) {
    if (c.wall) {
      ++walls;
      continue;
    }
    closed += c.closed;
    hollow += enclosesNothing(c);
    if (isCut(c)) {
      ++cut;
    } else if (!c.solid) {
      ++sheets;
      least = std::min(least, percent(c.cap_area, c.area));
      most = std::max(most, percent(c.cap_area, c.area));
    } else if (!c.closed) {
      ++capped;
      holes += c.diagnosis.holes;
      area += c.area;
      cap_area += c.cap_area;
    }
  }
  const std::size_t total = mesh.components.size() - walls;
  if (fill == Fill::kSurface)
    return fmt::format("surface: as asked ({} of {} component{} closed)", closed, total,
                       total == 1 ? "" : "s");
  std::string text =
      fmt::format("{}: {}{} of {} component{} closed", sheets + cut == total ? "surface" : "solid",
                  fill == Fill::kSolid ? "as asked, " : "", closed, total, total == 1 ? "" : "s");
  if (hollow > 0)
    text += fmt::format(", {} enclose{} nothing (faces from both sides)", hollow, hollow == 1 ? "s" : "");
  if (cut > 0) text += fmt::format(", {} with cut-outs kept as surface", cut);
  if (capped > 0)
    text += fmt::format(", {} with {} closed by fans ({} % of {} surface)", capped, countHoles(holes),
                        printPercent(percent(cap_area, area)), capped == 1 ? "its" : "their");
  if (sheets > 0)
    text += fmt::format(", {} open sheet{} kept as surface ({})", sheets, sheets == 1 ? "" : "s",
                        holesOf(least, most));
  if (walls > 0) text += fmt::format(", {} wall{} modeled from both sides", walls, walls == 1 ? "" : "s");
  return text;
}

std::vector<ComponentReport> describeComponents(const Topology& mesh, Fill fill) {
  std::vector<std::size_t> order(mesh.components.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return mesh.components[a].area > mesh.components[b].area;
  });
  double area = 0;
  for (const Component& c : mesh.components) area += c.area;
  std::vector<ComponentReport> described;
  for (std::size_t i = 0; i < std::min(order.size(), kMaxComponentReports); ++i) {
    const Component& c = mesh.components[order[i]];
    described.push_back(
        {c.triangles, area > 0 ? c.area / area : 0.0, c.solid && c.area > 0, c.diagnosis, whyOf(c, fill)});
  }
  return described;
}

}  // namespace kelp::bake
