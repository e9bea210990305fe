// SPDX-License-Identifier: MIT
// Compares cages with the voxels that they bend.
#include "verify/deep_level.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/common/dense_index.h"

namespace kelp::dump {
namespace {

// The kind of each cube of a cage. A cube without cells is inside if the one beside it without cells is.
class Cubes {
 public:
  explicit Cubes(const Cage& cage)
      : cage_(cage), kinds_(denseCount(cage.grid), Kind::kUnknown), cells_(kinds_.size()) {
    for (std::uint32_t i = 0; i < cage.cells(); ++i) {
      const std::size_t cube = denseIndex(cage.grid, cage.place(i));
      if (kinds_[cube] == Kind::kUnknown) cells_[cube] = {i, i};
      kinds_[cube] = Kind::kCells;
      ++cells_[cube].second;
    }
    std::vector<glm::ivec3> found;
    const auto find = [&](const glm::ivec3& at, Kind kind) {
      if (!isWithin(at) || kinds_[denseIndex(cage_.grid, at)] != Kind::kUnknown) return;
      kinds_[denseIndex(cage_.grid, at)] = kind;
      found.push_back(at);
    };
    for (std::uint32_t i = 0; i < cage.cells(); ++i)
      for (int face = 0; face < 6; ++face)
        find(beside(cage.place(i), face), cage.beyond(i, face) == kCageInside ? Kind::kInside : Kind::kEmpty);
    for (std::size_t i = 0; i < found.size(); ++i)
      for (int face = 0; face < 6; ++face)
        find(beside(glm::ivec3(found[i]), face), kinds_[denseIndex(cage_.grid, glm::ivec3(found[i]))]);
  }

  // The rule that a voxel breaks, or null.
  const char* wrong(const glm::ivec3& voxel, int level, bool solid) const {
    const glm::ivec3 place = voxel * (1 << level);
    const std::size_t cube = denseIndex(cage_.grid, place / cage_.side);
    const auto [first, end] = cells_[cube];
    if (kinds_[cube] == Kind::kInside)
      return solid || level > 0 ? nullptr : "an empty voxel is in a cube that is inside";
    if (kinds_[cube] != Kind::kCells) return solid ? "a solid voxel is in a cube without a cell" : nullptr;
    if (cage_.cell(first)[1] == 0) return nullptr;
    bool of_piece = false;
    for (std::uint32_t cell = first; cell < end; ++cell)
      of_piece = of_piece || masks(cell, level, (place - cage_.side * cage_.place(cell)) / (1 << level));
    if (of_piece == solid) return nullptr;
    return solid ? "a solid voxel is of no piece" : "an empty voxel is of a piece";
  }

 private:
  enum class Kind : std::uint8_t { kUnknown, kCells, kInside, kEmpty };

  bool isWithin(const glm::ivec3& at) const {
    return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, cage_.grid));
  }
  static glm::ivec3 beside(glm::ivec3 at, int face) {
    at[face / 2] += face % 2 ? 1 : -1;
    return at;
  }
  bool masks(std::uint32_t cell, int level, const glm::ivec3& in) const {
    const int side = cage_.side >> level, bit = in.x + side * (in.y + side * in.z);
    return (cage_.words[cage_.maskAt(cell, level) + static_cast<std::uint32_t>(bit / 32)] >> bit % 32 & 1) !=
           0;
  }

  const Cage& cage_;
  std::vector<Kind> kinds_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cells_;  // first, end
};

}  // namespace

void checkCage(const Cage& cage, const LevelPlace& place, const fields::Occupancy& occupancy,
               VerifyReport& report) {
  const Cubes cubes(cage);
  Tally tally(DeepIssueId::kCage, place);
  for (std::size_t i = 0; i < occupancy.solid.size(); ++i) {
    const glm::ivec3 voxel = voxelAt(occupancy.size, i);
    if (const char* const wrong = cubes.wrong(voxel, place.level, occupancy.solid[i] != 0))
      tally.add(voxel / kBrickSide, voxel, wrong);
  }
  tally.report(report);
}

}  // namespace kelp::dump
