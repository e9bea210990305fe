// SPDX-License-Identifier: MIT
#include "kelp/voxelize/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>

#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

constexpr std::int64_t kUnit = std::int64_t{1} << kLatticeBits;
// Crossings of triangles with scanlines that all threads together hold at a time; each thread also holds
// those of one column.
constexpr std::size_t kMostCrossings = std::size_t{1} << 22;

struct Crossing {
  std::uint32_t column = 0;
  std::uint32_t component = 0;
  double depth = 0;  // voxels along the scanline
  int sign = 0;      // +1 enters the component, -1 leaves it
  bool cap = false;

  bool operator<(const Crossing& other) const {
    if (column != other.column) return column < other.column;
    if (depth != other.depth) return depth < other.depth;
    if (component != other.component) return component < other.component;
    return sign < other.sign;
  }
};

// Of a component, along a scanline.
struct Winding {
  std::uint32_t component = 0;
  int number = 0;
  double since = 0;  // where it became that
};

// First pixel whose center is at or beyond a lattice coordinate.
std::int64_t firstCenter(std::int64_t lattice) { return (lattice - kUnit / 2 + kUnit - 1) >> kLatticeBits; }

// First voxel whose center is at or beyond `depth`.
int firstCenter(double depth, int count) {
  return static_cast<int>(std::clamp(std::ceil(depth - 0.5), 0.0, static_cast<double>(count)));
}

// A scanline on an edge belongs to the side that a step of (1, epsilon) leads to: the same for all triangles,
// so that a closed mesh is entered exactly as often as it is left.
bool ownsEdge(std::int64_t du, std::int64_t dv) { return dv < 0 || (dv == 0 && du > 0); }

