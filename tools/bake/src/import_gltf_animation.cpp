// SPDX-License-Identifier: MIT
// Animations of a glTF file: channels of node transforms, and their values at a time.
#include <algorithm>
#include <cmath>

#include "import_gltf_model.h"

namespace kelp::bake {
namespace {

std::optional<GltfChannel> readChannel(const GltfModel& model, const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source, const std::string& place) {
  GltfChannel channel;
  channel.node = source.target_node;
  if (channel.node < 0) return std::nullopt;  // the target of an extension
  if (channel.node >= static_cast<int>(model.data.nodes.size())) model.refuse(place, "moves a node that does not exist");
  if (source.target_path == "translation") channel.path = GltfChannel::Path::kTranslation;
  else if (source.target_path == "rotation") channel.path = GltfChannel::Path::kRotation;
  else if (source.target_path == "scale") channel.path = GltfChannel::Path::kScale;
  else return std::nullopt;  // morph weights
  if (source.sampler < 0 || source.sampler >= static_cast<int>(animation.samplers.size())) model.refuse(place, "names a sampler that does not exist");
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(source.sampler)];
  if (sampler.interpolation == "STEP") channel.interpolation = Interpolation::kStep;
  else if (sampler.interpolation == "CUBICSPLINE") channel.interpolation = Interpolation::kCubic;
  const GltfValues times = readValues(model, sampler.input, place + ".input");
  const GltfValues values = readValues(model, sampler.output, place + ".output");
  const int width = channel.path == GltfChannel::Path::kRotation ? 4 : 3;
  const std::size_t values_a_key = channel.interpolation == Interpolation::kCubic ? 3 : 1;
  if (times.components != 1 || values.components != width || values.count != times.count * values_a_key || times.count == 0)
    model.refuse(place, "has times and values that do not match");
  const auto value = [&](std::size_t at) {
    glm::dvec4 out(0);
    for (int c = 0; c < width; ++c) out[c] = values.at(at, c);
    return out;
  };
  for (std::size_t key = 0; key < times.count; ++key) {
    const float time = times.values[key];
    if (!std::isfinite(time) || time < 0) model.refuse(place, "has a key at a time that is negative or not finite");
    if (!channel.times.empty() && time == channel.times.back()) continue;  // exporters double the last key now and then
    if (!channel.times.empty() && time < channel.times.back()) model.refuse(place, "has keys whose times do not ascend");
    channel.times.push_back(time);
    if (values_a_key == 3) {
      channel.in.push_back(value(3 * key));
      channel.values.push_back(value(3 * key + 1));
      channel.out.push_back(value(3 * key + 2));
    } else {
      channel.values.push_back(value(key));
    }
  }
  for (const auto* list : {&channel.values, &channel.in, &channel.out})
    for (const glm::dvec4& v : *list)
      if (!std::isfinite(v.x + v.y + v.z + v.w)) model.refuse(place, "has a value that is not finite");
  return channel;
}

}  // namespace

std::vector<GltfAnimation> readAnimations(const GltfModel& model) {
  std::vector<GltfAnimation> out;
  for (std::size_t a = 0; a < model.data.animations.size(); ++a) {
    const tinygltf::Animation& source = model.data.animations[a];
    GltfAnimation animation;
    animation.name = source.name.empty() ? "animation " + std::to_string(a) : oneLine(source.name, 80);
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      std::optional<GltfChannel> channel = readChannel(model, source, source.channels[c], placeOf("animations", a) + "." + placeOf("channels", c));
      if (!channel) continue;
      animation.duration = std::max(animation.duration, channel->times.back());
      animation.channels.push_back(*std::move(channel));
    }
    if (!animation.channels.empty()) out.push_back(std::move(animation));
  }
  return out;
}

glm::dvec4 evaluate(const GltfChannel& channel, double time) {
  const std::size_t last = channel.times.size() - 1;
  if (time <= channel.times.front()) return channel.values.front();
  if (time >= channel.times.back()) return channel.values[last];
  const auto after = static_cast<std::size_t>(std::upper_bound(channel.times.begin(), channel.times.end(), static_cast<float>(time)) - channel.times.begin());
  const std::size_t k = after - 1;
  if (after > last) return channel.values[last];
  if (channel.interpolation == Interpolation::kStep) return channel.values[k];
  const double span = static_cast<double>(channel.times[after]) - channel.times[k];
  const double t = std::clamp((time - channel.times[k]) / span, 0.0, 1.0);
  glm::dvec4 value;
  if (channel.interpolation == Interpolation::kCubic) {
    const double t2 = t * t, t3 = t2 * t;
    value = (2 * t3 - 3 * t2 + 1) * channel.values[k] + span * (t3 - 2 * t2 + t) * channel.out[k] + (3 * t2 - 2 * t3) * channel.values[after] +
            span * (t3 - t2) * channel.in[after];
  } else if (channel.path == GltfChannel::Path::kRotation) {
    const glm::dvec4 &a = channel.values[k], &b = channel.values[after];
    const glm::dquat turned = glm::slerp(glm::normalize(glm::dquat(a.w, a.x, a.y, a.z)), glm::normalize(glm::dquat(b.w, b.x, b.y, b.z)), t);
    return {turned.x, turned.y, turned.z, turned.w};
  } else {
    value = (1 - t) * channel.values[k] + t * channel.values[after];
  }
  if (channel.path != GltfChannel::Path::kRotation) return value;
  const double length = glm::length(value);
  return length > 0 ? value / length : glm::dvec4(0, 0, 0, 1);
}

}  // namespace kelp::bake
