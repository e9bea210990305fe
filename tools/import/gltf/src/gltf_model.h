// SPDX-License-Identifier: MIT
// A glTF file in memory; every index that is followed is checked. Shared by the sources that read its
// meaning.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

#include "gltf_document.h"
#include "kelp/common/error.h"
#include "kelp/import/core/input_files.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {

struct GltfTransform {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
  glm::dmat4 matrix() const;
};

struct GltfModel {
  const InputFiles* files = nullptr;
  tinygltf::Model data;  // without buffers and images, which are here:
  std::unique_ptr<GltfBuffers> buffers;
  std::vector<GltfDocument::Source> images;
  // for accessors that Draco rounded: the distance between two neighboring values
  std::map<int, float> draco_steps;
  int scene = -1;            // the scene to bake; -1: the file has none, and every node counts
  std::vector<int> parents;  // of each node, -1: a root
  std::vector<int> order;    // the nodes of the scene, parents before children
  // `order`, then the joints of its skins that no scene lists, with all nodes above them
  std::vector<int> placed;
  std::vector<glm::dmat4> world;  // of each placed node at rest
  // of nodes whose mesh stands in several places (EXT_mesh_gpu_instancing): node <- mesh
  std::map<int, std::vector<glm::dmat4>> instances;
  std::size_t hidden_meshes = 0;  // nodes that lost their mesh because they are hidden
  std::vector<std::string>* notices = nullptr;
  std::uint64_t max_memory = 0;  // ImportSettings::max_memory
  DataBudget* budget = nullptr;  // for data that is copied out of the document

  const tinygltf::Node& node(int index) const { return data.nodes[static_cast<std::size_t>(index)]; }

  [[noreturn]] void refuse(const std::string& place, std::string_view what) const {
    bake::refuse(Exit::kInvalid, files->input(), place, what);
  }
  // the primitives, of those read so far, of which their alpha leaves nothing
  mutable std::map<std::string, bool> cut_out;  // true: blended, with an alpha of 0

  void note(const std::string& text) const { notices->push_back(oneLine(text, 500)); }
  // A notice that several nodes, textures or materials would repeat.
  void noteOnce(const std::string& text) const {
    if (said.insert(text).second) note(text);
  }
  mutable std::set<std::string> said;

  // Counts vertices, joints or primitives that are about to be read for a node, and refuses too many: nodes
  // may share a mesh, so a few kilobytes could ask for hours of work.
  void countRead(std::uint64_t elements, const std::string& place) const;
  mutable std::uint64_t elements_read = 0;
  // "node 'Reed'", or "nodes[3]" where it has no name; -1: "the scene".
  std::string nodeName(int node) const;
};

// Reads the file, unpacks what is compressed, and checks the graph: node indices, one parent for each node,
// no cycles, meshes and skins that exist. `scene` is an index or a name; absent: the file's default scene.
// ToolError for damaged files and for data beyond the budget. Safe for hostile input.
GltfModel readGltf(const InputFiles& files, DataBudget& budget, const std::optional<std::string>& scene,
                   std::vector<std::string>& notices);
// EXT_meshopt_compression and KHR_draco_mesh_compression: decode into new buffers (unpack.cpp).
void unpackMeshopt(GltfModel& model);
void unpackDraco(GltfModel& model);

// The rest transform of a node. `exact` becomes false for a matrix that is not a product of T, R and S.
GltfTransform restTransform(const tinygltf::Node& node, bool* exact = nullptr);
glm::dmat4 localMatrix(const tinygltf::Node& node);
// Computes the world matrices of all placed nodes.
void placeNodes(GltfModel& model);
// EXT_mesh_gpu_instancing and KHR_node_visibility (instances.cpp): fills GltfModel::instances, and takes the
// meshes of hidden nodes away.
void readNodeExtensions(GltfModel& model);

// --- accessor.cpp: values are copied out, ranges are checked, sparse values applied --------------
struct GltfValues {
  std::size_t count = 0;
  int components = 0;
  std::vector<float> values;  // components each; normalized integers scaled
  float at(std::size_t element, int component) const {
    return values[element * static_cast<std::size_t>(components) + static_cast<std::size_t>(component)];
  }
};
// With `fractions`, integers are normalized even if the file does not say so.
GltfValues readValues(const GltfModel& model, int accessor, const std::string& user, bool fractions = false);
// The same of an attribute of a mesh: `least` to `most` components, `count` values.
GltfValues readSized(const GltfModel& model, int accessor, int least, int most, std::size_t count,
                     const std::string& place, const char* name, bool fractions = false);
