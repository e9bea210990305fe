// SPDX-License-Identifier: MIT
// The meshes of a scene as one that bends by joints: where each stands in the bind pose, which joints move
// its vertices, and how the file's animations move the joints.
#pragma once

#include <map>
#include <vector>

#include "gltf_model.h"

namespace kelp::bake {

// An index that was checked.
template <class Index>
std::size_t at(Index index) {
  return static_cast<std::size_t>(index);
}

// False for a matrix without an inverse.
bool isRegular(const glm::dmat4& m);
bool isFinite(const glm::dmat4& m);

// True if a mesh of the scene has a skin.
bool hasSkins(const GltfModel& model);

// True if the rig has one for a joint by its name.
bool rigsJoints(const GltfModel& model, const RigFile& rig);
// True if an animation moves a joint of a skin of the scene.
bool movesJoints(const GltfModel& model, const std::vector<GltfAnimation>& animations);

// --- morphs.cpp: morph targets -----------------------------------------------------------------------------
// The most that a primitive of a mesh has.
std::size_t targetCount(const tinygltf::Mesh& mesh);
// The weights at rest of a node that has a mesh; there may be more or fewer than targets.
const std::vector<double>& restingWeights(const GltfModel& model, int node);
// How far a target moves each of `count` vertices; none: it has no positions.
std::vector<glm::dvec3> readTarget(const GltfModel& model, const tinygltf::Primitive& primitive,
                                   std::size_t target, std::size_t count, const std::string& place);
// True if a morph target moves vertices of the scene.
bool hasMorphs(const GltfModel& model);

// The joint matrices of a skin, its mesh's space to each joint's.
std::vector<glm::dmat4> inverseBindMatrices(const GltfModel& model, int skin);

class GltfSkins {
 public:
  // `sockets`: empties of the scene with their names. ToolError for a skin that is damaged.
  GltfSkins(const GltfModel& model, const std::vector<GltfAnimation>& animations,
            const std::vector<std::pair<int, std::string>>& sockets);

  // World <- mesh, in the bind pose. A mesh without a skin stands to the nearest joint above it as it does at
  // rest.
  const glm::dmat4& place(int node) const { return meshes_.at(node).place; }

  // Vertices one after the other. `joint` counts within the skin of the vertex's mesh; weights are above 0
  // and need not sum to one. A vertex without any follows the first joint.
  std::uint32_t vertices() const { return static_cast<std::uint32_t>(skin_.first_influence.size()); }
  void beginVertex(int node);
  void addInfluence(std::size_t joint, double weight);
  // Where morph targets move the last vertices: those of a primitive. to_space: from the mesh's to take()'s.
  void addOffsets(const tinygltf::Primitive& primitive, std::size_t count, const glm::dmat3& to_space,
                  const std::string& place);

  // Ends the vertices. Returns the skin with all clips, in `space` (of the world); marks the channels that
  // move joints.
  SourceSkin take(const glm::dmat4& space, std::vector<std::vector<bool>>& used);

 private:
  struct Mesh {
    glm::dmat4 place{1};
    std::vector<std::uint32_t> joints;  // of its skin; of a mesh without one: the one that moves it
  };
  int parentOf(int node) const { return model_.parents[static_cast<std::size_t>(node)]; }
  const glm::dmat4& worldOf(int node) const { return model_.world[static_cast<std::size_t>(node)]; }
  std::uint32_t jointOf(int node, const glm::dmat4& from_world);
  void addSkinned(int node);
  Mesh rigid(int node);
  // How a joint moves within its parent's motion: the product of all these.
  struct Chain {
    std::vector<int> nodes;   // below the parent joint's, down to its own
    glm::dmat4 from_parent;   // to the soup's space in the bind pose; from the parent joint's, or the world
    std::vector<int> moving;  // of the nodes: from the first that moves to the last; if none does, the last
    bool several = false;     // of which more than one moves
  };
  void addNodesAbove();
  void sortJoints();
  void hangJoints(const std::vector<std::uint32_t>& place);
  Chain chainOf(std::size_t joint, const glm::dmat4& from_world);
  void endVertex();
  void addTargets(int node);
  // Appends the weights of all morph targets at a time.
  void addWeights(const std::vector<const GltfMorphChannel*>& channels, double time,
                  std::vector<float>& to) const;
  void joinMorphs();
  void addClip(const std::string& name, const std::vector<std::size_t>& members,
               const std::vector<bool>& reaches);

  const GltfModel& model_;
  const std::vector<GltfAnimation>& animations_;
  // Of each node: an animation moves it; it has shear, or is ever larger in one direction than in another.
  std::vector<bool> moved_, stretched_;
  std::map<int, Mesh> meshes_;  // by node
  std::map<int, Mesh> skins_;   // by skin
  std::vector<Mesh> sockets_;   // of skin_.sockets
  SourceSkin skin_;
  std::map<int, std::size_t> first_morph_;  // of nodes whose meshes have morph targets
  std::vector<double> rests_;               // of each morph target: its weight at rest
  std::vector<int> nodes_;                  // of each joint; -1: stands still
  std::vector<glm::dmat4> from_world_;      // of each joint: its node's space <- the world in the bind pose
  std::multimap<int, std::uint32_t>
      of_node_;                // the joints of a node: one, but where skins bind it differently
  std::vector<Chain> chains_;  // of each joint
  int vertex_node_ = -1;       // of the last vertex
};

}  // namespace kelp::bake
