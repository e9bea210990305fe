// SPDX-License-Identifier: MIT
#include "gltf_model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>  // tinygltf's writer needs it and does not include it

#include <nlohmann/json.hpp>

// tinygltf is compiled here without file access and without image decoding: it only gets a string of JSON.
// Include its own header: gltf_model.h, if it was read before, would give no implementation. The linker would
// then take functions of the same names from Debian's libdraco, which holds another version of tinygltf.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace kelp::bake {
namespace {

// A text without any occurrence of `part`.
std::string without(const std::string& text, std::string_view part) {
  std::string out;
  std::size_t begin = 0;
  for (std::size_t at; (at = text.find(part, begin)) != std::string::npos; begin = at + part.size())
    out.append(text, begin, at - begin);
  return out.append(text, begin);
}

// Extensions that this importer reads, or that change only what kelp does not bake.
constexpr std::array<std::string_view, 25> kKnownExtensions = {
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "KHR_texture_basisu",  // by the plain pictures beside it; GltfImages refuses what has none
    "KHR_lights_punctual",
    "KHR_materials_diffuse_transmission",
    "EXT_mesh_manifold",
    "EXT_mesh_gpu_instancing",
    "KHR_node_visibility",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_clearcoat",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_anisotropy",
    "KHR_materials_iridescence",
    "KHR_materials_dispersion",
    "KHR_materials_variants",
    "KHR_xmp_json_ld"};
constexpr std::string_view kPointers = "KHR_animation_pointer";

// "<major>.<minor>". Any other text asks for nothing.
bool isAbove20(std::string_view version) {
  const std::size_t dot = std::min(version.find('.'), version.size());
  const auto number = [](std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc::result_out_of_range ? 1 << 30 : value;
  };
  const int major = number(version.substr(0, dot)),
            minor = number(version.substr(std::min(dot + 1, version.size())));
  return major > 2 || (major == 2 && minor > 0);
}

void checkVersion(const GltfModel& model) {
  const tinygltf::Asset& asset = model.data.asset;
  if (!asset.version.starts_with("2."))
    refuse(Exit::kUnsupported, model.files->input(), "asset",
           "is glTF " + oneLine(asset.version, 20) + "; export it as glTF 2.0");
  if (isAbove20(asset.minVersion))
    refuse(
        Exit::kUnsupported, model.files->input(), "asset",
        "needs a reader of glTF " + oneLine(asset.minVersion, 20) + " (minVersion); export it as glTF 2.0");
}

// Unknown extensions that are used and not required may have placed or shaped meshes: one notice for all.
void checkExtensions(const GltfModel& model) {
  constexpr std::size_t kShown = 8;
  const auto isKnown = [](const std::string& name) {
    // Those of VRM say how an avatar is lit, looks and swings.
    return name == kPointers || name.starts_with("VRM") ||
           std::ranges::find(kKnownExtensions, name) != kKnownExtensions.end();
  };
  for (const std::string& name : model.data.extensionsRequired)
    if (!isKnown(name))
      refuse(Exit::kUnsupported, model.files->input(), "extensionsRequired",
             "the file needs the extension '" + oneLine(name, 80) +
                 "', which kelp does not read; export without it");
  std::set<std::string> names(model.data.extensionsUsed.begin(), model.data.extensionsUsed.end());
  if (names.contains(std::string(kPointers)))
    model.note(
        "channels of KHR_animation_pointer are left out; animate translation, rotation and scale of "
        "nodes");
  std::erase_if(names, isKnown);
  if (names.empty()) return;
  std::string list;
  std::size_t shown = 0;
  for (const std::string& name : names)
    if (shown++ < kShown) list += (list.empty() ? "" : ", ") + oneLine(name, 40);
  if (names.size() > kShown) list += " and " + std::to_string(names.size() - kShown) + " more";
  model.note("extensions that kelp does not know are ignored: " + list +
             "; if they place, hide or shape meshes, export without them");
}

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

void checkNode(const GltfModel& model, std::size_t index) {
  const tinygltf::Node& node = model.data.nodes[index];
  const std::string place = placeOf("nodes", index);
  const auto size_ok = [](const std::vector<double>& values, std::size_t wanted) {
    return values.empty() || values.size() == wanted;
  };
  if (!size_ok(node.matrix, 16) || !size_ok(node.translation, 3) || !size_ok(node.rotation, 4) ||
      !size_ok(node.scale, 3))
    model.refuse(place, "has a transform with the wrong number of values");
  if (!finite(node.matrix) || !finite(node.translation) || !finite(node.rotation) || !finite(node.scale))
    model.refuse(place, "has a transform that is not finite");
  if (node.mesh < -1 || node.mesh >= static_cast<int>(model.data.meshes.size()))
    model.refuse(place, "names a mesh that does not exist");
  if (node.skin < -1 || node.skin >= static_cast<int>(model.data.skins.size()))
    model.refuse(place, "names a skin that does not exist");
  for (int child : node.children)
    if (child < 0 || child >= static_cast<int>(model.data.nodes.size()))
      model.refuse(place, "names a child that does not exist");
}

// The scene that was asked for, by its index or else by its name. The index comes first, so that every scene
// can be chosen, whatever the others are called.
int findScene(const GltfModel& model, const std::string& wanted) {
  const auto& scenes = model.data.scenes;
  int index = -1;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (error == std::errc() && end == wanted.data() + wanted.size() && index >= 0 &&
      index < static_cast<int>(scenes.size()))
    return index;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    if (!wanted.empty() && scenes[i].name == wanted) return static_cast<int>(i);
  std::string known;
  for (std::size_t i = 0; i < scenes.size() && i < 12; ++i)
    known += (known.empty() ? "" : ", ") + std::to_string(i) +
             (scenes[i].name.empty() ? "" : " '" + oneLine(scenes[i].name, 40) + "'");
  refuse(Exit::kUsage, model.files->input(), "--scene " + oneLine(wanted, 60),
         scenes.empty()
             ? "the file has no scenes; leave the option out"
             : "there is no such scene; the file has " + known + (scenes.size() > 12 ? " and more" : ""));
}

int chooseScene(const GltfModel& model, const std::optional<std::string>& wanted) {
  const auto& scenes = model.data.scenes;
  if (wanted) return findScene(model, *wanted);
  if (scenes.empty()) return -1;
  if (scenes.size() > 1)
    model.note("the file has " + std::to_string(scenes.size()) +
               " scenes: " + (model.data.defaultScene < 0 ? "the first" : "the default one") +
               " is baked; --scene chooses another");
  return std::max(model.data.defaultScene, 0);
}

std::vector<int> sceneRoots(const GltfModel& model) {
  const auto& scenes = model.data.scenes;
  std::vector<int> roots;
  if (model.scene >= 0) {
    if (model.scene >= static_cast<int>(scenes.size()))
      model.refuse("scene", "names a scene that does not exist");
    roots = scenes[static_cast<std::size_t>(model.scene)].nodes;
  } else {
    for (std::size_t i = 0; i < model.parents.size(); ++i)
      if (model.parents[i] < 0) roots.push_back(static_cast<int>(i));
  }
  for (int root : roots)
    if (root < 0 || root >= static_cast<int>(model.data.nodes.size()))
      model.refuse("scenes", "names a node that does not exist");
  return roots;
}

// Breadth first, without recursion. Every node has one parent, so a node that is reached twice closes a cycle
// or stands twice in the scene.
void orderNodes(GltfModel& model) {
  std::vector<bool> seen(model.data.nodes.size(), false);
  for (int root : sceneRoots(model)) model.order.push_back(root);
  for (std::size_t at = 0; at < model.order.size(); ++at) {
    const auto node = static_cast<std::size_t>(model.order[at]);
    if (seen[node])
      model.refuse(placeOf("nodes", node), "is reached twice; nodes must form trees without cycles");
    seen[node] = true;
    for (int child : model.data.nodes[node].children) model.order.push_back(child);
  }
  model.placed = model.order;
  std::set<int> skins;
  for (const int node : model.order) {
    const int skin = model.node(node).skin;
    if (skin < 0 || !skins.insert(skin).second) continue;
    for (const int joint : model.data.skins[static_cast<std::size_t>(skin)].joints) {
      std::vector<int> way;  // upwards
      int at = joint;
      for (; at >= 0 && at < static_cast<int>(seen.size()) && !seen[static_cast<std::size_t>(at)];
           at = model.parents[static_cast<std::size_t>(at)]) {
        seen[static_cast<std::size_t>(at)] = true;
        way.push_back(at);
      }
      if (std::ranges::find(way, at) != way.end())
        model.refuse(placeOf("nodes", static_cast<std::size_t>(at)),
                     "is below itself; nodes must form trees");
      model.placed.insert(model.placed.end(), way.rbegin(), way.rend());
    }
  }
}

}  // namespace

