// SPDX-License-Identifier: MIT
#include "kelp/formats/empty_boxes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include <glm/common.hpp>

#include "eight_codes.h"

namespace kelp {
namespace {

constexpr std::size_t kReaches = 4;                    // 2^k - 1 for k = 0 .. 3
using Slices = std::array<std::uint64_t, kBrickSide>;  // bit x + 8 y of [z]
using Window = std::array<std::uint64_t, kBoxWindow>;  // of [z + kBoxReach]

// The 64 codes, the best first: by the shortest of their three reaches, then the middle one, then the
// longest, then by number.
constexpr auto kPreferred = [] {
  std::array<std::uint8_t, 64> codes{};
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<std::uint8_t>(i);
  const auto worth = [](std::uint8_t code) {
    std::array<int, 3> k{code & 3, code >> 2 & 3, code >> 4};
    std::sort(k.begin(), k.end());
    return (k[0] << 4 | k[1] << 2 | k[2]) << 6 | (63 - code);
  };
  std::sort(codes.begin(), codes.end(), [&](std::uint8_t a, std::uint8_t b) { return worth(a) > worth(b); });
  return codes;
}();

// Slices of a row of three bricks, moved along x or y within the row: what lies `by` voxels further on, or
// before. here: a slice of a brick; the other one of the brick after, or before it.
struct AlongX {
  template <std::size_t by>
  static std::uint64_t further(std::uint64_t here, std::uint64_t after) {
    constexpr std::uint64_t kHere = 0xff >> by, kEach = 0x0101010101010101u * kHere;
    return (here >> by & kEach) | (after << (8 - by) & ~kEach);
  }
  template <std::size_t by>
  static std::uint64_t before(std::uint64_t ahead, std::uint64_t here) {
    return further<8 - by>(ahead, here);
  }
};
struct AlongY {
  template <std::size_t by>
  static std::uint64_t further(std::uint64_t here, std::uint64_t after) {
    return here >> (8 * by) | after << (64 - 8 * by);
  }
  template <std::size_t by>
  static std::uint64_t before(std::uint64_t ahead, std::uint64_t here) {
    return further<8 - by>(ahead, here);
  }
};

// For k = 0 .. 3: the union of all voxels within 2^k - 1 of each voxel of the middle brick. Runs of 2^k
// voxels double from one k to the next, and two of them cover the 2^(k+1) - 1 around one. run: is used up.
template <class Axis, std::size_t k = 0, std::size_t count>
void spread(std::array<std::array<std::uint64_t, count>, 3>& run,
            std::array<std::array<std::uint64_t, count>, kReaches>& near) {
  constexpr std::size_t kLength = std::size_t{1} << k;
  for (std::size_t i = 0; i < count; ++i) {
    near[k][i] = run[1][i];
    if constexpr (k > 0) near[k][i] |= Axis::template before<kLength - 1>(run[0][i], run[1][i]);
  }
  if constexpr (k + 1 < kReaches) {
    for (std::size_t i = 0; i < count; ++i) {
      run[0][i] |= Axis::template further<kLength>(run[0][i], run[1][i]);
      run[1][i] |= Axis::template further<kLength>(run[1][i], run[2][i]);
      run[2][i] |= Axis::template further<kLength>(run[2][i], 0);
    }
    spread<Axis, k + 1>(run, near);
  }
}
// The same along z, over the slices of a window.
void spread(Window& run, std::array<Slices, kReaches>& near) {
  for (std::size_t k = 0; k < kReaches; ++k) {
    const std::size_t length = std::size_t{1} << k;
    for (std::size_t z = 0; z < kBrickSide; ++z)
      near[k][z] = run[z + kBoxReach] | run[z + kBoxReach - (length - 1)];
    if (k + 1 == kReaches) break;
    for (std::size_t z = 0; z + length < kBoxWindow; ++z) run[z] |= run[z + length];
  }
}

}  // namespace

// Which voxels have a solid one in the box of each code, eight rows at a time; then the codes from the best
// on take the voxels that they fit.
void chooseBoxes(const BoxWindow& window, std::span<std::uint8_t, kBrickVoxels> codes) {
  constexpr std::size_t kRows = 3 * kBoxWindow;
  std::array<std::array<std::uint64_t, kRows>, 3> along_x;  // no std::bit_cast: libc++ 13 lacks it
  static_assert(sizeof along_x == sizeof window.slices);
  std::memcpy(&along_x, &window.slices, sizeof along_x);
  std::array<std::array<std::uint64_t, kRows>, kReaches> near_x;
  spread<AlongX>(along_x, near_x);
  std::array<Slices, 64> blocked;
  for (std::size_t kx = 0; kx < kReaches; ++kx) {
    std::array<Window, 3> along_y;
    static_assert(sizeof along_y == sizeof near_x[kx]);
    std::memcpy(&along_y, &near_x[kx], sizeof along_y);
    std::array<Window, kReaches> near_y;
    spread<AlongY>(along_y, near_y);
    for (std::size_t ky = 0; ky < kReaches; ++ky) {
      std::array<Slices, kReaches> near_z;
      spread(near_y[ky], near_z);
      for (std::size_t kz = 0; kz < kReaches; ++kz) blocked[kx | ky << 2 | kz << 4] = near_z[kz];
    }
  }

  std::array<Slices, 6> bits{};  // of the codes
  for (std::size_t z = 0; z < kBrickSide; ++z) {
    std::uint64_t open = ~blocked[0][z];
    for (std::size_t i = 0; open != 0; ++i) {
      const std::uint8_t code = kPreferred[i];
      const std::uint64_t fits = open & ~blocked[code][z];
      if (fits == 0) continue;
      open ^= fits;
      for (std::size_t bit = 0; bit < 6; ++bit) bits[bit][z] |= code >> bit & 1 ? fits : 0;
    }
  }
  for (std::size_t row = 0; row < 64; ++row) {
    const auto eightOf = [&](const Slices& slices_of) {
      return static_cast<std::uint8_t>(slices_of[row / 8] >> (8 * (row % 8)));
    };
    const std::uint64_t solid = kBytesOfBits[eightOf(blocked[0])] * 0xff;
    std::uint64_t eight;
    std::memcpy(&eight, &codes[8 * row], sizeof eight);
    eight &= solid;
    for (std::size_t bit = 0; bit < 6; ++bit) eight |= kBytesOfBits[eightOf(bits[bit])] << bit;
    std::memcpy(&codes[8 * row], &eight, sizeof eight);
  }
}

namespace {

// How many bricks of each region of a grid are solid, in part or whole.
class BrickSums {
 public:
  // sums: of all bricks below (x, y, z), one more than bricks along each axis.
  BrickSums(std::span<const std::uint32_t> cells, const glm::ivec3& grid, std::span<std::uint32_t> sums)
      : grid_(grid), sums_(sums) {
    std::fill(sums.begin(), sums.end(), 0u);
    std::size_t cell = 0;
    for (int z = 0; z < grid.z; ++z) {
      for (int y = 0; y < grid.y; ++y) {
        std::uint32_t row = 0;
        for (int x = 0; x < grid.x; ++x) {
          row += cells[cell++] >> 31;
          sums_[index(x + 1, y + 1, z + 1)] =
              row + sums_[index(x + 1, y, z + 1)] + sums_[index(x + 1, y + 1, z)] - sums_[index(x + 1, y, z)];
        }
      }
    }
  }