// The distance between two neighboring values of an accessor, to which a compressor rounded. 0: floats that
// were not rounded.
float stepOf(const GltfModel& model, int accessor);
// True if Draco rounded the accessor, on a grid of its own.
bool isDraco(const GltfModel& model, int accessor);
std::vector<std::uint32_t> readIndices(const GltfModel& model, int accessor, const std::string& user);
// Bytes of a buffer view (for images).
std::span<const std::uint8_t> readView(const GltfModel& model, int view, const std::string& user);

// --- material.cpp --------------------------------------------------------------------------------
// The texture coordinates of a picture.
struct GltfCoordinates {
  int set = 0;  // TEXCOORD_n
  glm::mat3 transform{1};
};
// The part of a material that reading a primitive's UVs and colors needs.
struct GltfMaterialUse {
  // for TriangleSoup::uvs and more_uvs, in this order; at most three
  std::vector<GltfCoordinates> coordinates;
  bool keep_alpha = false;  // the alpha of COLOR_0 counts
  // triangles whose corners all have a lower alpha are left out; corners without COLOR_0 have 1
  float least_alpha = 0;
  bool blends = false;  // alphaMode is BLEND
};
// Fills out.materials (those of the file, then the default one) and out.images.
std::vector<GltfMaterialUse> readMaterials(const GltfModel& model, SourceModel& out);

// --- gltf_mesh.cpp -------------------------------------------------------------------------------
class SoupBuilder;
class GltfSkins;
bool hasTriangles(const tinygltf::Primitive& primitive);
// Adds the triangles of a node's mesh, in each of its places. `from_world` takes the world to the soup's
// space. With `skins`, in the bind pose, with what moves their corners.
void addMesh(const GltfModel& model, int node, const glm::dmat4& from_world,
             const std::vector<GltfMaterialUse>& materials, SoupBuilder& soup, GltfSkins* skins = nullptr);

// The middle of the box around the nodes' meshes in the world, as floats hold it; nullopt if there is none or
// it is beyond floats.
std::optional<glm::dvec3> middleOf(const GltfModel& model, const std::vector<int>& nodes);

// For a scene without triangles: ToolError if the file is damaged or its meshes cannot be baked. Returns if
// the scene is sound and has no mesh, which glTF allows.
void explainEmptiness(const GltfModel& model);

// --- animation.cpp; poseAt(): moment.cpp ---------------------------------------------------------
// One animated property of a node. Values: 3 components, or the 4 of a quaternion (x, y, z, w).
struct GltfChannel {
  enum class Path { kTranslation, kRotation, kScale };
  int node = -1;
  Path path = Path::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;         // strictly ascending
  std::vector<glm::dvec4> values;   // one a time
  std::vector<glm::dvec4> in, out;  // kCubic only: slopes per second
};
// The animated weights of the morph targets of a node's mesh.
struct GltfMorphChannel {
  int node = -1;
  std::size_t targets = 0;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;     // strictly ascending
  std::vector<double> values;   // `targets` a time
  std::vector<double> in, out;  // kCubic only: slopes per second
};
// Names for clips: motions of one name make one clip, unless they move the same thing.
class MotionNames {
 public:
  using Target = std::pair<int, int>;
  // The first of `wanted`, "wanted.2", "wanted.3" and so on whose clip moves none of the targets yet. Marks
  // them as moved by it.
  std::string take(const std::string& wanted, const std::vector<Target>& targets);
  // Marks targets as moved by a clip that exists already.
  void add(const std::string& name, const std::vector<Target>& targets) {
    taken_[name].insert(targets.begin(), targets.end());
  }

 private:
  std::map<std::string, std::set<Target>> taken_;
  // the first suffix that is free for a wanted name and a target
  std::map<std::pair<std::string, Target>, int> first_free_;
};

