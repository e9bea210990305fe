// SPDX-License-Identifier: MIT
// A glTF file in memory, with every index that a reader follows checked. Shared by the files that give it meaning.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
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

#include "import_files.h"
#include "import_gltf_document.h"
#include "kelp/bake/bake.h"

namespace kelp::bake {

struct GltfTransform {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
  glm::dmat4 matrix() const;
};

struct GltfModel {
  const InputFiles* files = nullptr;
  tinygltf::Model data;              // its buffers are filled, its images empty
  GltfDocument document;             // images and rigs
  int scene = -1;                    // that is baked; -1: the file has none, and every node counts
  std::vector<int> parents;          // of each node, -1: a root
  std::vector<int> order;            // the nodes of the scene, parents before children
  std::vector<glm::dmat4> world;     // of each node at rest
  std::vector<std::string>* notices = nullptr;
  std::uint64_t max_memory = 0;      // Settings::max_memory
  DataBudget* budget = nullptr;      // for what is copied out of the document

  [[noreturn]] void refuse(const std::string& place, std::string_view what) const { bake::refuse(Exit::kInvalid, files->input(), place, what); }
  mutable std::set<std::string> cut_out;  // primitives of which alphaMode MASK leaves nothing, as they are read

  void note(const std::string& text) const { notices->push_back(oneLine(text, 500)); }
  // What several nodes, textures or materials have to say in the same words.
  void noteOnce(const std::string& text) const {
    if (said.insert(text).second) note(text);
  }
  mutable std::set<std::string> said;

  // Counts vertices, joints or primitives that are about to be read for a node: nodes may share a mesh, and a few kilobytes could name more than anybody waits for.
  void countRead(std::uint64_t elements, const std::string& place) const;
  mutable std::uint64_t elements_read = 0;
  // "node 'Reed'", or "nodes[3]" where it has no name; -1: "the scene".
  std::string nodeName(int node) const;
};

// Parses the document and checks the graph: node indices, one parent a node, no cycle, meshes and skins that exist. `scene` is a name or an
// index; without, the default one is taken.
GltfModel parseGltf(const InputFiles& files, GltfDocument document, const std::optional<std::string>& scene, std::vector<std::string>& notices);

// The rest transform of a node; a matrix that is not a product of T, R and S has `exact` false.
GltfTransform restTransform(const tinygltf::Node& node, bool* exact = nullptr);
glm::dmat4 localMatrix(const tinygltf::Node& node);

// --- accessors: values are copied out, ranges are checked, sparse values applied ---------------------------------------------------
struct GltfValues {
  std::size_t count = 0;
  int components = 0;
  std::vector<float> values;  // components each; normalised integers scaled
  float at(std::size_t element, int component) const { return values[element * static_cast<std::size_t>(components) + static_cast<std::size_t>(component)]; }
};
// With `fractions`, integers count as normalised whether the file says so or not.
GltfValues readValues(const GltfModel& model, int accessor, const std::string& user, bool fractions = false);
// How far apart two neighbouring values of an accessor are: what compressors rounded to. 0: floats as they were written.
float stepOf(const GltfModel& model, int accessor);
// Whether those steps are of a grid of its own.
bool isDraco(const GltfModel& model, int accessor);
std::vector<std::uint32_t> readIndices(const GltfModel& model, int accessor, const std::string& user);
// Bytes of a buffer view (for images).
std::span<const std::uint8_t> readView(const GltfModel& model, int view, const std::string& user);

// --- materials -----------------------------------------------------------------------------------------------------------------------
// Where a picture lies.
struct GltfCoordinates {
  int set = 0;                  // TEXCOORD_n
  glm::mat3 transform{1};
};
// What a primitive needs to know of its material to read its UVs.
struct GltfMaterialUse {
  std::vector<GltfCoordinates> coordinates;  // for TriangleSoup::uvs and more_uvs in turn; at most three
  bool keep_alpha = false;                   // the alpha of COLOR_0 counts
  float least_alpha = 0;                     // triangles whose corners all have less are cut out entirely; corners without COLOR_0 have 1
};
// Fills model.materials (one more than the file has: the default) and model.images.
std::vector<GltfMaterialUse> readMaterials(const GltfModel& model, SourceModel& out);

// --- meshes --------------------------------------------------------------------------------------------------------------------------
class SoupBuilder;
bool hasTriangles(const tinygltf::Primitive& primitive);
// Adds the triangles of a node's mesh, in the space that `from_world` takes the world to.
void addMesh(const GltfModel& model, int node, const glm::dmat4& from_world, const std::vector<GltfMaterialUse>& materials, SoupBuilder& soup);

// The middle of the box that the nodes' meshes fill in the world, as floats hold it; nullopt where there is none, or none that they hold.
std::optional<glm::dvec3> middleOf(const GltfModel& model, const std::vector<int>& nodes);

// For a scene without triangles: refuses a file that is to blame, or whose meshes are nothing that kelp bakes. Returns where the scene is sound
// and simply has no mesh, which glTF allows.
void explainEmptiness(const GltfModel& model);

// --- animation -----------------------------------------------------------------------------------------------------------------------
// One animated property of a node. Values: 3 components, or the 4 of a quaternion (x, y, z, w).
struct GltfChannel {
  enum class Path { kTranslation, kRotation, kScale };
  int node = -1;
  Path path = Path::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;            // strictly ascending
  std::vector<glm::dvec4> values;      // one a time
  std::vector<glm::dvec4> in, out;     // kCubic only: slopes per second
};
// The animated weights of the morph targets of a node's mesh.
struct GltfMorphChannel {
  int node = -1;
  std::size_t targets = 0;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;            // strictly ascending
  std::vector<double> values;          // `targets` a time
  std::vector<double> in, out;         // kCubic only: slopes per second
};
// Names for what moves: motions of one name are one, and two that move the same thing are two.
class MotionNames {
 public:
  using Target = std::pair<int, int>;
  // The first of `wanted`, "wanted.2", "wanted.3" and so on under which none of the targets is moved yet; they are from now on.
  std::string take(const std::string& wanted, const std::vector<Target>& targets);
  // Says that a name is taken for targets already.
  void add(const std::string& name, const std::vector<Target>& targets) { taken_[name].insert(targets.begin(), targets.end()); }

