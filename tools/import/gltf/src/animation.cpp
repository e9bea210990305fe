// SPDX-License-Identifier: MIT
// Animations of a glTF file: channels of node transforms, and their values at a time.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "gltf_model.h"
#include "skins.h"

namespace kelp::bake {
namespace {

// The keys of a channel's sampler, whatever it moves; values in the file's order.
struct Sampled {
  Interpolation interpolation = Interpolation::kLinear;
  GltfValues times, values;
  std::size_t valuesAKey() const { return interpolation == Interpolation::kCubic ? 3 : 1; }
};

Sampled readSampler(const GltfModel& model, const tinygltf::Animation& animation, int index,
                    const std::string& place) {
  if (index < 0 || index >= static_cast<int>(animation.samplers.size()))
    model.refuse(place, "names a sampler that does not exist");
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(index)];
  Sampled out;
  if (sampler.interpolation == "STEP")
    out.interpolation = Interpolation::kStep;
  else if (sampler.interpolation == "CUBICSPLINE")
    out.interpolation = Interpolation::kCubic;
  out.times = readValues(model, sampler.input, place + ".input");
  out.values = readValues(model, sampler.output, place + ".output");
  // Channels may share keys, and each gets a copy.
  model.budget->take(out.times.values.size() * sizeof(float) + out.values.values.size() * sizeof(double),
                     place);
  return out;
}

// True if a key is later than the one before. Some exporters write the last key twice: then the first counts.
bool ascends(const GltfModel& model, const std::vector<float>& times, float time, const std::string& place) {
  if (!std::isfinite(time) || time < 0)
    model.refuse(place, "has a key at a time that is negative or not finite");
  if (!times.empty() && time < times.back()) model.refuse(place, "has keys whose times do not ascend");
  return times.empty() || time > times.back();
}

// Normalizes a quaternion in doubles, where any length fits. One without a length is the identity, as for
// nodes.
void makeUnit(GltfChannel& channel) {
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const double length = glm::length(channel.values[i]);
    if (length > 0.5 && length < 2) continue;
    channel.values[i] = length > 0 ? channel.values[i] / length : glm::dvec4(0, 0, 0, 1);
    if (channel.interpolation != Interpolation::kCubic || length == 0) continue;
    channel.in[i] /= length;
    channel.out[i] /= length;
  }
}