void placeNodes(GltfModel& model) {
  for (const int node : model.placed) {
    const auto at = static_cast<std::size_t>(node);
    const int parent = model.parents[at];
    const glm::dmat4 local = localMatrix(model.data.nodes[at]);
    model.world[at] = parent >= 0 ? model.world[static_cast<std::size_t>(parent)] * local : local;
  }
}

glm::dmat4 GltfTransform::matrix() const {
  return glm::translate(glm::dmat4(1), translation) * glm::mat4_cast(rotation) *
         glm::scale(glm::dmat4(1), scale);
}

std::string GltfModel::nodeName(int node) const {
  if (node < 0) return "the scene";
  const std::string& name = data.nodes[static_cast<std::size_t>(node)].name;
  return name.empty() ? placeOf("nodes", static_cast<std::size_t>(node)) : "node '" + oneLine(name, 60) + "'";
}

glm::dmat4 localMatrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  return restTransform(node).matrix();
}

GltfTransform restTransform(const tinygltf::Node& node, bool* exact) {
  GltfTransform out;
  if (exact) *exact = true;
  if (node.matrix.size() == 16) {
    const glm::dmat4 matrix = glm::make_mat4(node.matrix.data());
    out.translation = glm::dvec3(matrix[3]);
    out.scale = {glm::length(glm::dvec3(matrix[0])), glm::length(glm::dvec3(matrix[1])),
                 glm::length(glm::dvec3(matrix[2]))};
    if (glm::determinant(glm::dmat3(matrix)) < 0) out.scale.x = -out.scale.x;
    if (out.scale.x != 0 && out.scale.y != 0 && out.scale.z != 0) {
      glm::dmat3 turn(matrix);
      for (int axis = 0; axis < 3; ++axis) turn[axis] /= out.scale[axis];
      out.rotation = glm::normalize(glm::quat_cast(turn));
    }
    if (exact) {
      const glm::dmat4 again = out.matrix();
      for (int column = 0; column < 4; ++column)
        *exact =
            *exact && glm::length(again[column] - matrix[column]) <= 1e-5 * (1 + glm::length(matrix[column]));
    }
    return out;
  }
  if (node.translation.size() == 3) out.translation = glm::make_vec3(node.translation.data());
  if (node.scale.size() == 3) out.scale = glm::make_vec3(node.scale.data());
  if (node.rotation.size() == 4) {
    const glm::dquat turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (glm::length(turn) > 0) out.rotation = glm::normalize(turn);
  }
  return out;
}

