// SPDX-License-Identifier: MIT
// A volume as the rest of this room sees it, whichever library or file holds its numbers: a tree over an
// endless lattice, of leaves of 8^3 voxels, cubes of one value, and a background everywhere else.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace kelp::bake {

// Voxels beyond it are refused by the readers, so that sums of coordinates stay within 32 bits.
inline constexpr int kMaxCoordinate = 1 << 29;

enum class GridClass : std::uint8_t { kUnknown, kLevelSet, kFogVolume, kStaggered };
// kBinary: bool and mask, whose values are 0 and 1. kOther: texts, indices, unknown types.
enum class GridKind : std::uint8_t { kScalar, kBinary, kVector, kPoints, kOther };

// A grid as its file lists it.
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
  glm::dmat4 to_world{1};  // voxel centers are at whole numbers
};

// A cube of voxels that have one value: a tile, or a voxel.
struct VolumeCell {
  glm::ivec3 low{0};
  int side = 1;
  bool active = false;
  glm::dvec3 value{0};  // of numbers: x
};

// The 8^3 voxels from `low` on, numbered (x * 8 + y) * 8 + z.
struct VolumeLeaf {
  glm::ivec3 low{0};
  const double* values = nullptr;  // 512

  glm::ivec3 voxel(std::size_t i) const {
    return low + glm::ivec3(static_cast<int>(i >> 6), static_cast<int>(i >> 3 & 7), static_cast<int>(i & 7));
  }
};

// Looks values up; remembers where the last one was. One for each thread.
class VolumeLookup {
 public:
  virtual ~VolumeLookup() = default;
  virtual VolumeCell cellAt(const glm::ivec3& at) const = 0;
  virtual double at(const glm::ivec3& voxel) const = 0;  // of numbers
};

// The numbers of a grid. Safe for many threads.
class VolumeTree {
 public:
  virtual ~VolumeTree() = default;
  virtual std::unique_ptr<VolumeLookup> lookup() const = 0;
  // Of numbers: every cell of one value, and every leaf, once.
  virtual void visit(const std::function<void(const VolumeCell& cell)>& constant,
                     const std::function<void(const VolumeLeaf& leaf)>& leaf) const = 0;
  virtual std::uint64_t bytes() const = 0;
};

struct VolumeGrid {
  static constexpr int kLeafSide = 8, kLowerSide = 128, kUpperSide = 4096;  // voxels a side
  static constexpr std::size_t kLeafVoxels = 512;

  std::shared_ptr<const VolumeTree> tree;
  double background = 0;  // of numbers
  glm::dmat4 to_world{1};
  // Not 0: a raw volume, which has no tree: the voxels from (0, 0, 0) on, x fastest, all active.
  glm::ivec3 dense{0};
  bool as_asked = false;                    // its voxels were made for the settings: they are kept
  std::shared_ptr<const VolumeGrid> color;  // of points that have colors
  std::vector<std::string> notices;         // of the making

  bool isDense() const { return dense.x > 0; }
  std::uint64_t bytes() const { return tree->bytes() + (color ? color->bytes() : 0); }
};

// True if trilinear interpolation works at a place: its coordinates are finite, and near enough to the
// lattice.
inline bool onLattice(const glm::dvec3& place) {
  return std::abs(place.x) < kMaxCoordinate && std::abs(place.y) < kMaxCoordinate &&
         std::abs(place.z) < kMaxCoordinate;
}

// A lookup that can be copied. One for each thread; the grid outlives it.
class VolumeSampler {
 public:
  explicit VolumeSampler(const VolumeGrid& grid) : grid_(&grid), lookup_(grid.tree->lookup()) {}
  VolumeSampler(const VolumeSampler& other) : VolumeSampler(*other.grid_) {}
  VolumeSampler& operator=(const VolumeSampler&) = delete;

  VolumeCell cellAt(const glm::ivec3& at) const { return lookup_->cellAt(at); }
  double at(const glm::ivec3& voxel) const { return lookup_->at(voxel); }
  // Between voxel centers, which are at whole numbers: trilinear. The background where onLattice is false.
  double between(const glm::dvec3& place) const;

 private:
  const VolumeGrid* grid_;
  std::unique_ptr<VolumeLookup> lookup_;
};

}  // namespace kelp::bake
