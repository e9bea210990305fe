// SPDX-License-Identifier: MIT
#include "truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

namespace kelp::test {
namespace {

constexpr double kCell = 4;  // voxels

glm::ivec3 cellOf(const glm::dvec3& p) { return glm::ivec3(glm::floor(p / kCell)); }

}  // namespace

double distanceToTriangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t, glm::dvec3& weights) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double twice = glm::dot(normal, normal);
  if (twice > 0) {
    glm::dvec3 w;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& a = t[static_cast<std::size_t>((k + 1) % 3)];
      const glm::dvec3& b = t[static_cast<std::size_t>((k + 2) % 3)];
      w[k] = glm::dot(glm::cross(b - a, p - a), normal) / twice;
    }
    if (w.x >= 0 && w.y >= 0 && w.z >= 0) {
      weights = w;
      return std::abs(glm::dot(p - t[0], normal)) / std::sqrt(twice);
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 side = t[(k + 1) % 3] - t[k];
    const double length = glm::dot(side, side);
    const double s = length > 0 ? std::clamp(glm::dot(p - t[k], side) / length, 0.0, 1.0) : 0.0;
    const double distance = glm::distance(p, t[k] + s * side);
    if (distance >= best) continue;
    best = distance;
    weights = glm::dvec3(0);
    weights[static_cast<int>(k)] = 1 - s;
    weights[static_cast<int>((k + 1) % 3)] = s;
  }
  return best;
}

MeshTruth::MeshTruth(const bake::TriangleSoup& soup, const bake::Frame& frame) {
  cells_ = frame.size / static_cast<int>(kCell) + 1;
  grid_.resize(static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y) *
               static_cast<std::size_t>(cells_.z));
  for (const bake::TriangleSoup::Triangle& triangle : soup.triangles) {
    std::array<glm::dvec3, 3> t;
    for (std::size_t c = 0; c < 3; ++c)
      t[c] =
          glm::dvec3(frame.node_to_voxel * glm::dvec4(glm::dvec3(soup.positions[triangle.vertex[c]]), 1.0));
    const glm::ivec3 last = cells_ - 1;
    const glm::ivec3 low = glm::clamp(cellOf(glm::min(glm::min(t[0], t[1]), t[2])), glm::ivec3(0), last);
    const glm::ivec3 high = glm::clamp(cellOf(glm::max(glm::max(t[0], t[1]), t[2])), glm::ivec3(0), last);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x)
          grid_[cell({x, y, z})].push_back(static_cast<std::uint32_t>(corners_.size()));
      }
    }
    corners_.push_back(t);
    total_area_ += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    area_up_to_.push_back(total_area_);
  }
  findPieces();
}

double MeshTruth::signedVolume() const {
  double sum = 0;
  for (const auto& t : corners_)
    sum += glm::dot(t[0] - corners_[0][0], glm::cross(t[1] - corners_[0][0], t[2] - corners_[0][0]));
  return sum / 6;
}

void MeshTruth::findPieces() {
  // Triangles take the lowest number among those at their corners until none changes.
  std::map<std::tuple<double, double, double>, std::uint32_t> places;
  std::vector<std::array<std::uint32_t, 3>> place(corners_.size());
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p = corners_[i][k];
      place[i][k] =
          places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places.size())).first->second;
    }
  }
  piece_.resize(corners_.size());
  for (std::uint32_t i = 0; i < piece_.size(); ++i) piece_[i] = i;
  std::vector<std::uint32_t> lowest(places.size(), static_cast<std::uint32_t>(corners_.size()));
  for (bool changed = true; changed;) {
    changed = false;
    const auto visit = [&](std::size_t i) {
      std::uint32_t number = piece_[i];
      for (const std::uint32_t at : place[i]) number = std::min(number, lowest[at]);
      for (const std::uint32_t at : place[i]) lowest[at] = number;
      changed = changed || number != piece_[i];
      piece_[i] = number;
    };
    for (std::size_t i = 0; i < piece_.size(); ++i) visit(i);
    for (std::size_t i = piece_.size(); i-- > 0;) visit(i);
  }
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t& piece : piece_)
    piece = number.try_emplace(piece, static_cast<std::uint32_t>(number.size())).first->second;
  pieces_ = number.size();
}

