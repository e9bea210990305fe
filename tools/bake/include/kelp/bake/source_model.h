// SPDX-License-Identifier: MIT
// What importers produce and voxelization consumes: plain data, no type of any third-party library.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "kelp/rig_json/rig_json.h"

namespace kelp::bake {

// RGBA, 8 bits a channel, row 0 at the top (v = 0), as glTF has it.
struct Image {
  std::string name;
  int width = 0;
  int height = 0;
  bool srgb = true;  // the colour channels; alpha is always linear
  std::vector<std::uint8_t> rgba;
};

enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };

// A picture, and where on a triangle it lies.
struct SurfaceMap {
  int texture = -1;        // index into SourceModel::images; -1: none
  Wrap wrap_u = Wrap::kRepeat;
  Wrap wrap_v = Wrap::kRepeat;
  bool nearest = false;    // the sampler asks for nearest filtering
  int coordinates = 0;     // 0: TriangleSoup::uvs; n: its more_uvs[n - 1]
};

struct SurfaceMaterial {
  std::string name;
  glm::vec4 base_color{1};  // linear; multiplies texture and vertex colour
  int texture = -1;         // index into SourceModel::images
  Wrap wrap_u = Wrap::kRepeat;
  Wrap wrap_v = Wrap::kRepeat;
  bool nearest = false;     // the sampler asks for nearest filtering
  glm::vec3 emissive{0};
  float metallic = 0;
  float roughness = 1;
  SurfaceMap glow_map;      // multiplies emissive
  SurfaceMap metal_map;     // green multiplies roughness, blue metallic
  bool double_sided = false;
  float alpha_cutoff = 0;   // sheets are cut out where the alpha of base_color x texture x vertex colour is below it; 0: nowhere
};

// Triangles in the space of their part's node, in metres for glTF, in file units otherwise.
// Attributes belong to triangle corners, so that seams need no vertex splits. Vertices with equal positions are one vertex.
struct TriangleSoup {
  struct Triangle {
    std::array<std::uint32_t, 3> vertex{};
    std::uint32_t material = 0;  // index into SourceModel::materials
  };
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::vec2, 3>> uvs;      // empty, or one a triangle
  std::array<std::vector<std::array<glm::vec2, 3>>, 2> more_uvs;  // each likewise: for pictures that lie elsewhere than the base colour's
  std::vector<std::array<glm::vec4, 3>> colors;   // empty, or one a triangle; linear, multiplies the base colour
  std::uint64_t dropped = 0;                      // triangles of the file that are not here: corners in one place, or not finite
};

// A surface voxel before the palette is chosen.
struct SurfaceSample {
  std::uint64_t index = 0;  // x + size.x (y + size.y z)
  glm::vec3 normal{0, 1, 0};  // unit, outward, in voxel axes
  Material material;
  std::uint32_t source = 0;  // index into SourceModel::materials, or into SourceModel::palette if there is one; 0 for other volumes
};

// A voxel volume in its rig frame: +y along the spline.
struct VoxelGrid {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};              // voxels -> the node's space
  std::vector<std::uint8_t> solid;     // dense, x fastest, then y, then z
  std::vector<SurfaceSample> surface;  // ascending index; exactly fields::surfaceVoxels
};

// Smoke, clouds, scans: what light goes through. In its rig frame, as VoxelGrid. A sample is the mean over its voxel; between the voxels' centres the
// field is trilinear, beyond the volume zero.
struct FogGrid {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};              // voxels -> the node's space
  float extinction = 0;                // optical depth of one voxel's edge at density 65535, > 0: what density x length is in the file's own units
  std::vector<std::uint16_t> density;  // dense, x fastest, then y, then z; rounded to nearest; 65535 is the densest voxel
  std::vector<std::uint16_t> heat;     // empty, or as many: where on the ramp the fog glows, 0: not at all, 65535: the ramp's end
};

struct SourcePart {
  std::string name;
  int parent = -1;
  glm::mat4x3 to_object{1};  // node -> object at rest
  glm::mat4x3 pivot{1};      // see formats/model.h
  RigDescription rig;
  std::string rig_origin;    // where the rig came from, for the report: "extras.kelp of node 'Reed'", "straight (no rig found)"
  TriangleSoup soup;                // empty if grid or fog is set
  std::optional<VoxelGrid> grid;    // from a volume file, already in the rig's frame
  std::optional<FogGrid> fog;       // likewise; never both
  bool carrier = false;             // is there for its motion, which others follow; `grid` is a single voxel that nobody sees

  bool isVolume() const { return grid || fog; }
  // Of volumes.
  const glm::ivec3& volumeSize() const { return grid ? grid->size : fog->size; }
  const glm::mat4x3& volumeToNode() const { return grid ? grid->to_node : fog->to_node; }
};

struct SourceModel {
  std::string format;  // "glTF 2.0", "OBJ", "OpenVDB", ...
  std::vector<SourcePart> parts;
  std::vector<SurfaceMaterial> materials;  // at least one
  std::vector<Material> palette;     // of files that are painted by index: the pack's entries, in this order, up to 256; empty: the baker chooses
  bool palette_blends = false;       // coarser voxels get the entry nearest to the mean of their children's materials, not their commonest index
  Axis up = Axis::kPlusY;            // what points up in files of this format, unless the user says otherwise
  std::vector<Image> images;
  std::vector<std::string> notices;  // what was skipped or repaired; one line each, for the user
};

}  // namespace kelp::bake
