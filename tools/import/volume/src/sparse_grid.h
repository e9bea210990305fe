// SPDX-License-Identifier: MIT
// What .vdb and .nvdb files hold: a tree over an endless lattice, of leaves of 8^3 voxels, tables whose cells
// are constant or a finer node, and a background everywhere else. Numbers are kept as they are in the file,
// and nothing of any library.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// Voxels beyond it are refused by the readers, so that sums of coordinates stay within 32 bits.
inline constexpr int kMaxCoordinate = 1 << 29;

enum class GridClass : std::uint8_t { kUnknown, kLevelSet, kFogVolume, kStaggered };
// kBinary: bool and mask, whose values are 0 and 1. kOther: points, texts, indices.
enum class GridKind : std::uint8_t { kScalar, kBinary, kVector, kPoints, kOther };

// What a file says of a grid before its voxels are read.
struct GridHeader {
  std::string name;  // fit for a message, and for --grid
  std::string type;  // the format's own word: "float", "half", "vec3s"
  GridClass grid_class = GridClass::kUnknown;
  GridKind kind = GridKind::kOther;
  std::uint64_t active = 0;  // voxels; of kinds that can be read
  bool empty = true;         // is its background everywhere
  // of the active voxels, both inclusive
  glm::ivec3 low{std::numeric_limits<int>::max()}, high{std::numeric_limits<int>::min()};
  bool linear = true;      // to_world says where it is; false for frustums
  bool raw = false;        // of a raw volume, which has no other: messages do not name it
  glm::dmat4 to_world{1};  // voxel centres are at whole numbers
};

// The numbers of a tree: floats where they hold every value exactly, else doubles. Or those of a raw volume,
// which are decoded from the file's bytes each time they are looked at.
class Numbers {
 public:
  using Decode = std::function<double(std::size_t i)>;

  explicit Numbers(bool wide = false) : wide_(wide) {}
  // decode(i) owns the bytes; `bytes`: how much memory they take. Such numbers cannot be set.
  Numbers(Decode decode, std::size_t bytes) : decode_(std::move(decode)), decoded_bytes_(bytes) {}

  std::size_t size() const { return wide_ ? doubles_.size() : floats_.size(); }
  double operator[](std::size_t i) const {
    if (decode_) return decode_(i);
    return wide_ ? doubles_[i] : static_cast<double>(floats_[i]);
  }
  void set(std::size_t i, double value) {
    wide_ ? void(doubles_[i] = value) : void(floats_[i] = static_cast<float>(value));
  }
  void resize(std::size_t size) { wide_ ? doubles_.resize(size) : floats_.resize(size); }
  std::size_t numberBytes() const { return wide_ ? sizeof(double) : sizeof(float); }
  std::size_t bytes() const { return decode_ ? decoded_bytes_ : size() * numberBytes(); }

 private:
  Decode decode_;
  std::size_t decoded_bytes_ = 0;
  bool wide_ = false;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

struct SparseGrid {
  static constexpr int kLeafLog2 = 3, kLowerLog2 = 4, kUpperLog2 = 5;       // nodes a side
  static constexpr int kLeafSide = 8, kLowerSide = 128, kUpperSide = 4096;  // voxels a side
  static constexpr std::size_t kLeafVoxels = 512;

  // Of tables and leaves, cells are numbered (x n + y) n + z. Numbers of cell i begin at numbers[first + i *
  // components].
  struct Leaf {
    glm::ivec3 low{0};
    std::array<std::uint64_t, 8> active{};
    std::size_t first = 0;
  };
  struct Table {
    glm::ivec3 low{0};
    std::vector<std::int32_t> child;    // of lower, of leaves; -1: the cell is constant
    std::vector<std::uint64_t> active;  // bits, of constant cells
    std::size_t first = 0;
  };
  struct Root {
    glm::ivec3 low{0};
    std::int32_t child = -1;  // of upper
    bool active = false;
    std::size_t first = 0;
  };

  int components = 1;  // 3 for vectors
  std::array<double, 3> background{};
  glm::dmat4 to_world{1};
  // Not 0: a raw volume, which has no tree: the voxels from (0, 0, 0) on, x fastest, all active.
  glm::ivec3 dense{0};
  std::vector<Root> roots;  // ascending by low (x, y, z), each once
  std::vector<Table> upper, lower;
  std::vector<Leaf> leaves;
  Numbers numbers;

  bool isDense() const { return dense.x > 0; }
  std::uint64_t bytes() const;
};

// A cube of lattice points that have one value: a constant cell, or a voxel of a leaf.
struct SparseCell {
  glm::ivec3 low{0};
  int side = 1;
  bool active = false;
  std::size_t first = 0;  // of its numbers; kBackground: there are none
  static constexpr std::size_t kBackground = std::numeric_limits<std::size_t>::max();
};

// Whether a place is one that trilinear interpolation may be asked for: finite, and near enough to the
// lattice.
inline bool onLattice(const glm::dvec3& place) {
  return std::abs(place.x) < kMaxCoordinate && std::abs(place.y) < kMaxCoordinate &&
         std::abs(place.z) < kMaxCoordinate;
}

// Looks values up; remembers where the last one was. One for each thread; the grid outlives it.
class SparseSampler {
 public:
  explicit SparseSampler(const SparseGrid& grid) : grid_(grid) {}

  SparseCell cellAt(const glm::ivec3& at) const;
  double value(const SparseCell& cell, int component = 0) const {
    return cell.first == SparseCell::kBackground
               ? grid_.background[static_cast<std::size_t>(component)]
               : grid_.numbers[cell.first + static_cast<std::size_t>(component)];
  }
  double at(const glm::ivec3& voxel) const { return value(cellAt(voxel)); }
  // Between voxel centres, which are at whole numbers: trilinear. The background where onLattice is false.
  double between(const glm::dvec3& place) const;

 private:
  const SparseGrid& grid_;
  mutable const SparseGrid::Leaf* leaf_ = nullptr;
};

// Every constant cell and every leaf once, in the file's order. A leaf comes as a cell of its 8 voxels' side,
// with its numbers in cellAt's order.
void visitCells(const SparseGrid& grid, const std::function<void(const SparseCell& cell)>& constant,
                const std::function<void(const SparseGrid::Leaf& leaf)>& leaf);

// Voxel i of a leaf.
inline glm::ivec3 leafVoxel(const SparseGrid::Leaf& leaf, std::size_t i) {
  return leaf.low +
         glm::ivec3(static_cast<int>(i >> 6), static_cast<int>(i >> 3 & 7), static_cast<int>(i & 7));
}

}  // namespace kelp::bake
