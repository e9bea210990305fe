// SPDX-License-Identifier: MIT
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace kelp::bake {
namespace {

using SampleTriangle = std::array<std::uint32_t, 3>;
using Weighted = SkinSamples::Weighted;
constexpr double kLongestEdge = 3;  // units
constexpr std::uint32_t kNone = 0xffffffffu;

// The points while they are made: each with its own list of weighted points.
struct Points {
  std::vector<glm::dvec3> positions;
  std::vector<std::vector<Weighted>> weighted;
  std::vector<SampleTriangle> triangles;
};

double areaOf(const Points& points, const SampleTriangle& t) {
  const glm::dvec3& a = points.positions[t[0]];
  return 0.5 * glm::length(glm::cross(points.positions[t[1]] - a, points.positions[t[2]] - a));
}

std::vector<Weighted> weightedPoints(const SourceSkin& skin, std::uint32_t vertex, const glm::dvec3& at) {
  std::vector<Weighted> list;
  for (std::uint32_t i = skin.first_influence[vertex]; i < skin.first_influence[vertex + 1]; ++i) {
    const SourceSkin::Influence& influence = skin.influences[i];
    const glm::dvec4 x = static_cast<double>(influence.weight) * glm::dvec4(at, 1);
    const auto same = std::find_if(list.begin(), list.end(),
                                   [&](const Weighted& other) { return other.joint == influence.joint; });
    if (same == list.end())
      list.push_back({influence.joint, x});
    else
      same->x += x;
  }
  std::sort(list.begin(), list.end(), [](const Weighted& a, const Weighted& b) { return a.joint < b.joint; });
  // Weights are floats: their sum differs from one by rounding.
  double sum = 0;
  for (const Weighted& w : list) sum += w.x.w;
  for (Weighted& w : list) w.x /= sum;
  return list;
}

// Vertices that share a cell of so many units become one, the first.
std::vector<std::uint32_t> clusters(const std::vector<glm::dvec3>& positions, double cell) {
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::uint32_t> first;
  std::vector<std::uint32_t> of(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const glm::dvec3 at = glm::floor(positions[i] / cell);
    of[i] = first
                .try_emplace({static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y),
                              static_cast<std::int64_t>(at.z)},
                             i)
                .first->second;
  }
  return of;
}

// The vertices of the soup that triangles use. Too many are joined.
Points basePoints(const TriangleSoup& soup, const SourceSkin& skin, const SkinSpace& space,
                  std::size_t most) {
  std::vector<glm::dvec3> positions;
  positions.reserve(soup.positions.size());
  for (const glm::vec3& at : soup.positions)
    positions.emplace_back(space.from_soup * glm::dvec4(glm::dvec3(at), 1));
  std::vector<std::uint32_t> cluster(positions.size());
  std::iota(cluster.begin(), cluster.end(), 0u);
  for (double cell = 0.5; positions.size() > most; cell *= 1.5) {
    cluster = clusters(positions, cell);
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < cluster.size(); ++i) kept += cluster[i] == i;
    if (kept <= most) break;
  }
  Points points;
  std::vector<std::uint32_t> place(positions.size(), kNone);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    SampleTriangle triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = soup.triangles[t].vertex[c];
      std::uint32_t& at = place[cluster[vertex]];
      if (at == kNone) {
        at = static_cast<std::uint32_t>(points.positions.size());
        points.positions.push_back(positions[vertex]);
        points.weighted.push_back(weightedPoints(skin, soup.skinned[t][c], positions[vertex]));
      }
      triangle[c] = at;
    }
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      points.triangles.push_back(triangle);
  }
  return points;
}

std::vector<Weighted> middleOf(const std::vector<Weighted>& a, const std::vector<Weighted>& b) {
  std::vector<Weighted> sum;
  sum.reserve(a.size() + b.size());
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    if (j == b.size() || (i < a.size() && a[i].joint < b[j].joint)) {
      sum.push_back({a[i].joint, 0.5 * a[i].x});
      ++i;
    } else if (i == a.size() || b[j].joint < a[i].joint) {
      sum.push_back({b[j].joint, 0.5 * b[j].x});
      ++j;
    } else {
      sum.push_back({a[i].joint, 0.5 * (a[i].x + b[j].x)});
      ++i, ++j;
    }
  }
  return sum;
}