  // Bits 0 to 23 of the cell of an empty brick.
  std::uint32_t grownBox(const glm::ivec3& brick) const {
    glm::ivec3 low = brick, high = brick;
    glm::ivec3 grow_low(1), grow_high(1);  // 1 for each side that still moves: all have gone as far
    // A slab only widens while the other sides grow: a side that cannot move once never will. And sides that
    // are not stopped in the next rounds can take them all at once.
    for (int round = 0; round < kCellMaxReach && grow_low + grow_high != glm::ivec3(0);) {
      int rounds = 0;
      for (int more = 8; more > 0; more /= 2) {
        const int tried = rounds + more;
        if (round + tried <= kCellMaxReach && count(low - tried * grow_low, high + tried * grow_high) == 0)
          rounds = tried;
      }
      low -= rounds * grow_low;
      high += rounds * grow_high;
      round += rounds;
      if (round++ < kCellMaxReach) growOnce(low, high, grow_low, grow_high);
    }
    std::uint32_t box = 0;
    for (int axis = 0; axis < 3; ++axis)
      box |= static_cast<std::uint32_t>(brick[axis] - low[axis]) << (8 * axis) |
             static_cast<std::uint32_t>(high[axis] - brick[axis]) << (8 * axis + 4);
    return box;
  }

 private:
  // One round, side by side; sides that are stopped grow no more.
  void growOnce(glm::ivec3& low, glm::ivec3& high, glm::ivec3& grow_low, glm::ivec3& grow_high) const {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 from = low, to = high;  // the slab beyond a side
      if (grow_low[axis] != 0) {
        from[axis] = to[axis] = low[axis] - 1;
        grow_low[axis] = count(from, to) == 0 ? 1 : 0;
        low[axis] -= grow_low[axis];
      }
      from = low, to = high;
      if (grow_high[axis] != 0) {
        from[axis] = to[axis] = high[axis] + 1;
        grow_high[axis] = count(from, to) == 0 ? 1 : 0;
        high[axis] += grow_high[axis];
      }
    }
  }
  // Bricks in the box from low to high, both included, that are solid; outside the grid there is nothing.
  std::uint32_t count(glm::ivec3 low, glm::ivec3 high) const {
    low = glm::max(low, glm::ivec3(0));
    high = glm::min(high + 1, grid_);
    if (low.x >= high.x || low.y >= high.y || low.z >= high.z) return 0;
    const auto plane = [&](int z) {
      return sums_[index(high.x, high.y, z)] - sums_[index(low.x, high.y, z)] -
             sums_[index(high.x, low.y, z)] + sums_[index(low.x, low.y, z)];
    };
    return plane(high.z) - plane(low.z);
  }
  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(grid_.x + 1) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(grid_.y + 1) * static_cast<std::size_t>(z));
  }

  glm::ivec3 grid_;
  std::span<std::uint32_t> sums_;
};

}  // namespace

Result<void> growBoxes(std::span<std::uint32_t> cells, const glm::ivec3& grid, const Allocator& allocator) {
  Buffer<std::uint32_t> memory(allocator);
  if (!memory.reset(std::uint64_t{static_cast<std::uint32_t>(grid.x) + 1} *
                    (static_cast<std::uint32_t>(grid.y) + 1) * (static_cast<std::uint32_t>(grid.z) + 1)))
    return Error{ErrorCode::kOutOfMemory, "no memory for a grid"};
  const BrickSums sums(cells, grid, memory.span());
  std::size_t cell = 0;
  glm::ivec3 brick;
  for (brick.z = 0; brick.z < grid.z; ++brick.z) {
    for (brick.y = 0; brick.y < grid.y; ++brick.y) {
      for (brick.x = 0; brick.x < grid.x; ++brick.x, ++cell) {
        if (!(cells[cell] & kCellSolid)) cells[cell] = (cells[cell] & ~0xffffffu) | sums.grownBox(brick);
      }
    }
  }
  return {};
}

}  // namespace kelp
