// SPDX-License-Identifier: MIT
#include "skins.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include "kelp/common/error.h"

namespace kelp::bake {

bool isRegular(const glm::dmat4& m) {
  const double volume = std::abs(glm::determinant(glm::dmat3(m)));
  return volume > 1e-30 && std::isfinite(volume);
}

bool isFinite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    if (!std::isfinite(glm::dot(m[column], glm::dvec4(1)))) return false;
  return true;
}

namespace {

// Motions of joints that differ by less, of the skin's size, are one.
constexpr double kSameBind = 1e-5;

bool isNear(const glm::dmat4& a, const glm::dmat4& b) {
  double apart = 0, size = 0;
  for (int column = 0; column < 4; ++column) {
    apart = std::max(apart, glm::length(a[column] - b[column]));
    size = std::max(size, glm::length(a[column]));
  }
  return apart <= kSameBind * size;
}

bool isUneven(const glm::dvec3& scale) {
  constexpr double kEven = 1e-6;
  const glm::dvec3 size = glm::abs(scale);
  const double most = std::max({size.x, size.y, size.z});
  return most - std::min({size.x, size.y, size.z}) > kEven * most;
}

}  // namespace

bool hasSkins(const GltfModel& model) {
  return std::any_of(model.order.begin(), model.order.end(), [&](int node) {
    return model.node(node).mesh >= 0 && model.node(node).skin >= 0 &&
           !model.data.skins[static_cast<std::size_t>(model.node(node).skin)].joints.empty();
  });
}

bool rigsJoints(const GltfModel& model, const RigFile& rig) {
  for (const tinygltf::Skin& skin : model.data.skins)
    for (const int joint : skin.joints)
      if (joint >= 0 && joint < static_cast<int>(model.data.nodes.size()) &&
          rig.find(oneLine(model.node(joint).name, 80)))
        return true;
  return false;
}

bool movesJoints(const GltfModel& model, const std::vector<GltfAnimation>& animations) {
  // The joints and all nodes above them.
  std::vector<bool> reaches(model.data.nodes.size(), false);
  std::set<int> seen;
  for (const int node : model.order) {
    const int skin = model.node(node).skin;
    if (model.node(node).mesh < 0 || skin < 0 || !seen.insert(skin).second) continue;
    for (int joint : model.data.skins[static_cast<std::size_t>(skin)].joints) {
      if (joint < 0 || static_cast<std::size_t>(joint) >= reaches.size()) continue;
      for (; joint >= 0 && !reaches[static_cast<std::size_t>(joint)];
           joint = model.parents[static_cast<std::size_t>(joint)])
        reaches[static_cast<std::size_t>(joint)] = true;
    }
  }
  return std::any_of(animations.begin(), animations.end(), [&](const GltfAnimation& animation) {
    return std::any_of(animation.channels.begin(), animation.channels.end(), [&](const GltfChannel& channel) {
      return reaches[static_cast<std::size_t>(channel.node)] && moves(model, channel);
    });
  });
}

std::vector<glm::dmat4> inverseBindMatrices(const GltfModel& model, int index) {
  const tinygltf::Skin& skin = model.data.skins[static_cast<std::size_t>(index)];
  const std::string place = placeOf("skins", static_cast<std::size_t>(index));
  model.countRead(skin.joints.size(), place);
  std::vector<glm::dmat4> matrices(skin.joints.size(), glm::dmat4(1));
  for (const int joint : skin.joints)
    if (joint < 0 || joint >= static_cast<int>(model.data.nodes.size()))
      model.refuse(place, "names a joint that does not exist");
  if (skin.inverseBindMatrices < 0) return matrices;
  const GltfValues values = readValues(model, skin.inverseBindMatrices, place);
  if (values.components != 16 || values.count < skin.joints.size())
    model.refuse(place, "has too few inverse bind matrices");
  for (std::size_t j = 0; j < matrices.size(); ++j)
    matrices[j] = glm::dmat4(glm::make_mat4(values.values.data() + 16 * j));
  for (std::size_t j = 0; j < matrices.size(); ++j)
    if (!isFinite(matrices[j]))
      model.refuse(place, "has an inverse bind matrix of " + model.nodeName(skin.joints[j]) +
                              " with a number that is infinite or none");
  return matrices;
}

