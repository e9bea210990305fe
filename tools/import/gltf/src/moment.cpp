// SPDX-License-Identifier: MIT
// Sets the model to one moment of an animation. Nodes, skins and morph targets are then read as they are at
// that moment.
#include <algorithm>

#include <fmt/format.h>

#include "gltf_model.h"
#include "kelp/common/error.h"

namespace kelp::bake {
namespace {

[[noreturn]] void refuseName(const GltfModel& model, const std::vector<GltfAnimation>& animations,
                             const std::string& wanted) {
  const std::string file = model.files->input().filename().string();
  if (animations.empty())
    throw ToolError(Exit::kUsage,
                    fmt::format("--at '{}': {} has no animation; leave --at out", oneLine(wanted, 80), file));
  std::string known;
  for (const GltfAnimation& animation : animations) {
    if (known.size() > 400) {
      known += ", ...";
      break;
    }
    if (known.find("'" + animation.name + "'") == std::string::npos)
      known += (known.empty() ? "'" : ", '") + animation.name + "'";
  }
  throw ToolError(Exit::kUsage, fmt::format("--at '{}': {} has no animation of that name; choose one of {}",
                                            oneLine(wanted, 80), file, known));
}

// Splits a node's transform into T, R and S, so that channels can replace them.
void takeApart(const GltfModel& model, int index, tinygltf::Node& node) {
  bool exact = true;
  const GltfTransform rest = restTransform(node, &exact);
  if (!exact)
    model.note(model.nodeName(index) +
               " is animated and has a matrix with shear, which glTF forbids: the shear is left out");
  node.matrix.clear();
  node.translation = {rest.translation.x, rest.translation.y, rest.translation.z};
  node.rotation = {rest.rotation.x, rest.rotation.y, rest.rotation.z, rest.rotation.w};
  node.scale = {rest.scale.x, rest.scale.y, rest.scale.z};
}

}  // namespace

void poseAt(GltfModel& model, const std::vector<GltfAnimation>& animations, const Moment& moment) {
  double duration = -1;
  for (const GltfAnimation& animation : animations) {
    if (animation.name != moment.clip) continue;
    duration = std::max(duration, static_cast<double>(animation.duration));
    for (const GltfChannel& channel : animation.channels) {
      tinygltf::Node& node = model.data.nodes[static_cast<std::size_t>(channel.node)];
      takeApart(model, channel.node, node);
      const glm::dvec4 value = evaluate(channel, moment.seconds);
      if (channel.path == GltfChannel::Path::kTranslation)
        node.translation = {value.x, value.y, value.z};
      else if (channel.path == GltfChannel::Path::kScale)
        node.scale = {value.x, value.y, value.z};
      else
        node.rotation = {value.x, value.y, value.z, value.w};
    }
    for (const GltfMorphChannel& channel : animation.morphs)
      model.data.nodes[static_cast<std::size_t>(channel.node)].weights = evaluate(channel, moment.seconds);
  }
  if (duration < 0) refuseName(model, animations, moment.clip);
  if (moment.seconds > duration)
    model.note(fmt::format("--at {}:{:g}: the animation ends at {:g} s, and its last pose is baked",
                           moment.clip, moment.seconds, duration));
  placeNodes(model);
}

}  // namespace kelp::bake
