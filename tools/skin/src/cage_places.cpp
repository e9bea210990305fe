// SPDX-License-Identifier: MIT
#include "cage_places.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

#include "kelp/common/dense_index.h"
#include "kelp/fields/cages.h"
#include "kelp/formats/cage.h"

namespace kelp::bake {

CagePlaces::CagePlaces(const fields::SolidBits& solid, const std::vector<std::uint16_t>& cuts, int cell) {
  raw_ = std::move(fields::buildCages(solid, 1, cell, cuts).front());
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;
  Result<Cage> made = makeCage(raw_.source(), solid.size(), 1, cell, 0, nullptr, kMostBytes, memory_);
  if (!made && made.error().code == ErrorCode::kOutOfMemory) throw std::bad_alloc();
  if (!made) throw std::length_error(made.error().detail);
  cage_ = *made;
  first_cells_.assign(raw_.blocks.size(), kCageOutside);
  for (std::uint32_t c = cage_.cells(); c-- > 0;) first_cells_[denseIndex(cage_.grid, cage_.place(c))] = c;
}

std::uint32_t CagePlaces::cellOf(const glm::ivec3& voxel) const {
  const glm::ivec3 cube = voxel / cage_.side, in = voxel - cage_.side * cube;
  const std::size_t index = denseIndex(cage_.grid, cube);
  const std::uint32_t first = first_cells_[index];
  if (first == kCageOutside || raw_.blocks[index] == 1) return first;
  const auto bit = static_cast<std::uint32_t>(in.x + cage_.side * (in.y + cage_.side * in.z));
  for (std::uint32_t c = first; c < first + raw_.blocks[index]; ++c)
    if (cage_.words[cage_.maskAt(c, 0) + bit / 32] >> bit % 32 & 1) return c;
  return kCageOutside;
}

std::optional<CagePlaces::Place> CagePlaces::find(const glm::dvec3& point, const glm::ivec3& voxel) const {
  const std::uint32_t cell = cellOf(voxel);
  if (cell == kCageOutside) return std::nullopt;
  const glm::dvec3 in = point / static_cast<double>(cage_.side) - glm::dvec3(cage_.place(cell));
  // The tetrahedron in whose order of axes the coordinates descend.
  const CageTetrahedron* its = &kCageTetrahedra[0];
  for (const CageTetrahedron& one : kCageTetrahedra)
    if (in[one.axes[0]] >= in[one.axes[1]] && in[one.axes[1]] >= in[one.axes[2]]) {
      its = &one;
      break;
    }
  const double a = in[its->axes[0]], b = in[its->axes[1]], c = in[its->axes[2]];
  Place place{{}, {1 - a, a - b, b - c, c}};
  for (int i = 0; i < 4; ++i) place.nodes[i] = cage_.node(cell, its->corners[i]);
  return place;
}

}  // namespace kelp::bake
