// SPDX-License-Identifier: MIT
// What a mesh looks like at a point: material, texture, vertex colour, and whether it is there at all.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/surface/texture.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// Refers to what it is made from. Immutable once made; queries may run on any thread.
class SurfaceLook {
 public:
  SurfaceLook(const SourceModel& model, const TriangleSoup& soup, const Topology& mesh);

  // At the nearest point of a triangle that is no cap, averaged over the middle of a voxel. What is cut out
  // elsewhere is opaque here.
  Material materialAt(const Nearest& nearest) const;

  // Its material's index.
  std::uint32_t sourceAt(const Nearest& nearest) const {
    return soup_.triangles[mesh_.triangles[nearest.triangle].source].material;
  }

  // Whether some sheet has cut-outs.
  bool cutsOut() const { return cuts_out_; }
  // Whether the alpha of a sheet, averaged over a voxel, is below its material's cutoff there. Never on solid
  // components and caps.
  bool isCutOut(const Nearest& nearest) const;
  // The nearest point, within the voxel around `centre`, of a triangle that is not cut out there; kCap: none.
  Nearest nearestShown(const TriangleBvh& bvh, const glm::dvec3& centre) const;

  // One line each, for the user.
  std::vector<std::string> notices() const;

 private:
  const SurfaceMaterial& materialOf(const SolidTriangle& solid) const {
    return model_.materials[soup_.triangles[solid.source].material];
  }
  glm::vec4 colorAt(const Nearest& nearest, float footprint) const;
  std::array<float, 3> cornerWeights(const Nearest& nearest) const;
  glm::vec4 mapAt(const Nearest& nearest, const SurfaceMap& map, float footprint) const;
  float texelsPerVoxel(const SolidTriangle& solid, const std::array<glm::vec2, 3>& uv, int texture) const;

  const SourceModel& model_;
  const TriangleSoup& soup_;
  const Topology& mesh_;
  std::vector<std::optional<TexturePyramid>> textures_;
  bool cuts_out_ = false;
};

}  // namespace kelp::bake
