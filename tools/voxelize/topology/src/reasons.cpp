// SPDX-License-Identifier: MIT
#include "kelp/voxelize/topology/reasons.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace kelp::bake {
namespace {

double percent(double part, double whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

// Two digits, and no exponents: "0.0066", "2.2", "17", "100".
std::string printPercent(double percent) {
  if (percent > 0 && percent < 0.001) return "less than 0.001";
  return percent < 10 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
}

// Which holes a sheet has, beside what would have been capped.
std::string holesOf(double least, double most) {
  const std::string range = std::round(least) < std::round(most)
                                ? fmt::format("{:.0f} to {:.0f}", least, most)
                                : fmt::format("{:.0f}", most);
  return fmt::format("holes of {} % of {} surface, up to {:.0f} % are capped", range,
                     std::round(least) < std::round(most) ? "their" : "its", 100 * kMaxHoleShare);
}

// Closed, but with no room inside: as where each face is there from both sides, and its quads are cut along
// two diagonals, so that no triangle is another one turned.
bool enclosesNothing(const Component& c) {
  constexpr double kThickness = 1e-4;  // voxels, in the mean
  return c.closed && !c.wall && c.area > 0 && std::abs(c.volume) < kThickness * c.area;
}

std::string whyOf(const Component& c, Fill fill) {
  if (c.area == 0) return "thinner than the lattice: kept as lines and points";
  if (fill == Fill::kSurface) return "surface as asked";
  if (c.wall) return fill == Fill::kSolid ? "solid as asked" : "a wall modelled from both sides";
  if (enclosesNothing(c)) return "closed, but encloses nothing: its faces are there from both sides";
  if (c.closed) return "closed";
  if (c.solid)
    return fmt::format("{}holes of {} % of its surface were capped",
                       fill == Fill::kSolid ? "solid as asked: " : "",
                       printPercent(percent(c.cap_area, c.area)));
  const double share = percent(c.cap_area, c.area);
  return "open: " + holesOf(share, share);
}

}  // namespace

std::string summariseFill(const Topology& mesh, Fill fill) {
  std::size_t closed = 0, capped = 0, sheets = 0, walls = 0, lines = 0, hollow = 0;
  double area = 0, cap_area = 0, least = 1e30, most = 0;
  for (const Component& c : mesh.components) {
    if (c.wall) {
      ++walls;
      continue;
    }
    if (c.area == 0) {
      ++lines;
      continue;
    }
    closed += c.closed;
    hollow += enclosesNothing(c);
    if (!c.solid) {
      ++sheets;
      least = std::min(least, percent(c.cap_area, c.area));
      most = std::max(most, percent(c.cap_area, c.area));
    } else if (!c.closed) {
      ++capped;
      area += c.area;
      cap_area += c.cap_area;
    }
  }
  const std::size_t total = mesh.components.size() - walls - lines;
  const std::string thinner =
      lines > 0 ? fmt::format(", {} thinner than the lattice kept as lines and points", lines)
                : std::string();
  if (fill == Fill::kSurface)
    return fmt::format("surface: as asked ({} of {} component{} closed{})", closed, total,
                       total == 1 ? "" : "s", thinner);
  std::string text =
      fmt::format("{}: {}{} of {} component{} closed", sheets == total ? "surface" : "solid",
                  fill == Fill::kSolid ? "as asked, " : "", closed, total, total == 1 ? "" : "s");
  if (hollow > 0)
    text += fmt::format(", {} enclose{} nothing (faces from both sides)", hollow, hollow == 1 ? "s" : "");
  if (capped > 0)
    text += fmt::format(", {} with holes capped ({} % of {} surface)", capped,
                        printPercent(percent(cap_area, area)), capped == 1 ? "its" : "their");
  if (sheets > 0)
    text += fmt::format(", {} open sheet{} kept as surface ({})", sheets, sheets == 1 ? "" : "s",
                        holesOf(least, most));
  if (walls > 0) text += fmt::format(", {} wall{} modelled from both sides", walls, walls == 1 ? "" : "s");
  return text + thinner;
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
