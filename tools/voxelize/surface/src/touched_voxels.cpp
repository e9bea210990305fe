// SPDX-License-Identifier: MIT
// A triangle and a cube have a point in common if no axis parts them (the separating axis theorem): not the
// three of the grid, not the triangle's normal, and none across a side of the triangle and an edge of the
// cube. The last are the sides of the triangle as seen along an axis, against a square. Columns of voxels run
// along the axis that the triangle faces most; the sides seen along it give the columns of a row, the plane
// the voxels of a column, of which there are at most three. Source: Schwarz and Seidel, "Fast Parallel
// Surface and Solid Voxelization on GPUs", 2010.
#include "kelp/voxelize/surface/touched_voxels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdlib>

#include "kelp/common/dense_index.h"
#include "kelp/common/parallel.h"

namespace kelp::bake {
namespace {

__extension__ using Int128 = __int128;

constexpr std::int64_t kUnit = std::int64_t{1} << kLatticeBits;
constexpr std::size_t kTrianglesAtOnce = 1024;
constexpr std::size_t kWordsAtOnce = 1 << 14;
// In a triangle that spans no more voxels than this, all products fit 64 bits: sides have 19 bits, the normal
// 39, and the plane's distances below 62.
constexpr std::int64_t kSmall = 32;

// A bit for each voxel of a box. Any thread may set bits.
class VoxelBits {
 public:
  explicit VoxelBits(const glm::ivec3& size) : size_(size), words_((denseCount(size) + 63) / 64) {}

  const glm::i64vec3& size() const { return size_; }
  void set(const glm::i64vec3& voxel) {
    const std::size_t index = static_cast<std::size_t>(voxel.x + size_.x * (voxel.y + size_.y * voxel.z));
    const std::uint64_t bit = std::uint64_t{1} << (index % 64);
    std::atomic<std::uint64_t>& word = words_[index / 64];
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }

  std::vector<std::uint64_t> indices(int threads) const {
    const std::size_t ranges = (words_.size() + kWordsAtOnce - 1) / kWordsAtOnce;
    std::vector<std::size_t> first(ranges + 1, 0);
    parallelRanges(words_.size(), kWordsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
      std::size_t count = 0;
      for (std::size_t i = begin; i < end; ++i) count += static_cast<std::size_t>(std::popcount(wordAt(i)));
      first[begin / kWordsAtOnce + 1] = count;
    });
    for (std::size_t range = 0; range < ranges; ++range) first[range + 1] += first[range];
    std::vector<std::uint64_t> found(first.back());
    parallelRanges(words_.size(), kWordsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
      std::size_t at = first[begin / kWordsAtOnce];
      for (std::size_t i = begin; i < end; ++i) {
        for (std::uint64_t word = wordAt(i); word != 0; word &= word - 1)
          found[at++] = i * 64 + static_cast<std::size_t>(std::countr_zero(word));
      }
    });
    return found;
  }

 private:
  std::uint64_t wordAt(std::size_t i) const { return words_[i].load(std::memory_order_relaxed); }

  glm::i64vec3 size_;
  std::vector<std::atomic<std::uint64_t>> words_;
};

// The sides of a triangle as seen along an axis; p = axis + 1 and q = axis + 2 (modulo 3). For each side a
// number that is linear in the place of a square of the grid, and below 0 if all of the square lies beyond
// the side. A triangle that is seen edge-on is a line there, with sides in both directions.
struct SeenSides {
  std::int64_t start[3], step_p[3], step_q[3];

  SeenSides(const glm::i64vec3 (&corner)[3], int axis) {
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    const glm::i64vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const std::int64_t turn = ab[p] * ac[q] - ab[q] * ac[p] < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      const glm::i64vec3 &from = corner[k], &to = corner[(k + 1) % 3];
      const std::int64_t dp = turn * (to[p] - from[p]), dq = turn * (to[q] - from[q]);
      step_p[k] = -dq * kUnit;
      step_q[k] = dp * kUnit;
      // At the corner of the square that lies deepest inside the side.
      start[k] = dq * from[p] - dp * from[q] + std::max<std::int64_t>(0, step_p[k]) +
                 std::max<std::int64_t>(0, step_q[k]);
    }
  }

  bool reach(std::int64_t p, std::int64_t q) const {
    return start[0] + step_p[0] * p + step_q[0] * q >= 0 && start[1] + step_p[1] * p + step_q[1] * q >= 0 &&
           start[2] + step_p[2] * p + step_q[2] * q >= 0;
  }

  // Of the squares [first, last] of row q, those that reach inside all sides.
  void narrow(std::int64_t q, std::int64_t& first, std::int64_t& last) const {
    for (int k = 0; k < 3; ++k) {
      const std::int64_t row = start[k] + step_q[k] * q, step = step_p[k];
      if (step > 0) {
        if (row + step * first < 0) first = (-row + step - 1) / step;
      } else if (step < 0) {
        if (row + step * last < 0) last = row < 0 ? first - 1 : row / -step;
      } else if (row < 0) {
        last = first - 1;
      }
    }
  }
};

template <class Wide>
Wide floorOf(Wide dividend, Wide divisor) {
  const Wide quotient = dividend / divisor;
  return dividend % divisor < 0 ? quotient - 1 : quotient;
}

class Rasterizer {
 public:
  explicit Rasterizer(VoxelBits& bits) : bits_(bits) {}

