// SPDX-License-Identifier: MIT
#include "lines.h"

#include <algorithm>
#include <tuple>

namespace kelp::bake {
namespace {

struct Line {
  std::uint32_t low = 0, high = 0;  // equal: a point
  std::uint32_t triangle = 0;

  auto place() const { return std::tie(low, high); }
};

// Sorted, each place once.
class LineSet {
 public:
  explicit LineSet(std::vector<Line> lines) : lines_(std::move(lines)) {
    std::sort(lines_.begin(), lines_.end(), [](const Line& a, const Line& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    lines_.erase(std::unique(lines_.begin(), lines_.end(),
                             [](const Line& a, const Line& b) { return a.place() == b.place(); }),
                 lines_.end());
    covered_.resize(lines_.size(), false);
  }
  void cover(std::uint32_t a, std::uint32_t b) {
    const Line line{std::min(a, b), std::max(a, b), 0};
    const auto at = std::lower_bound(lines_.begin(), lines_.end(), line,
                                     [](const Line& x, const Line& y) { return x.place() < y.place(); });
    if (at != lines_.end() && at->place() == line.place())
      covered_[static_cast<std::size_t>(at - lines_.begin())] = true;
  }
  template <class Visit>
  void forEachLone(const Visit& visit) const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (!covered_[i]) visit(lines_[i]);
    }
  }

 private:
  std::vector<Line> lines_;
  std::vector<bool> covered_;
};

}  // namespace

void keepLoneLines(const Topology& mesh, std::vector<bool>& dropped) {
  std::vector<Line> lines, points;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& v = mesh.triangles[i].vertex;
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) continue;
    const auto [low, high] = std::minmax({v[0], v[1], v[2]});
    (low == high ? points : lines).push_back({low, high, i});
  }
  if (lines.empty() && points.empty()) return;
  LineSet lone_lines(std::move(lines)), lone_points(std::move(points));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (dropped[i]) continue;
    const auto& v = mesh.triangles[i].vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      lone_lines.cover(v[k], v[(k + 1) % 3]);
      lone_points.cover(v[k], v[k]);
    }
  }
  lone_lines.forEachLone([&](const Line& line) {
    dropped[line.triangle] = false;
    lone_points.cover(line.low, line.low);
    lone_points.cover(line.high, line.high);
  });
  lone_points.forEachLone([&](const Line& point) { dropped[point.triangle] = false; });
}

}  // namespace kelp::bake
