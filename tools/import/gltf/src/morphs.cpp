// SPDX-License-Identifier: MIT
// Morph targets: which a file has, where they move vertices, and which of them move as one.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "skins.h"

namespace kelp::bake {

std::size_t targetCount(const tinygltf::Mesh& mesh) {
  std::size_t most = 0;
  for (const tinygltf::Primitive& primitive : mesh.primitives)
    most = std::max(most, primitive.targets.size());
  return most;
}

const std::vector<double>& restingWeights(const GltfModel& model, int node) {
  const tinygltf::Node& its = model.node(node);
  return its.weights.empty() ? model.data.meshes[at(its.mesh)].weights : its.weights;
}

bool hasMorphs(const GltfModel& model) {
  return std::any_of(model.order.begin(), model.order.end(), [&](int node) {
    if (model.node(node).mesh < 0) return false;
    const tinygltf::Mesh& mesh = model.data.meshes[at(model.node(node).mesh)];
    return std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [](const auto& primitive) {
      return hasTriangles(primitive) &&
             std::any_of(primitive.targets.begin(), primitive.targets.end(),
                         [](const auto& target) { return target.contains("POSITION"); });
    });
  });
}

void GltfSkins::addTargets(int node) {
  const int index = model_.node(node).mesh;
  const tinygltf::Mesh& mesh = model_.data.meshes[at(index)];
  const std::size_t count = targetCount(mesh);
  if (count == 0) return;
  const std::string place = placeOf("meshes", at(index));
  model_.countRead(count, place);
  model_.budget->take(count * sizeof(SourceSkin::Morph), place);
  first_morph_[node] = skin_.morphs.size();
  const tinygltf::Value names =
      mesh.extras.Has("targetNames") ? mesh.extras.Get("targetNames") : tinygltf::Value();
  std::vector<double> rest = restingWeights(model_, node);
  rest.resize(count, 0);
  std::string resting;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name;
    if (names.IsArray() && i < names.ArrayLen() && names.Get(static_cast<int>(i)).IsString())
      name = oneLine(names.Get(static_cast<int>(i)).Get<std::string>(), 80);
    if (name.empty())
      name =
          fmt::format("{}.{}", mesh.name.empty() ? fmt::format("mesh {}", index) : oneLine(mesh.name, 80), i);
    if (!std::isfinite(rest[i])) model_.refuse(place, "rests at a weight that is not finite");
    if (rest[i] != 0) resting += fmt::format("{}'{}' {:g}", resting.empty() ? "" : ", ", name, rest[i]);
    skin_.morphs.push_back({std::move(name), {}, {}});
  }
  if (!resting.empty())
    model_.noteOnce(
        fmt::format("{}: its morph targets do not rest at 0: the weights of a pack are those of "
                    "the file less what they rest at: {}",
                    model_.nodeName(node), resting));
  rests_.insert(rests_.end(), rest.begin(), rest.end());
}

void GltfSkins::addOffset(std::size_t target, std::uint32_t vertex, const glm::vec3& by) {
  SourceSkin::Morph& morph = skin_.morphs[first_morph_.at(vertex_node_) + target];
  morph.vertices.push_back(vertex);
  morph.offsets.push_back(by);
}

void GltfSkins::addWeights(const std::vector<const GltfMorphChannel*>& channels, double time,
                           std::vector<float>& to) const {
  const std::size_t first = to.size();
  to.resize(first + skin_.morphs.size(), 0);
  for (const GltfMorphChannel* channel : channels) {
    const std::vector<double> weights = evaluate(*channel, time);
    const std::size_t morph = first_morph_.at(channel->node);
    for (std::size_t i = 0; i < weights.size(); ++i)
      to[first + morph + i] = static_cast<float>(weights[i] - rests_[morph + i]);
  }
}

// Targets of one name that rest alike, and whose weights are the same in all clips, become one.
void GltfSkins::joinMorphs() {
  const std::size_t count = skin_.morphs.size();
  const auto alike = [&](std::size_t a, std::size_t b) {
    return rests_[a] == rests_[b] &&
           std::all_of(skin_.clips.begin(), skin_.clips.end(), [&](const SourceSkin::Clip& clip) {
             for (std::size_t i = 0; i < clip.weights.size(); i += count)
               if (clip.weights[i + a] != clip.weights[i + b]) return false;
             return true;
           });
  };
  std::map<std::string, std::vector<std::size_t>> by_name;
  std::vector<SourceSkin::Morph> joined;
  std::vector<std::size_t> kept, place(count);
  for (std::size_t m = 0; m < count; ++m) {
    SourceSkin::Morph& its = skin_.morphs[m];
    std::vector<std::size_t>& same = by_name[its.name];
    const auto found = std::find_if(same.begin(), same.end(), [&](std::size_t k) { return alike(k, m); });
    if (found == same.end()) {
      same.push_back(m);
      place[m] = kept.size();
      kept.push_back(m);
      joined.push_back(std::move(its));
      continue;
    }
    SourceSkin::Morph& other = joined[place[*found]];
    other.vertices.insert(other.vertices.end(), its.vertices.begin(), its.vertices.end());
    other.offsets.insert(other.offsets.end(), its.offsets.begin(), its.offsets.end());
  }
  skin_.keepMorphs(kept);
  skin_.morphs = std::move(joined);
}

}  // namespace kelp::bake
