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

std::vector<glm::dvec3> readTarget(const GltfModel& model, const tinygltf::Primitive& primitive,
                                   std::size_t target, std::size_t count, const std::string& place) {
  const auto found = primitive.targets[target].find("POSITION");
  if (found == primitive.targets[target].end()) return {};
  const GltfValues delta = readSized(model, found->second, 3, 3, count, place, "morph target");
  model.countRead(count, place);
  std::vector<glm::dvec3> offsets(count);
  for (std::size_t i = 0; i < count; ++i) offsets[i] = {delta.at(i, 0), delta.at(i, 1), delta.at(i, 2)};
  return offsets;
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
  constexpr std::size_t kMostText = 400;
  std::string resting;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name;
    if (names.IsArray() && i < names.ArrayLen() && names.Get(static_cast<int>(i)).IsString())
      name = oneLine(names.Get(static_cast<int>(i)).Get<std::string>(), 80);
    if (name.empty())
      name =
          fmt::format("{}.{}", mesh.name.empty() ? fmt::format("mesh {}", index) : oneLine(mesh.name, 80), i);
    if (rest[i] != 0 && resting.size() < kMostText)
      resting += fmt::format("{}'{}' {:g}", resting.empty() ? "" : ", ", name, rest[i]);
    skin_.morphs.push_back({std::move(name), {}, {}});
  }
  if (!resting.empty())
    model_.noteOnce(
        fmt::format("{}: its morph targets do not rest at 0: the weights of a pack are those of "
                    "the file less what they rest at: {}",
                    model_.nodeName(node), resting));
  rests_.insert(rests_.end(), rest.begin(), rest.end());
}

void GltfSkins::addOffsets(const tinygltf::Primitive& primitive, std::size_t count,
                           const glm::dmat3& to_space, const std::string& place) {
  const std::uint32_t first = vertices() - static_cast<std::uint32_t>(count);
  for (std::size_t target = 0; target < primitive.targets.size(); ++target) {
    const std::vector<glm::dvec3> offsets = readTarget(model_, primitive, target, count, place);
    SourceSkin::Morph& morph = skin_.morphs[first_morph_.at(vertex_node_) + target];
    const std::size_t before = morph.vertices.size();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const glm::vec3 by(to_space * offsets[i]);
      if (!std::isfinite(by.x + by.y + by.z))
        model_.refuse(place, fmt::format("has a morph target that moves vertex {} to no finite place", i));
      if (by == glm::vec3(0)) continue;
      morph.vertices.push_back(first + static_cast<std::uint32_t>(i));
      morph.offsets.push_back(by);
    }
    model_.budget->take((morph.vertices.size() - before) * (sizeof(std::uint32_t) + sizeof(glm::vec3)),
                        place);
  }
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
    return std::all_of(skin_.clips.begin(), skin_.clips.end(), [&](const SourceSkin::Clip& clip) {
      for (std::size_t i = 0; i < clip.weights.size(); i += count)
        if (clip.weights[i + a] != clip.weights[i + b]) return false;
      return true;
    });
  };
  std::map<std::pair<std::string, double>, std::vector<std::size_t>> by_name;  // and rest
  std::vector<SourceSkin::Morph> joined;
  std::vector<std::size_t> kept, place(count);
  for (std::size_t m = 0; m < count; ++m) {
    SourceSkin::Morph& its = skin_.morphs[m];
    std::vector<std::size_t>& same = by_name[{its.name, rests_[m]}];
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