struct GltfAnimation {
  // "animation 3" if it has none; animations of one name move different things and make one clip
  std::string name;
  float duration = 0;  // time of the last key of any channel
  std::vector<GltfChannel> channels;
  std::vector<GltfMorphChannel> morphs;
};
// For each node, its channels as (animation, channel in it), ascending.
using GltfChannelIndex = std::map<int, std::vector<std::pair<std::size_t, std::size_t>>>;
GltfChannelIndex indexChannels(const std::vector<GltfAnimation>& animations);
// All animations with a channel that is read.
std::vector<GltfAnimation> readAnimations(const GltfModel& model);
// The value at a time, as section 3.11 and appendix C of the glTF 2.0 specification define it.
glm::dvec4 evaluate(const GltfChannel& channel, double time);
std::vector<double> evaluate(const GltfMorphChannel& channel, double time);
// True if a channel ever differs from its node's rest. Exporters write channels for everything that could
// move.
bool moves(const GltfModel& model, const GltfChannel& channel);
// Makes a moment of an animation the rest of the model: nodes, their world matrices, weights. ToolError
// kUsage if there is no such animation.
void poseAt(GltfModel& model, const std::vector<GltfAnimation>& animations, const Moment& moment);

// --- rigs.cpp ------------------------------------------------------------------------------------
// The text of a rig in the file.
struct GltfRig {
  std::string text;
  std::string owner;  // "node 'Reed'", "mesh 'Blade'", "scene 'Scene'"
};
struct GltfRigs {
  // for each node: its own, or that of a mesh that only this node uses
  std::vector<std::optional<GltfRig>> nodes;
  // for everything that belongs to no rigged node: the scene's, the asset's or the root's
  std::optional<GltfRig> file;
};
// Which extras.kelp is the rig of what. A rig that nothing uses makes a notice.
GltfRigs findRigs(const GltfModel& model);

// --- knots.cpp; addClips(): clips.cpp ------------------------------------------------------------
// The empties knot.0 to knot.n among a node's children, in order. Empty if there are none, and, with a
// notice, if a number is missing or stands twice. Node -1: those at the top of the scene.
std::vector<int> findKnots(const GltfModel& model, int node);
// True if knots at the top of the scene can belong to this mesh: all of them lie near it.
bool lieBeside(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup);
// The rest rig that the knots describe, added to `rig`, which may say its axis and how it bends; nullopt,
// with a notice, if they make none. `soup` is in the node's space.
std::optional<RigDescription> knotRig(const GltfModel& model, int node, const std::vector<int>& knots,
                                      const TriangleSoup& soup, RigDescription rig);
// Adds the clips that move the part itself and its knots, if it has any. Marks the channels that were used.
void addClips(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup,
              const std::string& part_name, const std::vector<GltfAnimation>& animations,
              const GltfChannelIndex& index, std::vector<std::vector<bool>>& used, RigDescription& rig);

// The mesh along the axis of its rig, and how its empties are read.
struct KnotExtent {
  glm::dvec3 axis{0, 1, 0};
  double low = 0, length = 1;
  // the part is swept, and +Y of knot.0 lies along the axis: all empties were turned to be tangents, whatever
  // way they point
  bool any_way = false;
};
KnotExtent extentAlong(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup,
                       const RigDescription& rig);

// The direction in an empty's own frame that stands for its tangent: +Y. An empty whose +Y points away from
// the axis was never turned to be a tangent: then it is the direction that lies along the axis at rest.
// `turned`, which may be null, says which.
glm::dvec3 tangentHandle(const GltfTransform& rest, const KnotExtent& extent, bool* turned = nullptr);
glm::dvec3 tangentOf(const GltfTransform& transform, const glm::dvec3& handle);

// --- sockets.cpp: sockets drawn with empties socket.NAME -----------------------------------------
// True if the node is an empty of such a name.
bool isSocket(const GltfModel& model, int node);
// The names of these sockets, each once; notices for those that have another's, and for too many.
std::vector<std::pair<int, std::string>> socketNames(const GltfModel& model, const std::vector<int>& nodes,
                                                     const std::string& part);
// Gives the part these sockets. `space` takes its node's space to the world. Call it when the part has its
// rig: sockets that the rig has itself count instead, with a notice.
void addSockets(const GltfModel& model, const std::vector<int>& nodes, const glm::dmat4& space,
                SourcePart& part);

}  // namespace kelp::bake
