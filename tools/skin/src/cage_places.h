// SPDX-License-Identifier: MIT
// Where points are in the finest cage of a part.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/fields/solid_bits.h"
#include "kelp/formats/raw_pack.h"

namespace kelp::bake {

class CagePlaces {
 public:
  // cuts: as fields::buildCages() has them. cell: side of the cells.
  CagePlaces(const fields::SolidBits& solid, const std::vector<std::uint16_t>& cuts, int cell);

  // Nodes of a tetrahedron; the weights sum to 1, and take these nodes to the point.
  struct Place {
    std::uint32_t nodes[4];
    double weights[4];
  };
  // In the cell of a solid voxel. None: it is in no cell because all around is solid.
  std::optional<Place> find(const glm::dvec3& point, const glm::ivec3& voxel) const;

  const Cage& cage() const { return cage_; }
  const RawCage& raw() const { return raw_; }

 private:
  std::uint32_t cellOf(const glm::ivec3& voxel) const;

  RawCage raw_;
  CageMemory memory_;
  Cage cage_;
  std::vector<std::uint32_t> first_cells_;  // of each cube; kCageOutside: none
};

}  // namespace kelp::bake
