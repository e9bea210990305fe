// SPDX-License-Identifier: MIT
// Meshes of a glTF file as triangles: primitive modes, morph targets and skins at rest, attributes of
// corners.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include "gltf_model.h"
#include "kelp/common/error.h"
#include "kelp/import/mesh/soup.h"
#include "skins.h"

namespace kelp::bake {
namespace {

// How far from one the weights of a vertex may sum without a word: a few of 8 bits each.
constexpr double kUneven = 0.02;

int attributeOf(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

// The joint matrices of a skin at rest, world <- mesh. Section 3.7.3 of the specification.
std::vector<glm::dmat4> jointMatrices(const GltfModel& model, int skin) {
  std::vector<glm::dmat4> matrices = inverseBindMatrices(model, skin);
  for (std::size_t j = 0; j < matrices.size(); ++j) {
    const int joint = model.data.skins[static_cast<std::size_t>(skin)].joints[j];
    matrices[j] = model.world[static_cast<std::size_t>(joint)] * matrices[j];
  }
  return matrices;
}

// The joints that move the vertices of a primitive, and how much: four a set.
struct Influences {
  std::vector<std::pair<GltfValues, GltfValues>> sets;  // joints, weights
  // Those of a vertex that count, as visit(joint, weight).
  template <class Visit>
  void each(std::size_t vertex, const Visit& visit) const {
    for (const auto& [joints, weights] : sets)
      for (int c = 0; c < 4; ++c)
        if (const auto weight = static_cast<double>(weights.at(vertex, c)); weight > 0)
          visit(static_cast<std::size_t>(joints.at(vertex, c)), weight);
  }
};

int modeOf(const tinygltf::Primitive& primitive) {
  return primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
}

class PrimitiveReader {
 public:
  // `instance`: node <- mesh; not used where the mesh has a skin. With `skins`: in the bind pose, and its
  // vertices are added to them.
  PrimitiveReader(const GltfModel& model, int node, const glm::dmat4& instance, const glm::dmat4& from_world,
                  GltfSkins* skins = nullptr)
      : model_(model), node_(model.node(node)), index_(node), skins_(skins) {
    if (skins) {
      to_part_ = from_world * skins->place(node) * instance;
      flip_ = glm::determinant(glm::dmat3(to_part_)) < 0;
    } else if (node_.skin >= 0) {
      for (const glm::dmat4& joint : jointMatrices(model, node_.skin)) joints_.push_back(from_world * joint);
      // Joints place a skinned mesh; the transform of its own node is ignored. Mirrored joints mirror the
      // mesh.
      flip_ = !joints_.empty() && glm::determinant(glm::dmat3(joints_[0])) < 0;
    } else {
      to_part_ = from_world * model.world[static_cast<std::size_t>(node)] * instance;
      flip_ = glm::determinant(glm::dmat3(to_part_)) < 0;
    }
    const glm::dmat3 linear(joints_.empty() ? to_part_ : joints_[0]);
    scale_ = static_cast<float>(
        std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])}));
  }

  // Long: it reads corners, colors, coordinates, morphs and weights of a primitive in one pass over its
  // triangles, and they share what is decided before.
  void read(const tinygltf::Primitive& primitive, const std::string& place,
            const std::vector<GltfMaterialUse>& materials, SoupBuilder& soup) {
    constexpr std::uint64_t kPrimitiveCost = 256;  // vertices
    model_.countRead(kPrimitiveCost, place);
    const int position = attributeOf(primitive, "POSITION");
    if (position < 0) {
      model_.noteOnce(place + ": has no positions and is skipped");
      return;
    }
    const int mode = modeOf(primitive);
    if (!hasTriangles(primitive)) {
      model_.noteOnce(place + ": holds points or lines, which have no volume, and is skipped");
      return;
    }
    const std::vector<glm::dvec3> positions = readPositions(primitive, position, place);
    const std::size_t count = positions.size();
    const float step = stepOf(model_, position);
    // A skin moves each vertex differently. Draco rounds each primitive on a grid of its own.
    if (step > 0 && joints_.empty() && !isDraco(model_, position))
      soup.roundedTo(step * scale_, to_part_, step);
    else
      soup.roundedTo(step * scale_);

    const std::uint32_t first_vertex = skins_ ? skins_->vertices() : 0;
    if (skins_) {
      addVertices(primitive, count, place);
      skins_->addOffsets(primitive, count, glm::dmat3(to_part_), place);
    }

    SoupBuilder::Triangle triangle;
    if (primitive.material >= static_cast<int>(model_.data.materials.size()))
      model_.refuse(place, "names a material that does not exist");
    triangle.material = static_cast<std::uint32_t>(
        primitive.material < 0 ? model_.data.materials.size() : static_cast<std::size_t>(primitive.material));
    const GltfMaterialUse& use = materials[triangle.material];
    GltfValues colors;
    std::vector<GltfValues> uvs(use.coordinates.size());
    for (std::size_t k = 0; k < uvs.size(); ++k) {
      const std::string name = "TEXCOORD_" + std::to_string(use.coordinates[k].set);
      const int accessor = attributeOf(primitive, name);
      if (accessor >= 0)
        uvs[k] = readSized(model_, accessor, 2, 2, count, place, name.c_str());
      else
        model_.noteOnce(fmt::format(
            "{}: its material has a texture but it has no {}: the texture's corner is used", place, name));
    }
    noteOtherColors(primitive, place);
    if (const int accessor = attributeOf(primitive, "COLOR_0"); accessor >= 0)
      colors = readSized(model_, accessor, 3, 4, count, place, "COLOR_0", true);

    std::vector<std::uint32_t> indices;
    if (primitive.indices >= 0) {
      indices = readIndices(model_, primitive.indices, place);
      model_.countRead(indices.size() / 6, place);
      for (std::uint32_t index : indices)
        if (index >= count)
          model_.refuse(place, "has the index " + std::to_string(index) + " but only " +
                                   std::to_string(count) + " vertices");
    } else {
      indices.resize(count);
      for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<std::uint32_t>(i);
    }
    if (mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0)
      model_.noteOnce(place + ": the number of indices is not a multiple of three: the rest is dropped");

    std::size_t kept = 0, cut = 0;
    const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const auto alpha = [&](std::uint32_t i) {
        return use.keep_alpha && colors.components == 4 ? colors.at(i, 3) : 1.0f;
      };
      const bool none = std::max({alpha(a), alpha(b), alpha(c)}) < use.least_alpha;
      ++(none ? cut : kept);
      if (none) return;
      const std::array<std::uint32_t, 3> corner =
          flip_ ? std::array<std::uint32_t, 3>{a, c, b} : std::array<std::uint32_t, 3>{a, b, c};
      for (std::size_t i = 0; i < 3; ++i) triangle.position[i] = glm::vec3(positions[corner[i]]);
      for (std::size_t k = 0; k < uvs.size(); ++k) {
        if (uvs[k].values.empty()) continue;
        auto& uv = k == 0 ? triangle.uv : triangle.more_uv[k - 1];
        uv.emplace();
        for (std::size_t i = 0; i < 3; ++i)
          (*uv)[i] = glm::vec2(use.coordinates[k].transform *
                               glm::vec3(uvs[k].at(corner[i], 0), uvs[k].at(corner[i], 1), 1));
      }
      if (skins_)
        triangle.skinned = {first_vertex + corner[0], first_vertex + corner[1], first_vertex + corner[2]};
      if (!colors.values.empty()) {
        triangle.color.emplace();
        for (std::size_t i = 0; i < 3; ++i)
          (*triangle.color)[i] = {colors.at(corner[i], 0), colors.at(corner[i], 1), colors.at(corner[i], 2),
                                  alpha(corner[i])};
      }
      if (!soup.add(triangle))
        model_.refuse(place, "brings the file beyond 64 million triangles; bake it in pieces");
    };
    // Section 3.7.2.1 of the specification: strips and fans, with the winding of each triangle.
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        emit(indices[i], indices[i + 1], indices[i + 2]);
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      for (std::size_t i = 0; i + 2 < indices.size(); ++i)
        emit(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
    } else {
      for (std::size_t i = 1; i + 1 < indices.size(); ++i) emit(indices[i], indices[i + 1], indices[0]);
    }
    if (cut > 0 && kept == 0 && model_.cut_out.emplace(place, use.blends).second)
      model_.noteOnce(
          place +
          (use.blends ? ": its alpha is 0" : ": its alphaMode is MASK, and its alpha is below the cutoff") +
          " everywhere: it is left out");
    else if (cut > 0 && use.blends)
      model_.noteOnce(
          fmt::format("{}: the alpha of {} of its triangles is 0: they are left out", place, cut));
  }

  // Extends a box by the positions of the primitives that read() turns into triangles.
  void enclose(const tinygltf::Primitive& primitive, const std::string& place, glm::dvec3& low,
               glm::dvec3& high) const {
    const int position = attributeOf(primitive, "POSITION");
    if (position < 0 || !hasTriangles(primitive)) return;
    for (const glm::dvec3& p : readPositions(primitive, position, place)) {
      if (!std::isfinite(p.x + p.y + p.z)) continue;
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }

 private:
  // In the part's space, at rest.
  std::vector<glm::dvec3> readPositions(const tinygltf::Primitive& primitive, int accessor,
                                        const std::string& place) const {
    const GltfValues values = readValues(model_, accessor, place + ".POSITION");
    if (values.components != 3) model_.refuse(place, "POSITION is not a VEC3");
    model_.countRead(values.count, place);
    std::vector<glm::dvec3> local(values.count);
    for (std::size_t i = 0; i < values.count; ++i)
      local[i] = {values.at(i, 0), values.at(i, 1), values.at(i, 2)};
    applyMorph(primitive, place, local);
    std::vector<glm::dvec3> out(local.size());
    if (joints_.empty() || attributeOf(primitive, "JOINTS_0") < 0) {
      const glm::dmat4& matrix = joints_.empty() ? to_part_ : joints_[0];
      for (std::size_t i = 0; i < local.size(); ++i) out[i] = glm::dvec3(matrix * glm::dvec4(local[i], 1));
      return out;
    }
    const Influences influences = readInfluences(primitive, local.size(), place);
    for (std::size_t i = 0; i < local.size(); ++i) {
      glm::dvec3 sum(0);
      double total = 0;
      influences.each(i, [&](std::size_t joint, double weight) {
        sum += weight * glm::dvec3(joints_[joint] * glm::dvec4(local[i], 1));
        total += weight;
      });
      out[i] = total > 0 ? sum / total : glm::dvec3(joints_[0] * glm::dvec4(local[i], 1));
    }
    return out;
  }

  // Colors that glTF does not draw: further sets, and exporters' own names.
  void noteOtherColors(const tinygltf::Primitive& primitive, const std::string& place) const {
    for (const auto& [name, accessor] : primitive.attributes) {
      std::string lower = name;
      std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
      if (name != "COLOR_0" && (lower.find("color") != std::string::npos || lower.starts_with("_rgb")))
        model_.noteOnce(place + "." + oneLine(name, 40) +
                        ": is not read; vertex colors are those of COLOR_0");
    }
  }

  Influences readInfluences(const tinygltf::Primitive& primitive, std::size_t count,
                            const std::string& place) const {
    Influences out;
    const std::size_t known = model_.data.skins[static_cast<std::size_t>(node_.skin)].joints.size();
    for (int set = 0; set < 16; ++set) {  // more than four influences come in further sets
      const std::string suffix = std::to_string(set);
      const int joints_at = attributeOf(primitive, "JOINTS_" + suffix),
                weights_at = attributeOf(primitive, "WEIGHTS_" + suffix);
      if (joints_at < 0 || weights_at < 0) break;
      auto& [joints, weights] =
          out.sets.emplace_back(readSized(model_, joints_at, 4, 4, count, place, "JOINTS"),
                                readSized(model_, weights_at, 4, 4, count, place, "WEIGHTS"));
      for (std::size_t i = 0; i < joints.values.size(); ++i)
        if (const float named = joints.values[i];
            weights.values[i] > 0 && !(named >= 0 && named < static_cast<float>(known)))
          model_.refuse(place, "has a vertex that names a joint which its skin does not have");
    }
    return out;
  }

  void addVertices(const tinygltf::Primitive& primitive, std::size_t count, const std::string& place) const {
    Influences influences;
    if (node_.skin >= 0) influences = readInfluences(primitive, count, place);
    std::size_t uneven = 0;
    for (std::size_t i = 0; i < count; ++i) {
      skins_->beginVertex(index_);
      double sum = 0;
      influences.each(i, [&](std::size_t joint, double weight) {
        skins_->addInfluence(joint, weight);
        sum += weight;
      });
      if (node_.skin >= 0 && !(std::abs(sum - 1) <= kUneven)) ++uneven;
    }
    if (uneven > 0)
      model_.noteOnce(fmt::format(
          "{} of node {}: the weights of {} of its {} vertices do not sum to one: they are scaled "
          "so that they do, and vertices without any follow the first joint",
          place, node_.name.empty() ? std::to_string(index_) : "'" + node_.name + "'", uneven, count));
  }

  void applyMorph(const tinygltf::Primitive& primitive, const std::string& place,
                  std::vector<glm::dvec3>& positions) const {
    const std::vector<double>& weights = restingWeights(model_, index_);
    for (std::size_t target = 0; target < primitive.targets.size() && target < weights.size(); ++target) {
      if (weights[target] == 0) continue;
      const std::vector<glm::dvec3> by = readTarget(model_, primitive, target, positions.size(), place);
      for (std::size_t i = 0; i < by.size(); ++i) positions[i] += weights[target] * by[i];
    }
  }

  const GltfModel& model_;
  const tinygltf::Node& node_;
  int index_;
  GltfSkins* skins_;
  glm::dmat4 to_part_{1};
  std::vector<glm::dmat4> joints_;
  float scale_ = 1;  // the most that a length grows on its way to the part
  bool flip_ = false;
};