// The scanlines of one axis: `axis` runs along them, u = axis + 1 and v = axis + 2 (modulo 3) number the
// columns.
class Scanner {
 public:
  // `most`: crossings that are held at a time, but for those of a single column.
  Scanner(const Topology& mesh, const glm::ivec3& size, int axis, std::size_t most,
          std::vector<std::uint8_t>& voxels, std::vector<Scanned>& scanned)
      : mesh_(mesh),
        size_(size),
        axis_(axis),
        u_((axis + 1) % 3),
        v_((axis + 2) % 3),
        most_(most),
        voxels_(voxels),
        scanned_(scanned),
        winding_of_(mesh.components.size(), kNone) {
    const std::size_t stride[3] = {1, static_cast<std::size_t>(size.x),
                                   static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)};
    stride_ = stride[axis_];
    stride_u_ = stride[u_];
    stride_v_ = stride[v_];
  }

  // Rows [begin, end) of v. Slabs of rows touch no voxel of each other.
  void scan(const std::vector<std::uint32_t>& triangles, int begin, int end) {
    scan(triangles, {0, size_[u_], begin, end});
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Columns [u0, u1) of rows [v0, v1).
  struct Patch {
    int u0, u1, v0, v1;
  };

  // Many triangles that lie over each other are scanned in halves of halves: no column touches another's
  // voxels.
  void scan(const std::vector<std::uint32_t>& triangles, const Patch& patch) {
    crossings_.clear();
    for (const std::uint32_t i : triangles) {
      rasterize(mesh_.triangles[i], patch);
      if (crossings_.size() <= most_) continue;
      const int columns = patch.u1 - patch.u0, rows = patch.v1 - patch.v0;
      if (rows > 1) {
        scan(triangles, {patch.u0, patch.u1, patch.v0, patch.v0 + rows / 2});
        return scan(triangles, {patch.u0, patch.u1, patch.v0 + rows / 2, patch.v1});
      }
      if (columns > 1) {
        scan(triangles, {patch.u0, patch.u0 + columns / 2, patch.v0, patch.v1});
        return scan(triangles, {patch.u0 + columns / 2, patch.u1, patch.v0, patch.v1});
      }
    }
    std::sort(crossings_.begin(), crossings_.end());
    for (std::size_t at = 0; at < crossings_.size();) {
      std::size_t next = at;
      while (next < crossings_.size() && crossings_[next].column == crossings_[at].column) ++next;
      fillColumn(at, next, patch.v0);
      at = next;
    }
  }

  void rasterize(const SolidTriangle& triangle, const Patch& patch) {
    glm::i64vec3 a = mesh_.lattice[triangle.vertex[0]], b = mesh_.lattice[triangle.vertex[1]],
                 c = mesh_.lattice[triangle.vertex[2]];
    std::int64_t area = (b[u_] - a[u_]) * (c[v_] - a[v_]) - (b[v_] - a[v_]) * (c[u_] - a[u_]);
    if (area == 0) return;
    // Seen from the scanline's far end: a triangle that turns left faces it, and is where the scanline
    // leaves.
    const int sign = area > 0 ? -1 : 1;
    if (area < 0) {
      std::swap(b, c);
      area = -area;
    }
    const std::int64_t u0 = std::max<std::int64_t>(patch.u0, firstCenter(std::min({a[u_], b[u_], c[u_]})));
    const std::int64_t u1 =
        std::min<std::int64_t>(patch.u1 - 1, (std::max({a[u_], b[u_], c[u_]}) - kUnit / 2) >> kLatticeBits);
    const std::int64_t v0 = std::max<std::int64_t>(patch.v0, firstCenter(std::min({a[v_], b[v_], c[v_]})));
    const std::int64_t v1 =
        std::min<std::int64_t>(patch.v1 - 1, (std::max({a[v_], b[v_], c[v_]}) - kUnit / 2) >> kLatticeBits);
    const glm::i64vec3* corner[3] = {&a, &b, &c};
    std::int64_t row[3], step_u[3], step_v[3], bias[3];
    for (int k = 0; k < 3; ++k) {
      // Edge function of the side opposite to corner k: twice the area of the triangle it makes with the
      // scanline.
      const glm::i64vec3& p = *corner[(k + 1) % 3];
      const glm::i64vec3& q = *corner[(k + 2) % 3];
      const std::int64_t du = q[u_] - p[u_], dv = q[v_] - p[v_];
      row[k] = du * (v0 * kUnit + kUnit / 2 - p[v_]) - dv * (u0 * kUnit + kUnit / 2 - p[u_]);
      step_u[k] = -dv * kUnit;
      step_v[k] = du * kUnit;
      bias[k] = ownsEdge(du, dv) ? 0 : 1;
    }
    for (std::int64_t v = v0; v <= v1; ++v) {
      std::int64_t w[3] = {row[0], row[1], row[2]};
      for (std::int64_t u = u0; u <= u1; ++u) {
        if (w[0] >= bias[0] && w[1] >= bias[1] && w[2] >= bias[2]) {
          const double depth = (static_cast<double>(w[0]) * static_cast<double>(a[axis_]) +
                                static_cast<double>(w[1]) * static_cast<double>(b[axis_]) +
                                static_cast<double>(w[2]) * static_cast<double>(c[axis_])) /
                               static_cast<double>(area) * kLatticeStep;
          const std::uint32_t column = static_cast<std::uint32_t>(u + (v - patch.v0) * size_[u_]);
          crossings_.push_back({column, triangle.component, depth, sign, triangle.source == kCap});
        }
        for (int k = 0; k < 3; ++k) w[k] += step_u[k];
      }
      for (int k = 0; k < 3; ++k) row[k] += step_v[k];
    }
  }

  // The inside along a column, up to some crossing. Bodies that touch are one stretch: no voxel is kept for
  // the seam between them.
  struct Inside {
    int bodies = 0;      // that the scanline is in
    double start = 0;    // where it came in
    bool drawn = false;  // more than caps bound the stretch
    // The stretch before, which the next one may go on with.
    bool pending = false, pending_drawn = false;
    double from = 0, to = -1e30;
    std::uint32_t left = kCap;  // the component at its end
  };

  // The crossings [at, next) are those of one column; `begin` is the first row of the patch.
  void fillColumn(std::size_t at, std::size_t next, int begin) {
    const std::size_t column = crossings_[at].column;
    std::uint8_t* line =
        voxels_.data() + (column % static_cast<std::size_t>(size_[u_])) * stride_u_ +
        (static_cast<std::size_t>(begin) + column / static_cast<std::size_t>(size_[u_])) * stride_v_;
    forgetWindings();
    Inside inside;
    for (std::size_t i = at; i < next; ++i) {
      const Crossing& crossing = crossings_[i];
      if (!mesh_.components[crossing.component].solid) {
        keep(line, crossing.depth);
      } else {
        cross(crossing, inside, line);
      }
    }
    if (inside.pending) fillStretch(line, inside.from, inside.to, inside.pending_drawn);
  }

  // The scanline enters or leaves a solid component.
  void cross(const Crossing& crossing, Inside& inside, std::uint8_t* line) {
    const int before = inside.bodies, change = wind(crossing);
    inside.bodies += change;
    if (change != 0) {
      Scanned& its = scanned_[crossing.component];
      ++its.faces;
      if (before > 0 && inside.bodies > 0) ++its.shared;
    }
    const bool touches =
        inside.pending && (before == 0 ? crossing.depth : inside.start) <= inside.to + kLatticeStep;
    if (before == 0 && inside.bodies > 0) {
      inside.start = crossing.depth;
      inside.drawn = false;
      if (touches && inside.left != crossing.component) {
        ++scanned_[inside.left].shared;
        ++scanned_[crossing.component].shared;
      }
    }
    inside.drawn = inside.drawn || !crossing.cap;
    if (before == 0 || inside.bodies > 0) return;
    if (!touches) {
      if (inside.pending) fillStretch(line, inside.from, inside.to, inside.pending_drawn);
      inside.from = inside.start;
      inside.pending = true;
      inside.pending_drawn = false;
    }
    inside.pending_drawn = inside.pending_drawn || inside.drawn;
    inside.to = crossing.depth;
    inside.left = crossing.component;
  }

  // Counts the crossing in the component's winding number. Answers by how many bodies the scanline is deeper
  // inside after it: 1, 0 or -1.
  int wind(const Crossing& crossing) {
    Winding& winding = windingOf(crossing.component);
    const bool enters = winding.number == 0;
    if (!enters && axis_ == 0) count(winding, crossing.depth);
    winding.since = crossing.depth;
    winding.number += crossing.sign;
    return enters ? 1 : winding.number == 0 ? -1 : 0;
  }

  void count(const Winding& winding, double until) {
    const std::int64_t length = std::llround((until - winding.since) * static_cast<double>(kUnit));
    Scanned& its = scanned_[winding.component];
    its.centers += firstCenter(until, size_[axis_]) - firstCenter(winding.since, size_[axis_]);
    its.length += length;
    its.wound += winding.number * length;
  }

  void fillStretch(std::uint8_t* line, double from, double to, bool drawn) {
    const int first = firstCenter(from, size_[axis_]);
    const int end = firstCenter(to, size_[axis_]);
    if (first >= end) {
      if (drawn) keep(line, (from + to) * 0.5);  // between two caps there is nothing that could be lost
    } else if (axis_ == 0) {                     // one axis fills; the others look for what it missed
      std::fill(line + first, line + end, static_cast<std::uint8_t>(kInside));
    }
  }

  void keep(std::uint8_t* line, double depth) {
    const int at =
        static_cast<int>(std::clamp(std::floor(depth), 0.0, static_cast<double>(size_[axis_] - 1)));
    std::uint8_t& voxel = line[static_cast<std::size_t>(at) * stride_];
    if (voxel == kEmpty) voxel = kKept;
  }

  Winding& windingOf(std::uint32_t component) {
    std::uint32_t& at = winding_of_[component];
    if (at == kNone) {
      at = static_cast<std::uint32_t>(windings_.size());
      windings_.push_back({component});
    }
    return windings_[at];
  }

  void forgetWindings() {
    for (const Winding& winding : windings_) winding_of_[winding.component] = kNone;
    windings_.clear();
  }

  const Topology& mesh_;
  glm::ivec3 size_;
  int axis_, u_, v_;
  std::size_t most_;
  std::size_t stride_ = 0, stride_u_ = 0, stride_v_ = 0;
  std::vector<std::uint8_t>& voxels_;
  std::vector<Crossing> crossings_;
  std::vector<Winding> windings_;
  std::vector<Scanned>& scanned_;
  std::vector<std::uint32_t> winding_of_;  // by component
};

}  // namespace

