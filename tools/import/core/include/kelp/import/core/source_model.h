// SPDX-License-Identifier: MIT
// The output of importers and the input of voxelization: plain data, no types of other libraries.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "kelp/import/core/memory_estimate.h"
#include "kelp/rig/rig_file.h"

namespace kelp::bake {

// The most materials of a palette: its indices are bytes.
inline constexpr std::size_t kMaxPalette = 256;

// RGBA, 8 bits a channel; row 0 is the top (v = 0), as in glTF.
struct Image {
  std::string name;
  int width = 0;
  int height = 0;
  bool srgb = true;  // the color channels; alpha is always linear
  std::vector<std::uint8_t> rgba;
};

enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };

// A picture, and which texture coordinates place it on a triangle.
struct SurfaceMap {
  int texture = -1;  // index into SourceModel::images; -1: none
  Wrap wrap_u = Wrap::kRepeat;
  Wrap wrap_v = Wrap::kRepeat;
  bool nearest = false;  // the sampler asks for nearest filtering
  int coordinates = 0;   // 0: TriangleSoup::uvs; n: its more_uvs[n - 1]
};

// Said of a material that lets light through.
inline constexpr const char* kBakedOpaque = "is transparent; it is baked opaque";

struct SurfaceMaterial {
  std::string name;
  glm::vec4 base_color{1};  // linear; multiplies texture and vertex color
  int texture = -1;         // index into SourceModel::images
  Wrap wrap_u = Wrap::kRepeat;
  Wrap wrap_v = Wrap::kRepeat;
  bool nearest = false;  // the sampler asks for nearest filtering
  glm::vec3 emissive{0};
  float metallic = 0;
  float roughness = 1;
  SurfaceMap glow_map;   // multiplies emissive
  SurfaceMap metal_map;  // green multiplies roughness, blue metallic
  bool double_sided = false;
  // sheets are cut out where the alpha of base_color x texture x vertex color is below this; 0: nowhere
  float alpha_cutoff = 0;
};

// Triangles in the space of their part's node, in meters for glTF, in file units otherwise.
// Attributes belong to triangle corners, so that seams need no vertex splits. Vertices with equal positions
// are one vertex.
struct TriangleSoup {
  struct Triangle {
    std::array<std::uint32_t, 3> vertex{};
    std::uint32_t material = 0;  // index into SourceModel::materials
  };
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::vec2, 3>> uvs;  // empty, or one a triangle
  // each likewise: for pictures with other coordinates than the base color's
  std::array<std::vector<std::array<glm::vec2, 3>>, 2> more_uvs;
  // empty, or one a triangle; linear, multiplies the base color
  std::vector<std::array<glm::vec4, 3>> colors;
  // empty, or one a triangle: which vertices of its part's SourceSkin the corners are
  std::vector<std::array<std::uint32_t, 3>> skinned;
  // triangles that were left out: corners in one place, or not finite
  std::uint64_t dropped = 0;
};

// How a soup bends by joints (linear blend skinning): posed = sum over its influences of weight x motion x
// (position + sum over morph targets of weight x offset). The soup is in the bind pose, where every motion is
// the identity and every weight of a morph target 0.
struct SourceSkin {
  struct Joint {
    std::string name;
    int parent = -1;             // an earlier joint, -1: none
    glm::dmat4 inverse_bind{1};  // the soup's space in the bind pose -> the joint's own
    // The node that clips move: what it is placed in, and its own axes. In the bind pose; to the soup's
    // space. If base^-1 frame is a translation, a rotation and a scale, so is every motion, about an axis of
    // them.
    glm::dmat4 base{1}, frame{1};
  };
  struct Influence {
    std::uint32_t joint = 0;
    float weight = 0;  // above 0; those of a vertex sum to 1
  };
  struct Clip {
    std::string name;
    float duration = 0;                // seconds, > 0
    std::vector<float> times;          // strictly ascending, the first 0
    std::vector<glm::dmat4x3> locals;  // for each time, for each joint: its motion within its parent's
    std::vector<glm::dquat> turns;     // likewise: the rotation of its node, which a scale of nothing hides
    std::vector<float> weights;        // for each time, for each morph target: how far it is from rest
  };
  // A morph target: where it moves vertices before joints do, by its weight times the offsets.
  struct Morph {
    std::string name;
    std::vector<std::uint32_t> vertices;  // ascending
    std::vector<glm::vec3> offsets;       // one for each, in the soup's space
  };
  // A named place that follows a joint.
  struct Socket {
    std::string name;
    std::uint32_t joint = 0;
    glm::dmat4 place{1};  // its axes and origin in the bind pose, in the soup's space
  };
  std::vector<Joint> joints;
  std::vector<Socket> sockets;
  std::vector<std::uint32_t> first_influence;  // of each vertex, and the end
  std::vector<Influence> influences;
  std::vector<Morph> morphs;
  std::vector<Clip> clips;

