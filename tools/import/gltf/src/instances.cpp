// SPDX-License-Identifier: MIT
// Extensions of nodes: which are hidden, and which stand in many places.
#include <cmath>

#include <fmt/format.h>

#include "gltf_model.h"
#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

// A member of an extension of a node; null if there is none.
const tinygltf::Value* memberOf(const tinygltf::Node& node, const char* extension, const char* name) {
  const auto found = node.extensions.find(extension);
  if (found == node.extensions.end() || !found->second.IsObject() || !found->second.Has(name)) return nullptr;
  return &found->second.Get(name);
}

// KHR_node_visibility: a node that is hidden hides all below it.
void hideNodes(GltfModel& model) {
  std::vector<bool> hidden(model.data.nodes.size(), false);
  std::size_t& meshes = model.hidden_meshes;
  for (const int node : model.order) {
    const auto at = static_cast<std::size_t>(node);
    const int parent = model.parents[at];
    const tinygltf::Value* const visible = memberOf(model.node(node), "KHR_node_visibility", "visible");
    hidden[at] = (parent >= 0 && hidden[static_cast<std::size_t>(parent)]) ||
                 (visible && visible->IsBool() && !visible->Get<bool>());
    if (!hidden[at] || model.node(node).mesh < 0) continue;
    model.data.nodes[at].mesh = -1;
    ++meshes;
  }
  if (meshes > 0)
    model.note(fmt::format("the file hides {} node{} with a mesh (KHR_node_visibility): {} left out", meshes,
                           meshes == 1 ? "" : "s", meshes == 1 ? "it is" : "they are"));
}

// One attribute of all instances of a node; nullopt if they do not have it.
std::optional<GltfValues> readAttribute(const GltfModel& model, const tinygltf::Value& attributes,
                                        const char* name, int components, const std::string& place) {
  if (!attributes.Has(name)) return std::nullopt;
  const tinygltf::Value& accessor = attributes.Get(name);
  if (!accessor.IsInt()) model.refuse(place, std::string(name) + " is not the number of an accessor");
  GltfValues values = readValues(model, accessor.GetNumberAsInt(), place + "." + name);
  if (values.components != components)
    model.refuse(place, fmt::format("{} has {} components, not {}", name, values.components, components));
  for (const float value : values.values)
    if (!std::isfinite(value))
      model.refuse(place, std::string(name) + " has a number that is infinite or none");
  return values;
}

// EXT_mesh_gpu_instancing. Attributes with other names are data of the application.
void readInstances(GltfModel& model, int node) {
  const tinygltf::Value* const attributes =
      memberOf(model.node(node), "EXT_mesh_gpu_instancing", "attributes");
  if (!attributes || model.node(node).mesh < 0) return;
  const std::string place = model.nodeName(node) + ".EXT_mesh_gpu_instancing";
  if (!attributes->IsObject()) model.refuse(place, "has attributes that are no object");
  if (model.node(node).skin >= 0) {
    model.note(place + ": its mesh bends by joints, which place it: it is baked once");
    return;
  }
  const std::optional<GltfValues> shift = readAttribute(model, *attributes, "TRANSLATION", 3, place),
                                  turn = readAttribute(model, *attributes, "ROTATION", 4, place),
                                  scale = readAttribute(model, *attributes, "SCALE", 3, place);
  std::optional<std::size_t> count;
  for (const auto* values : {&shift, &turn, &scale}) {
    if (!*values) continue;
    if (count && *count != (*values)->count)
      model.refuse(place, fmt::format("has attributes of {} and of {} instances", *count, (*values)->count));
    count = (*values)->count;
  }
  if (!count) return;  // one instance, where the node is
  if (*count == 0) {
    model.note(place + ": has no instances: its mesh is left out");
    model.data.nodes[static_cast<std::size_t>(node)].mesh = -1;
    return;
  }
  model.budget->take(*count * sizeof(glm::dmat4), place);
  std::vector<glm::dmat4>& instances = model.instances[node];
  instances.reserve(*count);
  const auto vector = [](const GltfValues& values, std::size_t i) {
    return glm::dvec3(values.at(i, 0), values.at(i, 1), values.at(i, 2));
  };
  for (std::size_t i = 0; i < *count; ++i) {
    GltfTransform its;
    if (shift) its.translation = vector(*shift, i);
    if (scale) its.scale = vector(*scale, i);
    if (turn) {
      const glm::dquat q(turn->at(i, 3), turn->at(i, 0), turn->at(i, 1), turn->at(i, 2));
      if (glm::length(q) > 0) its.rotation = glm::normalize(q);
    }
    instances.push_back(its.matrix());
  }
}

}  // namespace

void readNodeExtensions(GltfModel& model) {
  hideNodes(model);
  for (const int node : model.order) readInstances(model, node);
}

}  // namespace kelp::bake