using EdgeKey = std::pair<std::uint32_t, std::uint32_t>;
EdgeKey edgeKey(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

// A triangle whose edge i, from corner i, is cut at mids[i], unless that is kNone.
void cutTriangle(SampleTriangle t, SampleTriangle mids, std::vector<SampleTriangle>& out) {
  const auto turn = [&] {
    t = {t[1], t[2], t[0]};
    mids = {mids[1], mids[2], mids[0]};
  };
  const auto cuts = std::count_if(mids.begin(), mids.end(), [](std::uint32_t mid) { return mid != kNone; });
  if (cuts == 0) {
    out.push_back(t);
  } else if (cuts == 3) {
    out.push_back({t[0], mids[0], mids[2]});
    out.push_back({mids[0], t[1], mids[1]});
    out.push_back({mids[2], mids[1], t[2]});
    out.push_back(mids);
  } else if (cuts == 1) {
    while (mids[0] == kNone) turn();
    out.push_back({t[0], mids[0], t[2]});
    out.push_back({mids[0], t[1], t[2]});
  } else {
    while (mids[2] != kNone) turn();
    out.push_back({mids[0], t[1], mids[1]});
    out.push_back({t[0], mids[0], mids[1]});
    out.push_back({t[0], mids[1], t[2]});
  }
}

// Halves edges longer than `longest`. False if there are none, or if there would be more than `most` points.
bool refineOnce(Points& points, double longest, std::size_t most) {
  std::vector<EdgeKey> cut;
  for (const SampleTriangle& t : points.triangles)
    for (std::size_t c = 0; c < 3; ++c)
      if (glm::distance(points.positions[t[c]], points.positions[t[(c + 1) % 3]]) > longest)
        cut.push_back(edgeKey(t[c], t[(c + 1) % 3]));
  std::sort(cut.begin(), cut.end());
  cut.erase(std::unique(cut.begin(), cut.end()), cut.end());
  if (cut.empty() || points.positions.size() + cut.size() > most) return false;
  const auto first = static_cast<std::uint32_t>(points.positions.size());
  for (const auto& [a, b] : cut) {
    points.positions.push_back(0.5 * (points.positions[a] + points.positions[b]));
    points.weighted.push_back(middleOf(points.weighted[a], points.weighted[b]));
  }
  std::vector<SampleTriangle> triangles;
  triangles.reserve(points.triangles.size() * 2);
  for (const SampleTriangle& t : points.triangles) {
    SampleTriangle mids{};
    for (std::size_t c = 0; c < 3; ++c) {
      const EdgeKey key = edgeKey(t[c], t[(c + 1) % 3]);
      const auto at = std::lower_bound(cut.begin(), cut.end(), key);
      mids[c] = at != cut.end() && *at == key ? first + static_cast<std::uint32_t>(at - cut.begin()) : kNone;
    }
    cutTriangle(t, mids, triangles);
  }
  points.triangles = std::move(triangles);
  return true;
}

void addNeighbors(SkinSamples& samples) {
  // Where edges are cut again and again they become short; the strips beside them do not.
  constexpr double kShortest = 0.3, kLeastWidth = 0.05;
  std::vector<std::pair<EdgeKey, double>> sides;
  for (const SampleTriangle& t : samples.triangles) {
    const glm::dvec3& a = samples.positions[t[0]];
    const double area =
        0.5 * glm::length(glm::cross(samples.positions[t[1]] - a, samples.positions[t[2]] - a));
    samples.area += area;
    for (std::size_t c = 0; c < 3; ++c) {
      samples.areas[t[c]] += area / 3;
      sides.emplace_back(edgeKey(t[c], t[(c + 1) % 3]), area);
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < sides.size();) {
    const auto [a, b] = sides[i].first;
    double area = 0;
    for (const EdgeKey key = sides[i].first; i < sides.size() && sides[i].first == key; ++i)
      area += sides[i].second;
    const double length = std::max(kShortest, glm::distance(samples.positions[a], samples.positions[b]));
    samples.edges.push_back({a, b, area * 2 / 3 / length + kLeastWidth});
  }
  samples.first_neighbor.assign(samples.size() + 1, 0);
  for (const SkinSamples::Edge& edge : samples.edges) {
    ++samples.first_neighbor[edge.a + 1];
    ++samples.first_neighbor[edge.b + 1];
  }
  std::partial_sum(samples.first_neighbor.begin(), samples.first_neighbor.end(),
                   samples.first_neighbor.begin());
  samples.neighbors.resize(samples.edges.size() * 2);
  std::vector<std::size_t> next = samples.first_neighbor;
  for (const SkinSamples::Edge& edge : samples.edges) {
    samples.neighbors[next[edge.a]++] = {edge.b, edge.width};
    samples.neighbors[next[edge.b]++] = {edge.a, edge.width};
  }
}

}  // namespace

SkinSpace skinSpace(const Frame& frame) {
  SkinSpace space;
  space.voxels = std::max({frame.size.x, frame.size.y, frame.size.z}) / kSkinSide;
  space.from_soup = frame.node_to_voxel;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) space.from_soup[column][row] /= space.voxels;
  space.to_soup = glm::inverse(space.from_soup);
  return space;
}

double SkinSamples::weight(std::size_t i, std::uint32_t joint) const {
  for (std::size_t k = first_weighted[i]; k < first_weighted[i + 1]; ++k)
    if (weighted[k].joint == joint) return weighted[k].x.w;
  return 0;
}

std::uint32_t SkinSamples::heaviestJoint(std::size_t i) const {
  std::size_t best = first_weighted[i];
  for (std::size_t k = best + 1; k < first_weighted[i + 1]; ++k)
    if (weighted[k].x.w > weighted[best].x.w) best = k;
  return weighted[best].joint;
}

SkinSamples makeSkinSamples(const TriangleSoup& soup, const SourceSkin& skin, const SkinSpace& space,
                            std::size_t most) {
  Points points = basePoints(soup, skin, space, most);
  double area = 0;
  for (const SampleTriangle& t : points.triangles) area += areaOf(points, t);
  // Half as many points as triangles, which are about equilateral.
  const double coarsest = std::sqrt(area / (0.25 * static_cast<double>(most)));
  constexpr int kMostPasses = 24;
  for (int pass = 0; pass < kMostPasses && refineOnce(points, std::max(kLongestEdge, coarsest), most);)
    ++pass;
  SkinSamples samples;
  samples.positions = std::move(points.positions);
  samples.triangles = std::move(points.triangles);
  samples.areas.assign(samples.size(), 1e-9);
  samples.first_weighted.push_back(0);
  for (const std::vector<Weighted>& list : points.weighted) {
    samples.weighted.insert(samples.weighted.end(), list.begin(), list.end());
    samples.first_weighted.push_back(samples.weighted.size());
  }
  addNeighbors(samples);
  return samples;
}

}  // namespace kelp::bake