// Where the node's mesh stands, in its node's space.
const std::vector<glm::dmat4>& placesOf(const GltfModel& model, int node) {
  static const std::vector<glm::dmat4> kOne{glm::dmat4(1)};
  const auto found = model.instances.find(node);
  return found == model.instances.end() ? kOne : found->second;
}

}  // namespace

bool hasTriangles(const tinygltf::Primitive& primitive) {
  const int mode = modeOf(primitive);
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

void addMesh(const GltfModel& model, int node, const glm::dmat4& from_world,
             const std::vector<GltfMaterialUse>& materials, SoupBuilder& soup, GltfSkins* skins) {
  const int mesh_index = model.node(node).mesh;
  if (mesh_index < 0) return;
  const tinygltf::Mesh& mesh = model.data.meshes[static_cast<std::size_t>(mesh_index)];
  for (const glm::dmat4& instance : placesOf(model, node)) {
    PrimitiveReader reader(model, node, instance, from_world, skins);
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p)
      reader.read(mesh.primitives[p],
                  placeOf("meshes", static_cast<std::size_t>(mesh_index)) + "." + placeOf("primitives", p),
                  materials, soup);
  }
}

std::optional<glm::dvec3> middleOf(const GltfModel& model, const std::vector<int>& nodes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (int node : nodes) {
    const int mesh = model.node(node).mesh;
    if (mesh < 0) continue;
    for (const glm::dmat4& instance : placesOf(model, node)) {
      const PrimitiveReader reader(model, node, instance, glm::dmat4(1));
      for (const tinygltf::Primitive& primitive :
           model.data.meshes[static_cast<std::size_t>(mesh)].primitives)
        reader.enclose(primitive, placeOf("meshes", static_cast<std::size_t>(mesh)), low, high);
    }
  }
  return floatMiddle(low, high);
}