  void add(const glm::i64vec3& a, const glm::i64vec3& b, const glm::i64vec3& c) {
    const glm::i64vec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    int wide_axes = 0;
    for (int k = 0; k < 3; ++k) {
      // A corner on the face between two voxels touches both.
      base_[k] = ((low[k] + kUnit - 1) >> kLatticeBits) - 1;
      last_[k] = (high[k] >> kLatticeBits) - base_[k];
      from_[k] = std::max<std::int64_t>(0, -base_[k]);
      to_[k] = std::min<std::int64_t>(last_[k], bits_.size()[k] - 1 - base_[k]);
      if (from_[k] > to_[k]) return;
      wide_axes += last_[k] > 0 ? 1 : 0;
    }
    if (wide_axes <= 1 || low == high) return setAll();
    const glm::i64vec3 origin = base_ * kUnit;
    const glm::i64vec3 corner[3] = {a - origin, b - origin, c - origin};
    if (std::max({last_.x, last_.y, last_.z}) < kSmall)
      fill<std::int64_t>(corner);
    else
      fill<Int128>(corner);
  }

 private:
  // A triangle in a row of voxels reaches from its first to its last; a point touches all that it may.
  void setAll() {
    glm::i64vec3 v;
    for (v.z = from_.z; v.z <= to_.z; ++v.z)
      for (v.y = from_.y; v.y <= to_.y; ++v.y)
        for (v.x = from_.x; v.x <= to_.x; ++v.x) bits_.set(base_ + v);
  }

  // The normal of a plane that holds the triangle, and along which axis it is longest.
  static glm::i64vec3 normalOf(const glm::i64vec3 (&corner)[3], int& axis) {
    const glm::i64vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    glm::i64vec3 normal(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
    if (normal == glm::i64vec3(0)) {
      // A line lies in many planes. One that is level along the second axis, and tilts by the least from the
      // longest axis to the shortest.
      const glm::i64vec3 bc = corner[2] - corner[1];
      const auto length = [](const glm::i64vec3& side) {
        return std::max({std::abs(side.x), std::abs(side.y), std::abs(side.z)});
      };
      const glm::i64vec3& side = length(ab) >= length(ac) && length(ab) >= length(bc) ? ab
                                 : length(ac) >= length(bc)                           ? ac
                                                                                      : bc;
      const glm::i64vec3 size = glm::abs(side);
      const int longest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const int one = (longest + 1) % 3, other = (longest + 2) % 3;
      axis = size[one] <= size[other] ? one : other;
      normal[axis] = side[longest];
      normal[longest] = -side[axis];
    } else {
      const glm::i64vec3 size = glm::abs(normal);
      axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    }
    return normal[axis] < 0 ? -normal : normal;
  }

  template <class Wide>
  void fill(const glm::i64vec3 (&corner)[3]) {
    int w;
    const glm::i64vec3 normal = normalOf(corner, w);
    const int u = (w + 1) % 3, v = (w + 2) % 3;
    const SeenSides along_w(corner, w), along_u(corner, u), along_v(corner, v);
    // The plane's highest place over a column, and how far it falls across it, in units of 1 / `whole` voxel.
    const Wide whole = Wide{normal[w]} * kUnit, step_u = Wide{-normal[u]} * kUnit,
               step_v = Wide{-normal[v]} * kUnit;
    const Wide fall = (step_u < 0 ? -step_u : step_u) + (step_v < 0 ? -step_v : step_v);
    const Wide start = Wide{normal.x} * corner[0].x + Wide{normal.y} * corner[0].y +
                       Wide{normal.z} * corner[0].z + std::max(Wide{0}, step_u) + std::max(Wide{0}, step_v);
    for (std::int64_t row = from_[v]; row <= to_[v]; ++row) {
      std::int64_t first = from_[u], last = to_[u];
      along_w.narrow(row, first, last);
      if (first > last) continue;
      const Wide place = start + step_u * first + step_v * row;
      std::int64_t top = static_cast<std::int64_t>(floorOf(place, whole));
      Wide above = place - whole * top;
      for (std::int64_t column = first; column <= last; ++column) {
        std::int64_t bottom = top;
        for (Wide below = above - fall - 1; below < 0; below += whole) --bottom;
        const std::int64_t lowest = std::max<std::int64_t>(bottom, 0), highest = std::min(top, last_[w]);
        // The triangle has a point in the column, and all of those lie from the lowest to the highest.
        const bool sure = lowest == highest;
        for (std::int64_t k = std::max(lowest, from_[w]); k <= std::min(highest, to_[w]); ++k) {
          if (!sure && !(along_u.reach(row, k) && along_v.reach(k, column))) continue;
          glm::i64vec3 voxel;
          voxel[u] = column;
          voxel[v] = row;
          voxel[w] = k;
          bits_.set(base_ + voxel);
        }
        above += step_u;
        for (; above < 0; above += whole) --top;
        for (; above >= whole; above -= whole) ++top;
      }
    }
  }

  VoxelBits& bits_;
  // Of the triangle at hand: the voxel that all others are counted from, the last one, and those in the box.
  glm::i64vec3 base_{0}, last_{0}, from_{0}, to_{0};
};

}  // namespace

std::vector<std::uint64_t> touchedVoxels(const Topology& mesh, const glm::ivec3& size, int threads,
                                         const std::function<bool(const SolidTriangle&)>& accept) {
  VoxelBits bits(size);
  parallelRanges(mesh.triangles.size(), kTrianglesAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    Rasterizer rasterizer(bits);
    for (std::size_t i = begin; i < end; ++i) {
      const SolidTriangle& triangle = mesh.triangles[i];
      if (triangle.source == kCap || (accept && !accept(triangle))) continue;
      rasterizer.add(mesh.lattice[triangle.vertex[0]], mesh.lattice[triangle.vertex[1]],
                     mesh.lattice[triangle.vertex[2]]);
    }
  });
  return bits.indices(threads);
}

}  // namespace kelp::bake