GltfSkins::GltfSkins(const GltfModel& model, const std::vector<GltfAnimation>& animations,
                     const std::vector<std::pair<int, std::string>>& sockets)
    : model_(model), animations_(animations), moved_(model.data.nodes.size(), false), stretched_(moved_) {
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    bool exact = true;
    stretched_[i] = isUneven(restTransform(model.data.nodes[i], &exact).scale) || !exact;
  }
  for (const GltfAnimation& animation : animations)
    for (const GltfChannel& channel : animation.channels) {
      if (!moves(model, channel)) continue;
      moved_[at(channel.node)] = true;
      if (channel.path != GltfChannel::Path::kScale) continue;
      for (const glm::dvec4& value : channel.values)
        if (channel.interpolation == Interpolation::kCubic || isUneven(glm::dvec3(value)))
          stretched_[at(channel.node)] = true;
    }
  const auto hasJoints = [&](int node) {
    const int skin = model.node(node).skin;
    return skin >= 0 && !model.data.skins[static_cast<std::size_t>(skin)].joints.empty();
  };
  for (const int node : model.order)
    if (model.node(node).mesh >= 0 && hasJoints(node)) addSkinned(node);
  for (const int node : model.order)
    if (model.node(node).mesh >= 0 && !hasJoints(node)) meshes_[node] = rigid(node);
  for (const int node : model.order)
    if (model.node(node).mesh >= 0) addTargets(node);
  for (const auto& [node, name] : sockets) {
    const Mesh socket = rigid(node);
    if (!isRegular(socket.place) || !isFinite(socket.place)) {
      model.note(model.nodeName(node) + ": no socket is made of it: its place or scale is beyond sense");
      continue;
    }
    sockets_.push_back(socket);
    skin_.sockets.push_back({name, 0, sockets_.back().place});
  }
  addNodesAbove();
  sortJoints();
}

// Nodes between joints, and above all, are joints that move no vertex where the motions of several nodes
// together are no translation, rotation and scale.
void GltfSkins::addNodesAbove() {
  const std::vector<int> joints = nodes_;
  for (const int joint : joints) {
    std::vector<int> moving;  // below the next joint, the lowest first
    bool stretched = false;
    for (int node = joint; node >= 0 && (node == joint || !of_node_.contains(node)); node = parentOf(node)) {
      if (moved_[at(node)]) moving.push_back(node);
      if (!moving.empty() && node != moving.front() && stretched_[at(node)]) stretched = true;
    }
    for (std::size_t i = moving.size(); stretched && i-- > 1;)
      if (isRegular(worldOf(moving[i]))) (void)rigid(moving[i]);
  }
}

std::uint32_t GltfSkins::jointOf(int node, const glm::dmat4& from_world) {
  const auto [begin, end] = of_node_.equal_range(node);
  for (auto at = begin; at != end; ++at)
    if (isNear(from_world_[at->second], from_world)) return at->second;
  const auto joint = static_cast<std::uint32_t>(nodes_.size());
  of_node_.emplace(node, joint);
  nodes_.push_back(node);
  from_world_.push_back(from_world);
  SourceSkin::Joint& made = skin_.joints.emplace_back();
  if (node >= 0) made.name = oneLine(model_.node(node).name, 80);
  if (made.name.empty()) made.name = node < 0 ? "scene" : fmt::format("node {}", node);
  return joint;
}

// The bind pose is placed as the skin's uppermost joint places it at rest.
void GltfSkins::addSkinned(int node) {
  const int skin = model_.node(node).skin;
  const auto [at, fresh] = skins_.try_emplace(skin);
  Mesh& mesh = at->second;
  if (fresh) {
    const std::vector<int>& joints = model_.data.skins[static_cast<std::size_t>(skin)].joints;
    const std::vector<glm::dmat4> inverse = inverseBindMatrices(model_, skin);
    for (const int candidate : model_.placed) {
      const auto found = std::find(joints.begin(), joints.end(), candidate);
      if (found == joints.end()) continue;
      mesh.place = model_.world[static_cast<std::size_t>(candidate)] *
                   inverse[static_cast<std::size_t>(found - joints.begin())];
      if (isRegular(mesh.place)) break;
    }
    if (!isRegular(mesh.place)) mesh.place = glm::dmat4(1);
    const glm::dmat4 back = glm::inverse(mesh.place);
    for (std::size_t j = 0; j < joints.size(); ++j)
      mesh.joints.push_back(jointOf(joints[j], inverse[j] * back));
  }
  meshes_[node] = mesh;
}