 private:
  std::map<std::string, std::set<Target>> taken_;
  std::map<std::pair<std::string, Target>, int> first_free_;  // by the wanted name: all suffixes before it are taken for the target
};

struct GltfAnimation {
  std::string name;                    // "animation 3" if it has none; those of one name move different things, and are one clip
  float duration = 0;                  // the last key of any channel
  std::vector<GltfChannel> channels;
  std::vector<GltfMorphChannel> morphs;
};
// Where the channels of each node are: the animation and the channel in it, in their order.
using GltfChannelIndex = std::map<int, std::vector<std::pair<std::size_t, std::size_t>>>;
GltfChannelIndex indexChannels(const std::vector<GltfAnimation>& animations);
// Those that move something.
std::vector<GltfAnimation> readAnimations(const GltfModel& model);
// The value at a time, as section 3.11 and appendix C of the glTF 2.0 specification define it.
glm::dvec4 evaluate(const GltfChannel& channel, double time);
std::vector<double> evaluate(const GltfMorphChannel& channel, double time);
// Whether a channel ever leaves what its node has at rest: exporters write channels for everything that could move.
bool moves(const GltfModel& model, const GltfChannel& channel);
// Makes a moment of an animation the file's rest: nodes, their worlds, weights. BakeError kUsage if there is no such animation.
void poseAt(GltfModel& model, const std::vector<GltfAnimation>& animations, const Moment& moment);

// --- rigs ----------------------------------------------------------------------------------------------------------------------------
// A rig as text in the file.
struct GltfRig {
  std::string text;
  std::string owner;                   // "node 'Reed'", "mesh 'Blade'", "scene 'Scene'"
};
struct GltfRigs {
  std::vector<std::optional<GltfRig>> nodes;  // of each node: its own, or that of a mesh that it alone uses
  std::optional<GltfRig> file;                // of all that belongs to no rigged node: the scene's, the asset's or the root's
};
// Which extras.kelp is the rig of what. One that is the rig of nothing makes a notice.
GltfRigs findRigs(const GltfModel& model);

// The empties knot.0 .. knot.n among a node's children, in order; empty if there are none. Gaps and doubles make a notice, and no rig.
// Node -1: those at the top of the scene.
std::vector<int> findKnots(const GltfModel& model, int node);
// Whether knots that no mesh owns can be meant for this one: none lies away from it.
bool lieBeside(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup);
// The rest rig that the knots describe; nullopt with a notice if they make none. `soup` is in the node's space.
std::optional<RigDescription> knotRig(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup,
                                      std::optional<Axis> axis);
// Adds the clips that move the part itself and its knots (none: `knots` is empty). Marks the channels it used.
void addClips(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup, const std::string& part_name,
              const std::vector<GltfAnimation>& animations, const GltfChannelIndex& index, std::vector<std::vector<bool>>& used, RigDescription& rig);

}  // namespace kelp::bake