std::optional<GltfChannel> readChannel(const GltfModel& model, const tinygltf::Animation& animation,
                                       const tinygltf::AnimationChannel& source, const std::string& place) {
  GltfChannel channel;
  channel.node = source.target_node;
  if (channel.node < 0) return std::nullopt;  // the target of an extension
  if (channel.node >= static_cast<int>(model.data.nodes.size()))
    model.refuse(place, "moves a node that does not exist");
  if (source.target_path == "translation")
    channel.path = GltfChannel::Path::kTranslation;
  else if (source.target_path == "rotation")
    channel.path = GltfChannel::Path::kRotation;
  else if (source.target_path == "scale")
    channel.path = GltfChannel::Path::kScale;
  else
    return std::nullopt;  // morph weights, and what is not known
  const Sampled sampled = readSampler(model, animation, source.sampler, place);
  channel.interpolation = sampled.interpolation;
  const int width = channel.path == GltfChannel::Path::kRotation ? 4 : 3;
  const GltfValues &times = sampled.times, &values = sampled.values;
  if (times.components != 1 || values.components != width ||
      values.count != times.count * sampled.valuesAKey() || times.count == 0)
    model.refuse(place, "has times and values that do not match");
  const auto value = [&](std::size_t at) {
    glm::dvec4 out(0);
    for (int c = 0; c < width; ++c) out[c] = values.at(at, c);
    return out;
  };
  for (std::size_t key = 0; key < times.count; ++key) {
    if (!ascends(model, channel.times, times.values[key], place)) continue;
    channel.times.push_back(times.values[key]);
    if (channel.interpolation == Interpolation::kCubic) {
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
  if (channel.path == GltfChannel::Path::kRotation) makeUnit(channel);
  return channel;
}

std::optional<GltfMorphChannel> readMorphChannel(const GltfModel& model, const tinygltf::Animation& animation,
                                                 const tinygltf::AnimationChannel& source,
                                                 const std::string& place) {
  if (source.target_path != "weights" || source.target_node < 0 ||
      source.target_node >= static_cast<int>(model.data.nodes.size()))
    return std::nullopt;
  GltfMorphChannel channel;
  channel.node = source.target_node;
  const int mesh = model.node(channel.node).mesh;
  if (mesh < 0) return std::nullopt;
  channel.targets = targetCount(model.data.meshes[static_cast<std::size_t>(mesh)]);
  const Sampled sampled = readSampler(model, animation, source.sampler, place);
  channel.interpolation = sampled.interpolation;
  const std::size_t width = channel.targets;
  if (width == 0 || sampled.times.components != 1 || sampled.values.components != 1 ||
      sampled.times.count == 0 ||
      sampled.values.count != sampled.times.count * width * sampled.valuesAKey()) {
    model.note(place + ": has weights that do not match the mesh's morph targets and is left out");
    return std::nullopt;
  }
  const auto add = [&](std::vector<double>& to, std::size_t row) {
    for (std::size_t i = 0; i < width; ++i) to.push_back(sampled.values.values[row * width + i]);
  };
  for (std::size_t key = 0; key < sampled.times.count; ++key) {
    if (!ascends(model, channel.times, sampled.times.values[key], place)) continue;
    channel.times.push_back(sampled.times.values[key]);
    if (channel.interpolation == Interpolation::kCubic) {
      add(channel.in, 3 * key);
      add(channel.values, 3 * key + 1);
      add(channel.out, 3 * key + 2);
    } else {
      add(channel.values, key);
    }
  }
  for (const auto* list : {&channel.values, &channel.in, &channel.out})
    if (!std::all_of(list->begin(), list->end(), [](double v) { return std::isfinite(v); }))
      model.refuse(place, "has a value that is not finite");
  return channel;
}

// Animations of one name become one clip, like Blender's NLA tracks, unless they move the same thing.
void tellApart(std::vector<GltfAnimation>& animations) {
  MotionNames names;
  for (GltfAnimation& animation : animations) {
    std::vector<MotionNames::Target> targets;
    for (const GltfChannel& channel : animation.channels)
      targets.emplace_back(channel.node, static_cast<int>(channel.path));
    for (const GltfMorphChannel& channel : animation.morphs) targets.emplace_back(channel.node, -1);
    animation.name = names.take(animation.name, targets);
  }
}

// The key before a time, and how far the time is on to the next key, 0 to 1. Beyond the ends: the first or
// the last key, and 0.
struct Place {
  std::size_t key = 0;
  double t = 0, span = 0;
};
Place placeAmong(const std::vector<float>& times, double time) {
  if (time <= static_cast<double>(times.front())) return {};
  if (time >= static_cast<double>(times.back())) return {times.size() - 1, 0, 0};
  const auto after = std::upper_bound(times.begin(), times.end(), time,
                                      [](double a, float b) { return a < static_cast<double>(b); });
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  const double span = static_cast<double>(times[key + 1]) - static_cast<double>(times[key]);
  return {key, (time - static_cast<double>(times[key])) / span, span};
}

// Appendix C.4 of the specification.
template <class Value>
Value hermite(const Place& at, const Value& value, const Value& out, const Value& next, const Value& in) {
  const double t = at.t, t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * value + at.span * (t3 - 2 * t2 + t) * out + (3 * t2 - 2 * t3) * next +
         at.span * (t3 - t2) * in;
}

}  // namespace

std::string MotionNames::take(const std::string& wanted, const std::vector<Target>& targets) {
  const auto named = [&](int suffix) { return suffix == 1 ? wanted : wanted + "." + std::to_string(suffix); };
  const auto isTaken = [&](int suffix, const Target& target) {
    const auto found = taken_.find(named(suffix));
    return found != taken_.end() && found->second.count(target) > 0;
  };
  int suffix = 1;
  for (const Target& target : targets) {
    int& free = first_free_.try_emplace({wanted, target}, 1).first->second;
    while (isTaken(free, target)) ++free;
    suffix = std::max(suffix, free);
  }
  while (std::any_of(targets.begin(), targets.end(),
                     [&](const Target& target) { return isTaken(suffix, target); }))
    ++suffix;
  std::string name = named(suffix);
  add(name, targets);
  return name;
}

GltfChannelIndex indexChannels(const std::vector<GltfAnimation>& animations) {
  GltfChannelIndex index;
  for (std::size_t a = 0; a < animations.size(); ++a)
    for (std::size_t c = 0; c < animations[a].channels.size(); ++c)
      index[animations[a].channels[c].node].emplace_back(a, c);
  return index;
}

std::vector<GltfAnimation> readAnimations(const GltfModel& model) {
  std::vector<GltfAnimation> out;
  for (std::size_t a = 0; a < model.data.animations.size(); ++a) {
    const tinygltf::Animation& source = model.data.animations[a];
    GltfAnimation animation;
    animation.name = source.name.empty() ? "animation " + std::to_string(a) : oneLine(source.name, 80);
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      const std::string place = placeOf("animations", a) + "." + placeOf("channels", c);
      if (std::optional<GltfChannel> channel = readChannel(model, source, source.channels[c], place)) {
        animation.duration = std::max(animation.duration, channel->times.back());
        animation.channels.push_back(*std::move(channel));
      } else if (std::optional<GltfMorphChannel> morph =
                     readMorphChannel(model, source, source.channels[c], place)) {
        animation.duration = std::max(animation.duration, morph->times.back());
        animation.morphs.push_back(*std::move(morph));
      }
    }
    if (!animation.channels.empty() || !animation.morphs.empty()) out.push_back(std::move(animation));
  }
  tellApart(out);
  return out;
}