// A mesh without a skin, or an empty.
GltfSkins::Mesh GltfSkins::rigid(int node) {
  // A joint above moves the mesh between rest and bind pose as it moves its children.
  glm::dmat4 bind(1);
  for (int at = node; at >= 0; at = parentOf(at)) {
    const auto found = of_node_.find(at);
    if (found == of_node_.end()) continue;
    const glm::dmat4 to_joint = worldOf(at) * from_world_[found->second];
    if (isRegular(to_joint)) bind = glm::inverse(to_joint);
    break;
  }
  // The mesh itself; of a flat one, the nearest above that has a motion. So it is without skins, where most
  // nodes stand still.
  int mover = node;
  while (mover >= 0 && (!isRegular(worldOf(mover)) || (skins_.empty() && !moved_[at(mover)])))
    mover = parentOf(mover);
  Mesh mesh;
  mesh.place = bind * worldOf(node);
  mesh.joints.push_back(jointOf(mover, mover < 0 ? glm::dmat4(1) : glm::inverse(bind * worldOf(mover))));
  return mesh;
}

// Sorts the joints, parents first.
void GltfSkins::sortJoints() {
  std::vector<std::size_t> rank(model_.data.nodes.size(), 0);
  for (std::size_t i = 0; i < model_.placed.size(); ++i)
    rank[static_cast<std::size_t>(model_.placed[i])] = i + 1;
  std::vector<std::uint32_t> order(nodes_.size()), place(nodes_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto rankOf = [&](std::uint32_t joint) {
      return nodes_[joint] < 0 ? 0 : rank[static_cast<std::size_t>(nodes_[joint])];
    };
    return rankOf(a) < rankOf(b);
  });
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  const auto sorted = [&](const auto& list) {
    auto out = list;
    for (std::size_t i = 0; i < order.size(); ++i) out[i] = list[order[i]];
    return out;
  };
  nodes_ = sorted(nodes_);
  from_world_ = sorted(from_world_);
  skin_.joints = sorted(skin_.joints);
  of_node_.clear();
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) of_node_.emplace(nodes_[i], i);
  for (auto& [node, mesh] : meshes_)
    for (std::uint32_t& joint : mesh.joints) joint = place[joint];
  for (std::size_t i = 0; i < sockets_.size(); ++i) skin_.sockets[i].joint = place[sockets_[i].joints[0]];
  hangJoints(place);
}

// A joint follows the nearest above, in the copy that its own skin has. One that is flat in the bind pose has
// no followers: what is placed in it is placed nowhere.
void GltfSkins::hangJoints(const std::vector<std::uint32_t>& place) {
  std::vector<int> skin_of(nodes_.size(), -1);
  std::set<std::pair<int, std::uint32_t>> members;
  for (auto& [skin, mesh] : skins_)
    for (const std::uint32_t joint : mesh.joints) {
      skin_of[place[joint]] = skin;
      members.emplace(skin, place[joint]);
    }
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    int& parent = skin_.joints[i].parent;
    for (int above = nodes_[i] < 0 ? -1 : parentOf(nodes_[i]); above >= 0 && parent < 0;
         above = parentOf(above)) {
      const auto [begin, end] = of_node_.equal_range(above);
      for (auto at = begin; at != end; ++at) {
        if (at->second >= i || !isRegular(from_world_[at->second])) continue;
        const bool its = members.contains({skin_of[i], at->second});
        if (parent < 0 || its) parent = static_cast<int>(at->second);
        if (its) break;
      }
    }
  }
}

void GltfSkins::beginVertex(int node) {
  endVertex();
  vertex_node_ = node;
  skin_.first_influence.push_back(static_cast<std::uint32_t>(skin_.influences.size()));
}

void GltfSkins::addInfluence(std::size_t joint, double weight) {
  skin_.influences.push_back({meshes_.at(vertex_node_).joints[joint], static_cast<float>(weight)});
}

// Weights sum to one. A vertex that no joint moves follows the first one.
void GltfSkins::endVertex() {
  if (skin_.first_influence.empty()) return;
  const auto first = skin_.influences.begin() + static_cast<std::ptrdiff_t>(skin_.first_influence.back());
  if (first == skin_.influences.end()) {
    skin_.influences.push_back({meshes_.at(vertex_node_).joints.front(), 1});
    return;
  }
  double sum = 0;
  for (auto at = first; at != skin_.influences.end(); ++at) sum += static_cast<double>(at->weight);
  for (auto at = first; at != skin_.influences.end(); ++at)
    at->weight = static_cast<float>(static_cast<double>(at->weight) / sum);
}

}  // namespace kelp::bake