double MeshTruth::solidAngle(std::size_t triangle, const glm::dvec3& p) const {
  const auto& t = corners_[triangle];
  const glm::dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                        la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

double MeshTruth::winding(const glm::dvec3& p) const {
  double sum = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) sum += solidAngle(i, p);
  return sum / (4 * std::numbers::pi);
}

double MeshTruth::windingOfPieces(const glm::dvec3& p) const {
  std::vector<double> sum(pieces_, 0);
  for (std::size_t i = 0; i < corners_.size(); ++i) sum[piece_[i]] += solidAngle(i, p);
  double most = 0;
  for (const double s : sum) most = std::max(most, std::abs(s) / (4 * std::numbers::pi));
  return most;
}

NearestPoint MeshTruth::nearest(const glm::dvec3& p) const {
  NearestPoint best;
  best.distance = std::numeric_limits<double>::infinity();
  const glm::ivec3 home = glm::clamp(cellOf(p), glm::ivec3(0), cells_ - 1);
  const int widest = std::max({cells_.x, cells_.y, cells_.z});
  for (int shell = 0; shell <= widest; ++shell) {
    // Everything in this shell is at least so far away (points outside of the grid only farther).
    if (best.distance <= (shell - 1) * kCell) break;
    for (int z = std::max(0, home.z - shell); z <= std::min(cells_.z - 1, home.z + shell); ++z) {
      for (int y = std::max(0, home.y - shell); y <= std::min(cells_.y - 1, home.y + shell); ++y) {
        const bool face = std::abs(z - home.z) == shell || std::abs(y - home.y) == shell;
        for (int x = home.x - shell; x <= home.x + shell; x += face || shell == 0 ? 1 : 2 * shell) {
          if (x < 0 || x >= cells_.x) continue;
          for (const std::uint32_t i : grid_[cell({x, y, z})]) {
            glm::dvec3 weights;
            const double distance = distanceToTriangle(p, corners_[i], weights);
            if (distance < best.distance) best = {distance, i, weights};
          }
        }
      }
    }
  }
  return best;
}

std::vector<glm::dvec3> MeshTruth::sample(std::size_t count, std::uint32_t seed) const {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + unit(random)) / static_cast<double>(count) * total_area_;
    const std::size_t t =
        std::min(corners_.size() - 1,
                 static_cast<std::size_t>(std::lower_bound(area_up_to_.begin(), area_up_to_.end(), at) -
                                          area_up_to_.begin()));
    const double s = std::sqrt(unit(random)), r = unit(random);
    points.push_back((1 - s) * corners_[t][0] + s * (1 - r) * corners_[t][1] + s * r * corners_[t][2]);
  }
  return points;
}

std::size_t MeshTruth::openEdges() const {
  using Place = std::tuple<double, double, double>;
  std::map<std::pair<Place, Place>, int> edges;
  const auto place = [](const glm::dvec3& p) { return Place(p.x, p.y, p.z); };
  for (const auto& t : corners_) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place(t[k]), b = place(t[(k + 1) % 3]);
      ++edges[std::minmax(a, b)];
    }
  }
  return static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 2; }));
}

bake::Frame frameOf(const bake::TriangleSoup& soup, int resolution) {
  glm::dvec3 low(1e30), high(-1e30);
  for (const auto& triangle : soup.triangles) {
    for (const std::uint32_t v : triangle.vertex) {
      low = glm::min(low, glm::dvec3(soup.positions[v]));
      high = glm::max(high, glm::dvec3(soup.positions[v]));
    }
  }
  const glm::dvec3 extent = high - low;
  return bake::makeFrame(soup, Axis::kPlusY, std::max({extent.x, extent.y, extent.z}) / resolution, "test");
}

}  // namespace kelp::test