glm::dvec4 evaluate(const GltfChannel& channel, double time) {
  const Place at = placeAmong(channel.times, time);
  const std::size_t k = at.key;
  if (at.t == 0 || channel.interpolation == Interpolation::kStep) return channel.values[k];
  const glm::dvec4 &a = channel.values[k], &b = channel.values[k + 1];
  if (channel.interpolation == Interpolation::kCubic) {
    const glm::dvec4 value = hermite(at, a, channel.out[k], b, channel.in[k + 1]);
    if (channel.path != GltfChannel::Path::kRotation) return value;
    const double length = glm::length(value);
    return length > 0 ? value / length : glm::dvec4(0, 0, 0, 1);
  }
  if (channel.path != GltfChannel::Path::kRotation) return (1 - at.t) * a + at.t * b;
  const glm::dquat turned = glm::slerp(glm::normalize(glm::dquat(a.w, a.x, a.y, a.z)),
                                       glm::normalize(glm::dquat(b.w, b.x, b.y, b.z)), at.t);
  return {turned.x, turned.y, turned.z, turned.w};
}

std::vector<double> evaluate(const GltfMorphChannel& channel, double time) {
  const Place at = placeAmong(channel.times, time);
  std::vector<double> out(channel.targets);
  for (std::size_t i = 0; i < channel.targets; ++i) {
    const std::size_t k = at.key * channel.targets + i, next = k + channel.targets;
    if (at.t == 0 || channel.interpolation == Interpolation::kStep)
      out[i] = channel.values[k];
    else if (channel.interpolation == Interpolation::kCubic)
      out[i] = hermite(at, channel.values[k], channel.out[k], channel.values[next], channel.in[next]);
    else
      out[i] = (1 - at.t) * channel.values[k] + at.t * channel.values[next];
  }
  return out;
}

bool moves(const GltfModel& model, const GltfChannel& channel) {
  const GltfTransform rest = restTransform(model.node(channel.node));
  const bool turns = channel.path == GltfChannel::Path::kRotation;
  const glm::dvec4 neutral =
      turns ? glm::dvec4(rest.rotation.x, rest.rotation.y, rest.rotation.z, rest.rotation.w)
            : glm::dvec4(channel.path == GltfChannel::Path::kScale ? rest.scale : rest.translation, 0);
  // Rotations may be stored in 16 bits while the rest is in floats: 5e-5 is a turn of 1e-4.
  const double tolerance = turns ? 5e-5 : 1e-6 * glm::length(neutral);
  const auto away = [&](const glm::dvec4& v) {
    return glm::length(v - neutral) > tolerance && !(turns && glm::length(v + neutral) <= tolerance);
  };
  const auto sloped = [&](const glm::dvec4& v) { return glm::length(v) > tolerance; };
  if (std::any_of(channel.values.begin(), channel.values.end(), away)) return true;
  return channel.times.size() > 1 && (std::any_of(channel.in.begin(), channel.in.end(), sloped) ||
                                      std::any_of(channel.out.begin(), channel.out.end(), sloped));
}

}  // namespace kelp::bake
