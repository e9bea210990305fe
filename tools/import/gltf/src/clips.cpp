// SPDX-License-Identifier: MIT
// Clips of glTF animations: keys of a part's node and of its knots, relative to rest.
#include <algorithm>
#include <cmath>
#include <set>

#include "gltf_model.h"
#include "kelp/import/core/source_model.h"

namespace kelp::bake {
namespace {

constexpr double kSampleRate = 30;  // a second, for tangents that turn
constexpr double kMaxSamples = 20000;

RigDescription::Key key(float time, const glm::dvec4& value) {
  RigDescription::Key out;
  out.time = time;
  out.value = glm::vec4(value);
  return out;
}

// A channel's keys through a linear map of its values; `shift` is added to the values alone.
template <class Linear>
RigDescription::Track mapChannel(const GltfChannel& channel, int knot, Target target, const glm::dvec4& shift,
                                 Linear linear) {
  RigDescription::Track track;
  track.knot = knot;
  track.target = target;
  track.interpolation = channel.interpolation;
  for (std::size_t i = 0; i < channel.times.size(); ++i) {
    RigDescription::Key entry = key(channel.times[i], linear(channel.values[i]) + shift);
    if (channel.interpolation == Interpolation::kCubic) {
      entry.in = glm::vec4(linear(channel.in[i]));
      entry.out = glm::vec4(linear(channel.out[i]));
    }
    track.keys.push_back(entry);
  }
  return track;
}

// True if a track never leaves `neutral`. Exporters write such channels for everything that could move.
bool still(const RigDescription::Track& track, const glm::vec4& neutral) {
  return std::all_of(track.keys.begin(), track.keys.end(), [&](const RigDescription::Key& k) {
    const bool flat = (!k.in || glm::length(*k.in) < 1e-6f) && (!k.out || glm::length(*k.out) < 1e-6f);
    const float away =
        std::min(glm::length(k.value - neutral),
                 track.target == Target::kPartRotation ? glm::length(k.value + neutral) : INFINITY);
    return flat && away < 1e-5f;
  });
}

struct NodeChannels {
  const GltfChannel* translation = nullptr;
  const GltfChannel* rotation = nullptr;
  const GltfChannel* scale = nullptr;
  bool any() const { return translation || rotation || scale; }
};

NodeChannels channelsOf(const std::vector<GltfAnimation>& animations, const GltfChannelIndex& index,
                        std::size_t animation, int node, std::vector<std::vector<bool>>& used) {
  NodeChannels out;
  const auto found = index.find(node);
  if (found == index.end()) return out;
  for (auto at =
           std::lower_bound(found->second.begin(), found->second.end(), std::pair(animation, std::size_t{0}));
       at != found->second.end() && at->first == animation; ++at) {
    const GltfChannel& channel = animations[animation].channels[at->second];
    used[animation][at->second] = true;
    if (channel.path == GltfChannel::Path::kTranslation)
      out.translation = &channel;
    else if (channel.path == GltfChannel::Path::kRotation)
      out.rotation = &channel;
    else
      out.scale = &channel;
  }
  return out;
}

GltfTransform transformAt(const GltfTransform& rest, const NodeChannels& channels, double time) {
  GltfTransform out = rest;
  if (channels.rotation) {
    const glm::dvec4 turn = evaluate(*channels.rotation, time);
    out.rotation = glm::dquat(turn.w, turn.x, turn.y, turn.z);
  }
  if (channels.scale) out.scale = glm::dvec3(evaluate(*channels.scale, time));
  return out;
}

// True if it has one value at all times.
bool constant(const GltfChannel& channel) {
  const auto all = [](const std::vector<glm::dvec4>& list, const glm::dvec4& value) {
    return std::all_of(list.begin(), list.end(), [&](const glm::dvec4& v) { return v == value; });
  };
  return all(channel.values, channel.values.front()) && all(channel.in, glm::dvec4(0)) &&
         all(channel.out, glm::dvec4(0));
}

// A tangent that turns is not a polynomial of time: it is sampled, in addition to the channels' own keys.
RigDescription::Track sampleTangent(const GltfModel& model, const std::string& place,
                                    const GltfTransform& rest, const NodeChannels& channels, int knot,
                                    const glm::dvec3& handle) {
  RigDescription::Track track;
  track.knot = knot;
  track.target = Target::kKnotTangent;
  std::set<float> times;
  bool step = true, still = true;
  for (const GltfChannel* channel : {channels.rotation, channels.scale}) {
    if (!channel) continue;
    model.countRead(16 * channel->times.size(), place);
    times.insert(channel->times.begin(), channel->times.end());
    step = step && channel->interpolation == Interpolation::kStep;
    still = still && constant(*channel);
  }
  const double first = *times.begin(), last = *times.rbegin();
  if (!step && !still) {
    const int samples = static_cast<int>(std::min(std::ceil((last - first) * kSampleRate), kMaxSamples));
    model.countRead(256 * static_cast<std::uint64_t>(samples), place);
    for (int i = 1; i < samples; ++i) times.insert(static_cast<float>(first + (last - first) * i / samples));
  }
  track.interpolation = step ? Interpolation::kStep : Interpolation::kLinear;
  const glm::dvec3 at_rest = tangentOf(rest, handle);
  for (float time : times)
    track.keys.push_back(
        key(time, glm::dvec4(tangentOf(transformAt(rest, channels, time), handle) - at_rest, 0)));
  return track;
}

// The part's own motion relative to rest: D = R0^-1 T0^-1 T R S S0^-1 in the pivot, which is P T0 R0.
void addPartTracks(const GltfModel& model, int node, const NodeChannels& channels,
                   std::vector<RigDescription::Track>& tracks) {
  for (const GltfChannel* channel : {channels.translation, channels.rotation, channels.scale})
    // keys that hold the part still count too, although they make no track
    if (channel) model.countRead(16 * channel->times.size(), model.nodeName(node));
  bool exact = true;
  const GltfTransform rest = restTransform(model.node(node), &exact);
  if (!exact)
    model.note(model.nodeName(node) +
               " is animated and has a matrix with shear, which glTF forbids: its keys move it from the "
               "nearest turn and scale");
  const glm::dquat back = glm::inverse(rest.rotation);
  if (channels.translation) {
    const glm::dvec4 shift(-(back * rest.translation), 0);
    tracks.push_back(mapChannel(*channels.translation, 0, Target::kPartTranslation, shift,
                                [&](const glm::dvec4& v) { return glm::dvec4(back * glm::dvec3(v), 0); }));
    if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
  }
  if (channels.rotation) {
    tracks.push_back(
        mapChannel(*channels.rotation, 0, Target::kPartRotation, glm::dvec4(0), [&](const glm::dvec4& v) {
          const glm::dquat turned = back * glm::dquat(v.w, v.x, v.y, v.z);
          return glm::dvec4(turned.x, turned.y, turned.z, turned.w);
        }));
    if (still(tracks.back(), glm::vec4(0, 0, 0, 1))) tracks.pop_back();
  }
  if (!channels.scale) return;
  if (rest.scale.x == 0 || rest.scale.y == 0 || rest.scale.z == 0) {
    if (moves(model, *channels.scale))
      model.note(model.nodeName(node) +
                 " has a scale of zero at rest, from which no factor leads away: the keys of its scale are "
                 "left out; give it a size at rest");
    return;
  }
  tracks.push_back(
      mapChannel(*channels.scale, 0, Target::kPartScale, glm::dvec4(-1, -1, -1, 0),
                 [&](const glm::dvec4& v) { return glm::dvec4(glm::dvec3(v) / rest.scale, 0); }));
  if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
}

std::vector<MotionNames::Target> targetsOf(const std::vector<RigDescription::Track>& tracks) {
  std::vector<MotionNames::Target> targets;
  targets.reserve(tracks.size());
  for (const RigDescription::Track& track : tracks)
    targets.emplace_back(track.knot, static_cast<int>(track.target));
  return targets;
}

// Blender names the motion of an object outside NLA tracks after the object: "knot.1Action". Such motions of
// one rig make one clip.
bool namedAfterItsNode(const GltfModel& model, const GltfAnimation& animation) {
  const int node = animation.channels.front().node;
  if (std::any_of(animation.channels.begin(), animation.channels.end(),
                  [&](const GltfChannel& channel) { return channel.node != node; }))
    return false;
  const std::string wanted = model.node(node).name + "Action";
  return animation.name == wanted ||
         (animation.name.rfind(wanted + ".", 0) == 0 && animation.name.size() == wanted.size() + 4);
}

// Of a knot: the keys of its place as they are, those of its turn and scale as tangents.
void addKnotTracks(const GltfModel& model, int node, int knot, const NodeChannels& channels,
                   const KnotExtent& extent, std::vector<RigDescription::Track>& tracks) {
  const GltfTransform rest = restTransform(model.node(node));
  if (channels.translation) {
    tracks.push_back(mapChannel(
        *channels.translation, knot, Target::kKnotOffset, glm::dvec4(-rest.translation / extent.length, 0),
        [&](const glm::dvec4& v) { return glm::dvec4(glm::dvec3(v) / extent.length, 0); }));
    if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
  }
  if (channels.rotation || channels.scale) {
    tracks.push_back(
        sampleTangent(model, model.nodeName(node), rest, channels, knot, tangentHandle(rest, extent)));
    if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
  }
}

}  // namespace

void addClips(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup,
              const std::string& part_name, const std::vector<GltfAnimation>& animations,
              const GltfChannelIndex& index, std::vector<std::vector<bool>>& used, RigDescription& rig) {
  const KnotExtent extent = extentAlong(model, knots, soup, rig);
  std::set<std::size_t> concerned;
  const auto addConcerned = [&](int moved) {
    if (const auto found = index.find(moved); found != index.end())
      for (const auto& [animation, channel] : found->second) concerned.insert(animation);
  };
  addConcerned(node);
  for (int knot : knots) addConcerned(knot);
  MotionNames names;
  std::map<std::string, std::size_t> clip_of;
  for (std::size_t i = 0; i < rig.clips.size(); ++i)
    if (clip_of.try_emplace(rig.clips[i].name, i).second)
      names.add(rig.clips[i].name, targetsOf(rig.clips[i].tracks));
  for (std::size_t a : concerned) {
    const GltfAnimation& animation = animations[a];
    std::vector<RigDescription::Track> tracks;
    bool ours = false;
    if (const NodeChannels channels = channelsOf(animations, index, a, node, used); channels.any()) {
      ours = true;
      addPartTracks(model, node, channels, tracks);
    }
    for (std::size_t k = 0; k < knots.size(); ++k) {
      const NodeChannels channels = channelsOf(animations, index, a, knots[k], used);
      if (!channels.any()) continue;
      ours = true;
      addKnotTracks(model, knots[k], static_cast<int>(k), channels, extent, tracks);
    }
    if (!ours) continue;
    if (tracks.empty()) {
      if (!knots.empty() || !rig.knots.empty())
        model.note("animation '" + animation.name + "' holds part '" + part_name +
                   "' still and makes no clip of it");
      continue;
    }
    // One node may move several parts: then they share the node's own name.
    const std::string wanted = !namedAfterItsNode(model, animation) ? animation.name
                               : knots.empty() && !model.node(node).name.empty()
                                   ? oneLine(model.node(node).name, 80)
                                   : part_name;
    // Motions of one name make one clip, unless they move the same thing.
    const std::string name = names.take(wanted, targetsOf(tracks));
    const auto [at, fresh] = clip_of.try_emplace(name, rig.clips.size());
    if (fresh) rig.clips.emplace_back().name = name;
    RigDescription::Clip& clip = rig.clips[at->second];
    std::size_t keys = 0;
    for (const RigDescription::Track& track : tracks) keys += track.keys.size();
    // several parts may share the node that moves them
    model.budget->take(keys * sizeof(RigDescription::Key), "animation '" + animation.name + "'");
    // a pose of one key lasts a second
    const float length = animation.duration > 0 ? animation.duration : 1;
    clip.duration = std::max(clip.duration.value_or(0), length);
    normalizeRotations(tracks);
    clip.tracks.insert(clip.tracks.end(), tracks.begin(), tracks.end());
  }
}

}  // namespace kelp::bake
