// SPDX-License-Identifier: MIT
// Where neighboring voxels belong to surfaces that move apart: an arm at a hip, the parts of a robot.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "kelp/fields/solid_bits.h"
#include "morph_gaps.h"
#include "samples.h"

namespace kelp::bake {

class SkinCuts {
 public:
  // A voxel belongs to the nearest sample whose triangle it is behind, if one is beside it. Neighbors that
  // belong to samples are cut apart if the weights of these differ much, or a morph target moves them apart,
  // and the mesh does not join them nearby. Keeps references.
  SkinCuts(const TriangleSoup& soup, const SourceSkin& skin, const Frame& frame, const SkinSamples& samples,
           const fields::SolidBits& solid);

  // Of each voxel, as fields::buildCages() has them; none if nothing is cut.
  const std::vector<std::uint16_t>& voxels() const { return cuts_; }

  // The solid voxel nearest to a sample, of these or others, from which it is not apart; none: it is farther
  // than a few voxels.
  std::optional<glm::ivec3> voxelOf(const SkinSamples& of, std::size_t i);

 private:
  bool areApart(const SkinSamples& a, std::size_t i, const SkinSamples& b, std::size_t j);
  // Of triangles: one of the triangles of its surface near a place.
  using Surfaces = std::unordered_map<std::uint32_t, std::uint32_t>;
  std::uint32_t surfaceOf(std::uint32_t triangle, const glm::dvec3& near, Surfaces& found) const;
  double distanceTo(std::uint32_t triangle, const glm::dvec3& point) const;

  const SkinSamples& samples_;
  const fields::SolidBits& solid_;
  MorphGaps gaps_;
  std::vector<glm::dvec3> corners_;  // vertices of the mesh, voxels
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::size_t> first_at_;  // of each vertex: where its triangles begin
  std::vector<std::uint32_t> at_;
  std::vector<std::uint32_t> owners_;  // of each voxel: its sample, or none
  std::vector<std::uint16_t> cuts_;
  std::map<std::array<int, 3>, Surfaces> surfaces_;  // of places that were asked for
};

}  // namespace kelp::bake
