// SPDX-License-Identifier: MIT
// How the animations move the joints of a skin.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "skins.h"

namespace kelp::bake {
namespace {

// Samples a second, beside the channels' own keys; of curves, and of joints that several nodes move at once.
constexpr double kPoseRate = 60, kFineRate = 240;
constexpr double kMostSamples = 20000;
// How long a step takes, seconds: motions are linear between samples.
constexpr float kStepTime = 1e-4f;

// Adds the times of a channel's keys, and those just before a step.
template <class Channel>
void addTimes(const std::vector<const Channel*>& channels, std::set<float>& times) {
  for (const Channel* channel : channels)
    for (const float time : channel->times) {
      times.insert(time);
      if (channel->interpolation == Interpolation::kStep && time > kStepTime) times.insert(time - kStepTime);
    }
}

// The times at which motions are sampled: `times`, and enough between them.
std::vector<float> sampleTimes(std::set<float> times, double rate) {
  const double last = *times.rbegin();
  const double samples = std::min(std::ceil(last * rate), kMostSamples);
  for (double i = 1; i < samples; ++i) times.insert(static_cast<float>(last * i / samples));
  return {times.begin(), times.end()};
}

void apply(const GltfChannel& channel, double time, GltfTransform& to) {
  const glm::dvec4 value = evaluate(channel, time);
  if (channel.path == GltfChannel::Path::kTranslation)
    to.translation = glm::dvec3(value);
  else if (channel.path == GltfChannel::Path::kScale)
    to.scale = glm::dvec3(value);
  else
    to.rotation = glm::normalize(glm::dquat(value.w, value.x, value.y, value.z));
}

}  // namespace

SourceSkin GltfSkins::take(const glm::dmat4& space, std::vector<std::vector<bool>>& used) {
  endVertex();
  skin_.first_influence.push_back(static_cast<std::uint32_t>(skin_.influences.size()));
  // The nodes whose motion reaches a joint: the joints and all above them.
  std::vector<bool> reaches(model_.data.nodes.size(), false);
  for (int node : nodes_)
    for (; node >= 0 && !reaches[static_cast<std::size_t>(node)]; node = parentOf(node))
      reaches[static_cast<std::size_t>(node)] = true;
  std::map<std::string, std::vector<std::size_t>> by_name;  // animations of one name make one clip
  std::vector<std::string> names;
  for (std::size_t a = 0; a < animations_.size(); ++a) {
    bool concerned = false;
    for (std::size_t c = 0; c < animations_[a].channels.size(); ++c) {
      if (!reaches[static_cast<std::size_t>(animations_[a].channels[c].node)]) continue;
      used[a][c] = concerned = true;
    }
    for (const GltfMorphChannel& channel : animations_[a].morphs)
      concerned = concerned || first_morph_.contains(channel.node);
    if (!concerned) continue;
    std::vector<std::size_t>& list = by_name[animations_[a].name];
    if (list.empty()) names.push_back(animations_[a].name);
    list.push_back(a);
  }
  const glm::dmat4 back = glm::inverse(space);
  for (SourceSkin::Socket& socket : skin_.sockets) socket.place = back * socket.place;
  for (std::size_t j = 0; j < nodes_.size(); ++j) skin_.joints[j].inverse_bind = from_world_[j] * space;
  for (std::size_t j = 0; j < nodes_.size(); ++j) chains_.push_back(chainOf(j, back));
  for (const std::string& name : names) addClip(name, by_name[name], reaches);
  joinMorphs();
  return std::move(skin_);
}

// The nodes between a joint and the one above. Gives the joint its axes: those of the lowest node that moves,
// of all if none does.
GltfSkins::Chain GltfSkins::chainOf(std::size_t joint, const glm::dmat4& from_world) {
  SourceSkin::Joint& its = skin_.joints[joint];
  const int parent = its.parent;
  Chain chain;
  chain.from_parent = parent < 0 ? from_world : glm::inverse(skin_.joints[at(parent)].inverse_bind);
  const int end = parent < 0 ? -1 : nodes_[at(parent)];
  for (int node = nodes_[joint]; node >= 0 && node != end; node = parentOf(node)) chain.nodes.push_back(node);
  std::reverse(chain.nodes.begin(), chain.nodes.end());
  const auto moves = [&](int node) { return moved_[at(node)]; };
  const auto first = std::find_if(chain.nodes.begin(), chain.nodes.end(), moves);
  const auto last = std::find_if(chain.nodes.rbegin(), chain.nodes.rend(), moves).base();
  const std::ptrdiff_t count = std::ssize(chain.nodes);
  const bool any = first != chain.nodes.end();
  const std::ptrdiff_t above = any ? first - chain.nodes.begin() : std::max<std::ptrdiff_t>(count - 1, 0);
  its.base = chain.from_parent;
  for (std::ptrdiff_t i = 0; i < above; ++i)
    its.base = its.base * localMatrix(model_.node(chain.nodes[at(i)]));
  glm::dmat4 to_joint = its.inverse_bind;
  for (std::ptrdiff_t i = count - 1; any && i >= last - chain.nodes.begin(); --i)
    to_joint = localMatrix(model_.node(chain.nodes[at(i)])) * to_joint;
  const bool placed = isRegular(its.base) && isFinite(its.base);
  its.frame = isRegular(to_joint) ? glm::inverse(to_joint) : placed ? its.base : glm::dmat4(1);
  if (!placed) its.base = its.frame;
  if (any)
    chain.moving.assign(first, last);
  else if (count > 0)
    chain.moving = {chain.nodes.back()};
  chain.several = any && std::count_if(first, last, moves) > 1;
  return chain;
}

void GltfSkins::addClip(const std::string& name, const std::vector<std::size_t>& members,
                        const std::vector<bool>& reaches) {
  SourceSkin::Clip clip{name, 0, {}, {}, {}, {}};
  bool fine = std::any_of(chains_.begin(), chains_.end(), [](const Chain& chain) { return chain.several; });
  std::vector<const GltfChannel*> channels;
  std::vector<const GltfMorphChannel*> morphs;
  for (const std::size_t a : members) {
    clip.duration = std::max(clip.duration, animations_[a].duration);
    for (const GltfChannel& channel : animations_[a].channels) {
      if (!reaches[at(channel.node)]) continue;
      channels.push_back(&channel);
      fine = fine || channel.interpolation == Interpolation::kCubic;
    }
    for (const GltfMorphChannel& channel : animations_[a].morphs) {
      if (!first_morph_.contains(channel.node)) continue;
      morphs.push_back(&channel);
      fine = fine || channel.interpolation == Interpolation::kCubic;
    }
  }
  if (!(clip.duration > 0)) clip.duration = 1;  // a pose of one key lasts a second
  std::set<float> keys{0};
  addTimes(channels, keys);
  addTimes(morphs, keys);
  clip.times = sampleTimes(std::move(keys), fine ? kFineRate : kPoseRate);
  const std::string place = "animation '" + name + "'";
  model_.countRead(clip.times.size() * (model_.placed.size() + channels.size() + skin_.morphs.size()), place);
  model_.budget->take(clip.times.size() * (nodes_.size() * (sizeof(glm::dmat4x3) + sizeof(glm::dquat)) +
                                           skin_.morphs.size() * sizeof(float)),
                      place);

  std::vector<GltfTransform> rest;
  for (const tinygltf::Node& node : model_.data.nodes) rest.push_back(restTransform(node));
  std::vector<glm::dmat4> local(model_.data.nodes.size(), glm::dmat4(1));
  for (const int node : model_.placed) local[at(node)] = localMatrix(model_.node(node));
  for (std::size_t t = 0; t < clip.times.size(); ++t) {
    std::vector<GltfTransform> posed = rest;
    for (const GltfChannel* channel : channels)
      apply(*channel, static_cast<double>(clip.times[t]), posed[at(channel->node)]);
    for (const GltfChannel* channel : channels) local[at(channel->node)] = posed[at(channel->node)].matrix();
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
      glm::dmat4 motion = nodes_[j] < 0 ? glm::dmat4(1) : chains_[j].from_parent;
      for (const int node : chains_[j].nodes) motion = motion * local[at(node)];
      clip.locals.emplace_back(nodes_[j] < 0 ? motion : motion * skin_.joints[j].inverse_bind);
      glm::dquat turn(1, 0, 0, 0);
      for (const int node : chains_[j].moving) turn = turn * posed[at(node)].rotation;
      clip.turns.push_back(turn);
    }
    addWeights(morphs, static_cast<double>(clip.times[t]), clip.weights);
    const std::vector<glm::dmat4x3> motions = skin_.motionsAt(clip, t);
    for (std::size_t j = 0; j < nodes_.size(); ++j)
      if (!isFinite(glm::dmat4(motions[j])))
        model_.refuse(place, "moves " + model_.nodeName(nodes_[j]) + " beyond all numbers");
  }
  skin_.clips.push_back(std::move(clip));
}

}  // namespace kelp::bake
