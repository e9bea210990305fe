// SPDX-License-Identifier: MIT
// The material of a mesh at a point: material, texture, vertex color, cut-outs.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "kelp/import/core/source_model.h"
#include "kelp/voxelize/surface/texture.h"
#include "kelp/voxelize/surface/triangle_bvh.h"

namespace kelp::bake {

// Keeps references to the arguments of its constructor, which must outlive it. Any thread may query it.
class SurfaceLook {
 public:
  SurfaceLook(const SourceModel& model, const TriangleSoup& soup, const Topology& mesh);

  // The material at a point of a triangle that is not a cap, averaged over the middle of a voxel. Alpha of
  // materials with cut-outs counts as opaque.
  Material materialAt(const Nearest& nearest) const;

  // The index of the material there.
  std::uint32_t sourceAt(const Nearest& nearest) const {
    return soup_.triangles[mesh_.triangles[nearest.triangle].source].material;
  }

  // Makes sheets of closed components of which enough is cut out (kMaxCutShare). `mesh` is the constructor's,
  // analyzed with Fill::kAuto. Not while another thread queries.
  void openCutOuts(Topology& mesh);

  // True if any sheet has cut-outs.
  bool cutsOut() const { return cuts_out_; }
  // True if a sheet's alpha, averaged over a voxel, is below its material's cutoff there. False on solid
  // components and caps.
  bool isCutOut(const Nearest& nearest) const;
  // The nearest point in the voxel around `center` of a triangle that is not cut out there. Nearest::triangle
  // is kCap if there is none.
  Nearest nearestShown(const TriangleBvh& bvh, const glm::dvec3& center) const;

  // Notices for the user, one line each.
  std::vector<std::string> notices() const;

 private:
  // voxels^2 of each component whose alpha, averaged over a voxel, is below its material's cutoff.
  std::vector<double> cutAreas() const;
  bool anyCutOut() const;
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