void explainEmptiness(const GltfModel& model) {
  bool meshes = false, triangles = false;
  for (int node : model.order) {
    const int mesh = model.node(node).mesh;
    if (mesh < 0) continue;
    meshes = true;
    for (const tinygltf::Primitive& primitive : model.data.meshes[static_cast<std::size_t>(mesh)].primitives)
      triangles = triangles || hasTriangles(primitive);
  }
  const std::string last = model.notices->empty() ? "" : " (" + model.notices->back() + ")";
  if (!model.cut_out.empty())
    refuse(Exit::kUnsupported, model.files->input(), "scene",
           "shows nothing: the alpha of " + model.cut_out.begin()->first +
               (model.cut_out.size() > 1 ? " and others" : "") +
               (model.cut_out.begin()->second
                    ? " is 0 everywhere; raise the alpha"
                    : " is below the cutoff of alphaMode MASK everywhere; raise the alpha, or lower "
                      "alphaCutoff"));
  if (triangles)
    model.refuse("scene", "holds no triangles" + last + "; export a scene with at least one mesh");
  if (meshes)
    refuse(Exit::kUnsupported, model.files->input(), "scene",
           "holds no triangles" + last + "; export a scene with at least one mesh of triangles");
  if (!model.data.meshes.empty() && model.hidden_meshes == 0)
    model.note("the file has " + std::to_string(model.data.meshes.size()) +
               " meshes that no node of its scene shows");
}

}  // namespace kelp::bake
