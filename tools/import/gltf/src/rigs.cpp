// SPDX-License-Identifier: MIT
// The places where artists and exporters put extras.kelp, and which nodes it is the rig of.
#include <nlohmann/json.hpp>

#include "gltf_model.h"

namespace kelp::bake {
namespace {

std::string quoted(const char* kind, const std::string& name, const std::string& place) {
  return name.empty() ? place : std::string(kind) + " '" + oneLine(name, 60) + "'";
}

class RigFinder {
 public:
  explicit RigFinder(const GltfModel& model) : model_(model) {}

  GltfRigs find() {
    list("", model_.data);
    list("asset", model_.data.asset);
    list("scenes", model_.data.scenes);
    list("meshes", model_.data.meshes);
    list("nodes", model_.data.nodes);
    rigs_.nodes.resize(model_.data.nodes.size());
    std::vector<MeshUsers> users(model_.data.meshes.size());
    for (int node : model_.order) {
      const auto at = static_cast<std::size_t>(node);
      rigs_.nodes[at] = take(placeOf("nodes", at), model_.nodeName(node));
      if (const int mesh = model_.data.nodes[at].mesh; mesh >= 0) {
        MeshUsers& of_mesh = users[static_cast<std::size_t>(mesh)];
        if (of_mesh.count++ == 0) of_mesh.first = node;
      }
    }
    for (std::size_t mesh = 0; mesh < users.size(); ++mesh) takeMesh(mesh, users[mesh]);
    if (const int scene = model_.scene; scene >= 0) {
      const auto at = static_cast<std::size_t>(scene);
      takeFile(placeOf("scenes", at), quoted("scene", model_.data.scenes[at].name, placeOf("scenes", at)));
    }
    takeFile("asset", "asset");
    takeFile("", "the file's top");
    for (const auto& [place, text] : left_)
      model_.note(place + ".extras.kelp belongs to nothing that is baked; put it on the mesh's node");
    return std::move(rigs_);
  }

 private:
  template <class Owner>
  void list(const std::string& place, const Owner& owner) {
    // Blender's custom properties hold the rig as a string, hand-written files as an object. Both have the
    // rules of *.rig.json.
    if (!owner.extras.Has("kelp")) return;
    const auto extras = nlohmann::json::parse(owner.extras_json_string);
    const auto& kelp = extras["kelp"];
    // extras may be the rig itself: {"kelp": 1, ...}
    left_[place] = kelp.is_string()   ? kelp.template get<std::string>()
                   : kelp.is_object() ? kelp.dump()
                                      : extras.dump();
  }
  template <class Owner>
  void list(const std::string& place, const std::vector<Owner>& owners) {
    for (std::size_t i = 0; i < owners.size(); ++i) list(placeOf(place, i), owners[i]);
  }

  struct MeshUsers {
    int count = 0, first = -1;  // nodes
  };

  std::optional<GltfRig> take(const std::string& place, const std::string& owner) {
    const auto found = left_.find(place);
    if (found == left_.end()) return std::nullopt;
    GltfRig rig{std::move(found->second), owner};
    left_.erase(found);
    return rig;
  }

  // Blender exports the custom properties of an object to its node, those of its mesh to the mesh.
  void takeMesh(std::size_t mesh, const MeshUsers& users) {
    const std::string place = placeOf("meshes", mesh);
    if (users.count == 0) return;  // left over
    std::optional<GltfRig> rig = take(place, quoted("mesh", model_.data.meshes[mesh].name, place));
    if (!rig) return;
    if (users.count > 1) {
      model_.note("extras.kelp of " + rig->owner + ": " + std::to_string(users.count) +
                  " nodes use the mesh: no rig is made of it; put it on each of the nodes");
      return;
    }
    std::optional<GltfRig>& own = rigs_.nodes[static_cast<std::size_t>(users.first)];
    if (own)
      model_.note(own->owner + " and its " + rig->owner + " both have extras.kelp: the node's is the rig");
    else
      own = std::move(rig);
  }

  void takeFile(const std::string& place, const std::string& owner) {
    std::optional<GltfRig> rig = take(place, owner);
    if (!rig) return;
    if (rigs_.file)
      model_.note(rigs_.file->owner + " and " + owner + " both have extras.kelp: the rig is that of " +
                  rigs_.file->owner);
    else
      rigs_.file = std::move(rig);
  }

  const GltfModel& model_;
  // the text of every rig that nothing has taken yet, by its owner: "nodes[3]", "asset", "" (the root)
  std::map<std::string, std::string> left_;
  GltfRigs rigs_;
};

}  // namespace

GltfRigs findRigs(const GltfModel& model) { return RigFinder(model).find(); }

}  // namespace kelp::bake