std::vector<Scanned> fillScanlines(const Topology& mesh, const glm::ivec3& size, int threads,
                                   std::vector<std::uint8_t>& voxels) {
  std::vector<Scanned> scanned(mesh.components.size());
  std::mutex scanned_mutex;
  const std::size_t most = kMostCrossings / static_cast<std::size_t>(std::max(threadCount(threads), 1));
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    // Slabs of about a million columns bound the memory of the crossings; at least 16, for the threads.
    const int rows = std::clamp((1 << 20) / size[u], 1, std::max(1, size[v] / 16));
    const std::size_t slabs = static_cast<std::size_t>((size[v] + rows - 1) / rows);
    std::vector<std::vector<std::uint32_t>> bins(slabs);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      std::int64_t low = mesh.lattice[mesh.triangles[i].vertex[0]][v], high = low;
      for (const std::uint32_t vertex : mesh.triangles[i].vertex) {
        low = std::min(low, mesh.lattice[vertex][v]);
        high = std::max(high, mesh.lattice[vertex][v]);
      }
      const std::int64_t first = std::clamp<std::int64_t>(firstCenter(low), 0, size[v]);
      const std::int64_t last = std::clamp<std::int64_t>((high - kUnit / 2) >> kLatticeBits, -1, size[v] - 1);
      for (std::int64_t slab = first / rows; first <= last && slab <= last / rows; ++slab)
        bins[static_cast<std::size_t>(slab)].push_back(i);
    }
    parallelRanges(slabs, 1, threads, [&](std::size_t begin, std::size_t end) {
      std::vector<Scanned> here(mesh.components.size());
      Scanner scanner(mesh, size, axis, most, voxels, here);
      for (std::size_t slab = begin; slab < end; ++slab) {
        const int row = static_cast<int>(slab) * rows;
        scanner.scan(bins[slab], row, std::min(size[v], row + rows));
      }
      const std::lock_guard<std::mutex> lock(scanned_mutex);
      for (std::size_t i = 0; i < here.size(); ++i) {
        scanned[i].faces += here[i].faces;
        scanned[i].shared += here[i].shared;
        scanned[i].centers += here[i].centers;
        scanned[i].length += here[i].length;
        scanned[i].wound += here[i].wound;
      }
    });
  }
  return scanned;
}

}  // namespace kelp::bake