void GltfModel::countRead(std::uint64_t elements, const std::string& place) const {
  constexpr std::uint64_t kMostElements = std::uint64_t{1} << 29;
  elements_read += elements;
  if (elements_read > kMostElements)
    refuse(place, "brings the nodes of the scene beyond " + std::to_string(kMostElements) +
                      " vertices, joints, primitives and values of theirs, shared ones counted anew; bake it "
                      "in pieces");
}

GltfModel readGltf(const InputFiles& files, DataBudget& budget, const std::optional<std::string>& scene,
                   std::vector<std::string>& notices) {
  GltfDocument document = readGltfDocument(files);
  GltfModel model;
  model.files = &files;
  model.notices = &notices;
  model.max_memory = budget.maxMemory();
  model.budget = &budget;
  tinygltf::TinyGLTF loader;
  loader.SetStoreOriginalJSONForExtrasAndExtensions(true);  // rigs are read from extras
  std::string error, warning;
  if (!loader.LoadASCIIFromString(&model.data, &error, &warning, document.json.c_str(),
                                  static_cast<unsigned int>(document.json.size()), ""))
    model.refuse("JSON", "is not valid glTF: " + oneLine(error));
  document.json = {};
  checkVersion(model);
  checkExtensions(model);
  // Faults for tinygltf that are none in the specification: a skin without matrices (they are the identity)
  // and a channel without a node (it belongs to an extension).
  for (const std::string_view optional :
       {"'inverseBindMatrices' property is missing in Skin.\n", "'node' property is missing.\n",
        "`node` field is missing in animation.channels.target\n"})
    error = without(error, optional);
  if (!error.empty() || !warning.empty()) model.note("JSON: " + oneLine(error + warning));
  model.images = std::move(document.images);
  model.buffers = std::make_unique<GltfBuffers>(files, document, budget);
  unpackMeshopt(model);
  unpackDraco(model);
  model.scene = chooseScene(model, scene);

  const std::size_t count = model.data.nodes.size();
  model.parents.assign(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    checkNode(model, i);
    for (int child : model.data.nodes[i].children) {
      int& parent = model.parents[static_cast<std::size_t>(child)];
      if (parent >= 0)
        model.refuse(placeOf("nodes", static_cast<std::size_t>(child)),
                     "has more than one parent; nodes must form trees");
      parent = static_cast<int>(i);
    }
  }
  orderNodes(model);
  model.world.assign(count, glm::dmat4(1));
  placeNodes(model);
  readNodeExtensions(model);
  return model;
}

}  // namespace kelp::bake