  // Leaves only these morph targets, ascending.
  void keepMorphs(const std::vector<std::size_t>& kept);
  // The motions of all joints, posed <- bind pose in the soup's space, at a time of a clip.
  std::vector<glm::dmat4x3> motionsAt(const Clip& clip, std::size_t time) const;
};

// A surface voxel before the palette is chosen.
struct SurfaceSample {
  std::uint64_t index = 0;    // x + size.x (y + size.y z)
  glm::vec3 normal{0, 1, 0};  // unit, outward, in voxel axes
  Material material;
  // index into SourceModel::materials, or into SourceModel::palette if there is one; 0 for volumes without
  // either
  std::uint32_t source = 0;
};

// A voxel volume in its rig frame: +y along the spline.
struct VoxelGrid {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};              // voxels -> the node's space
  std::vector<std::uint8_t> solid;     // dense, x fastest, then y, then z
  std::vector<SurfaceSample> surface;  // ascending index; exactly fields::surfaceVoxels
};

// Smoke, clouds, scans. In its rig frame, as VoxelGrid. A sample is the mean over its voxel; between voxel
// centers the field is trilinear, outside the volume it is zero.
struct FogGrid {
  glm::ivec3 size{0};
  glm::mat4x3 to_node{1};  // voxels -> the node's space
  // optical depth of one voxel's edge at density 65535, > 0: density x length in the file's units
  float extinction = 0;
  // dense, x fastest, then y, then z; rounded to nearest; 65535 is the densest voxel
  std::vector<std::uint16_t> density;
  // empty, or one a voxel: where on the ramp the fog glows; 0: not at all, 65535: the ramp's end
  std::vector<std::uint16_t> heat;
};

struct SourcePart {
  std::string name;
  int parent = -1;
  glm::mat4x3 to_object{1};  // node -> object at rest
  glm::mat4x3 pivot{1};      // see formats/model.h
  RigDescription rig;
  // where the rig is from, for the report: "extras.kelp of node 'Reed'", "straight (no rig found)"
  std::string rig_origin;
  TriangleSoup soup;               // empty if grid or fog is set
  std::optional<SourceSkin> skin;  // the soup bends by joints: the part becomes several
  // From a volume file, already in the rig's frame. Without `solid`, the part is empty: it has a size and a
  // place, and moves the parts that follow it.
  std::optional<VoxelGrid> grid;
  std::optional<FogGrid> fog;  // likewise; never both
  bool carries = false;        // another part hangs on its spline
  int sections = -1;           // as Part::sections

  bool isVolume() const { return grid || fog; }
  bool isEmpty() const { return grid && grid->solid.empty(); }
  // Of volumes.
  const glm::ivec3& volumeSize() const { return grid ? grid->size : fog->size; }
  const glm::mat4x3& volumeToNode() const { return grid ? grid->to_node : fog->to_node; }
};

// The rig from outside the model's own file.
struct OuterRig {
  RigFile file;
  std::string origin;  // "hero.rig.json beside the input"

  bool isWhole() const { return file.parts.empty(); }
};

struct SourceModel {
  std::string format;  // "glTF 2.0", "OBJ", "OpenVDB", ...
  std::vector<SourcePart> parts;
  // Its rigs of parts have been given, but those of the joints of a skin, which are no parts yet.
  std::optional<OuterRig> outer;
  std::vector<SurfaceMaterial> materials;  // at least one
  // for files that are painted by index: the pack's palette, in this order, at most 256; empty: the baker
  // chooses
  std::vector<Material> palette;
  // coarser voxels get the entry nearest to the mean of their children's materials, not their most frequent
  // index
  bool palette_blends = false;
  Axis up = Axis::kPlusY;  // the axis that points up in this format, unless the user gives another
  std::vector<Image> images;
  std::vector<std::string> notices;  // what was skipped or repaired; one line each, for the user

  // The format has nodes, of which Parts::kNodes makes parts.
  bool hasNodes() const { return format == "MagicaVoxel" || format.starts_with("glTF"); }
};

}  // namespace kelp::bake
