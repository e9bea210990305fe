// SPDX-License-Identifier: MIT
// Rigs drawn with empties: knot.0 .. knot.n parented to a mesh. Position = knot, +Y axis times scale = tangent, keyframes = clips.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "import_gltf_model.h"

namespace kelp::bake {
namespace {

constexpr double kEndTolerance = 0.02;   // of the extent: how far an end knot may lie from the mesh's end without a word
constexpr double kBeside = 0.1;         // of the longest side: how far from a mesh's box a knot that nobody owns may lie
constexpr double kStraight = 1e-4;       // of the extent: below this a rest rig is straight, exactly
constexpr double kLeastCosine = 0.17;    // an empty whose +Y lies this far (80 degrees) from the axis was not turned to be a tangent
constexpr double kSampleRate = 30;       // a second, for tangents that turn
constexpr double kMaxSamples = 20000;

// "knot.3", "knot_3", "knot-3", "knot3", with the ".001" that Blender appends to a name that is taken. -1: another name.
int knotNumber(const std::string& name) {
  if (name.rfind("knot", 0) != 0) return -1;
  std::size_t at = 4;
  if (at < name.size() && (name[at] == '.' || name[at] == '_' || name[at] == '-')) ++at;
  const std::size_t first = at;
  while (at < name.size() && std::isdigit(static_cast<unsigned char>(name[at]))) ++at;
  if (at == first || at - first > 4) return -1;
  const std::string rest = name.substr(at);
  const bool copy = rest.size() == 4 && rest[0] == '.' && std::all_of(rest.begin() + 1, rest.end(), [](unsigned char c) { return std::isdigit(c); });
  return rest.empty() || copy ? std::atoi(name.c_str() + first) : -1;
}

glm::dvec3 axisVector(Axis axis) {
  glm::dvec3 vector(0);
  const int index = static_cast<int>(axis);
  vector[index / 2] = index % 2 == 0 ? 1 : -1;
  return vector;
}

// The mesh along an axis of its node.
struct Extent {
  glm::dvec3 axis{0, 1, 0};
  double low = 0, length = 1;
};

Extent extentAlong(const TriangleSoup& soup, Axis axis) {
  Extent extent{axisVector(axis), 0, 1};
  double high = -INFINITY;
  extent.low = INFINITY;
  for (const glm::vec3& position : soup.positions) {
    const double along = glm::dot(extent.axis, glm::dvec3(position));
    extent.low = std::min(extent.low, along);
    high = std::max(high, along);
  }
  extent.length = high - extent.low;
  return extent;
}

const tinygltf::Node& nodeAt(const GltfModel& model, int node) { return model.data.nodes[static_cast<std::size_t>(node)]; }

Axis nearestAxis(const GltfModel& model, const std::vector<int>& knots) {
  const glm::dvec3 way = restTransform(nodeAt(model, knots.back())).translation - restTransform(nodeAt(model, knots.front())).translation;
  Axis best = Axis::kPlusY;
  for (int i = 0; i < 6; ++i)
    if (glm::dot(way, axisVector(static_cast<Axis>(i))) > glm::dot(way, axisVector(best)) + 1e-12) best = static_cast<Axis>(i);
  return best;
}

// What an empty points along, in its own frame: +Y, or, where it was never turned towards the axis, whatever is the axis at rest.
glm::dvec3 tangentHandle(const GltfTransform& rest, const glm::dvec3& axis, bool* turned = nullptr) {
  const glm::dvec3 up = rest.rotation * glm::dvec3(0, 1, 0);
  const bool usable = glm::dot(up, axis) * (rest.scale.y < 0 ? -1 : 1) >= kLeastCosine;
  if (turned) *turned = usable;
  if (usable) return {0, 1, 0};
  glm::dvec3 scale = rest.scale;
  for (int i = 0; i < 3; ++i)
    if (scale[i] == 0) scale[i] = 1;
  return glm::inverse(rest.rotation) * axis / scale;
}

glm::dvec3 tangentOf(const GltfTransform& transform, const glm::dvec3& handle) { return transform.rotation * (transform.scale * handle); }

RigDescription::Key key(float time, const glm::dvec4& value) {
  RigDescription::Key out;
  out.time = time;
  out.value = glm::vec4(value);
  return out;
}

// A channel's keys through a linear map of its values; `shift` is added to the values alone.
template <class Linear>
RigDescription::Track mapChannel(const GltfChannel& channel, int knot, Target target, const glm::dvec4& shift, Linear linear) {
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

// Whether a track never leaves `neutral`: exporters write such channels for everything that could move.
bool still(const RigDescription::Track& track, const glm::vec4& neutral) {
  return std::all_of(track.keys.begin(), track.keys.end(), [&](const RigDescription::Key& k) {
    const bool flat = (!k.in || glm::length(*k.in) < 1e-6f) && (!k.out || glm::length(*k.out) < 1e-6f);
    const float away = std::min(glm::length(k.value - neutral), track.target == Target::kPartRotation ? glm::length(k.value + neutral) : INFINITY);
    return flat && away < 1e-5f;
  });
}

struct NodeChannels {
  const GltfChannel* translation = nullptr;
  const GltfChannel* rotation = nullptr;
  const GltfChannel* scale = nullptr;
  bool any() const { return translation || rotation || scale; }
};

NodeChannels channelsOf(const std::vector<GltfAnimation>& animations, const GltfChannelIndex& index, std::size_t animation, int node, std::vector<std::vector<bool>>& used) {
  NodeChannels out;
  const auto found = index.find(node);
  if (found == index.end()) return out;
  for (auto at = std::lower_bound(found->second.begin(), found->second.end(), std::pair(animation, std::size_t{0})); at != found->second.end() && at->first == animation; ++at) {
    const GltfChannel& channel = animations[animation].channels[at->second];
    used[animation][at->second] = true;
    if (channel.path == GltfChannel::Path::kTranslation) out.translation = &channel;
    else if (channel.path == GltfChannel::Path::kRotation) out.rotation = &channel;
    else out.scale = &channel;
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

// Whether it has one value at all times.
bool constant(const GltfChannel& channel) {
  const auto all = [](const std::vector<glm::dvec4>& list, const glm::dvec4& value) { return std::all_of(list.begin(), list.end(), [&](const glm::dvec4& v) { return v == value; }); };
  return all(channel.values, channel.values.front()) && all(channel.in, glm::dvec4(0)) && all(channel.out, glm::dvec4(0));
}

// A tangent that turns follows no polynomial: it is sampled, and keeps the channels' own keys.
RigDescription::Track sampleTangent(const GltfModel& model, const std::string& place, const GltfTransform& rest, const NodeChannels& channels, int knot, const glm::dvec3& handle) {
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
  for (float time : times) track.keys.push_back(key(time, glm::dvec4(tangentOf(transformAt(rest, channels, time), handle) - at_rest, 0)));
  return track;
}

// The part's own motion, relative to rest: with D = R0^-1 T0^-1 T R S S0^-1 acting in the pivot, where the pivot is P T0 R0.
void addPartTracks(const GltfModel& model, int node, const NodeChannels& channels, std::vector<RigDescription::Track>& tracks) {
  for (const GltfChannel* channel : {channels.translation, channels.rotation, channels.scale})
    if (channel) model.countRead(16 * channel->times.size(), model.nodeName(node));  // also what holds the part still, and makes no track
  bool exact = true;
  const GltfTransform rest = restTransform(nodeAt(model, node), &exact);
  if (!exact) model.note(model.nodeName(node) + " is animated and has a matrix with shear, which glTF forbids: its keys move it from the nearest turn and scale");
  const glm::dquat back = glm::inverse(rest.rotation);
  if (channels.translation) {
    const glm::dvec4 shift(-(back * rest.translation), 0);
    tracks.push_back(mapChannel(*channels.translation, 0, Target::kPartTranslation, shift, [&](const glm::dvec4& v) { return glm::dvec4(back * glm::dvec3(v), 0); }));
    if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
  }
  if (channels.rotation) {
    tracks.push_back(mapChannel(*channels.rotation, 0, Target::kPartRotation, glm::dvec4(0), [&](const glm::dvec4& v) {
      const glm::dquat turned = back * glm::dquat(v.w, v.x, v.y, v.z);
      return glm::dvec4(turned.x, turned.y, turned.z, turned.w);
    }));
    if (still(tracks.back(), glm::vec4(0, 0, 0, 1))) tracks.pop_back();
  }
  if (!channels.scale) return;
  if (rest.scale.x == 0 || rest.scale.y == 0 || rest.scale.z == 0) {
    if (moves(model, *channels.scale))
      model.note(model.nodeName(node) + " has a scale of zero at rest, from which no factor leads away: the keys of its scale are left out; give it a size at rest");
    return;
  }
  tracks.push_back(mapChannel(*channels.scale, 0, Target::kPartScale, glm::dvec4(-1, -1, -1, 0), [&](const glm::dvec4& v) { return glm::dvec4(glm::dvec3(v) / rest.scale, 0); }));
  if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
}

std::vector<MotionNames::Target> targetsOf(const std::vector<RigDescription::Track>& tracks) {
  std::vector<MotionNames::Target> targets;
  targets.reserve(tracks.size());
  for (const RigDescription::Track& track : tracks) targets.emplace_back(track.knot, static_cast<int>(track.target));
  return targets;
}

// Blender names the motion of an object that is in no NLA track after the object: "knot.1Action". Such motions of one rig are one clip.
bool namedAfterItsNode(const GltfModel& model, const GltfAnimation& animation) {
  const int node = animation.channels.front().node;
  if (std::any_of(animation.channels.begin(), animation.channels.end(), [&](const GltfChannel& channel) { return channel.node != node; })) return false;
  const std::string wanted = nodeAt(model, node).name + "Action";
  return animation.name == wanted || (animation.name.rfind(wanted + ".", 0) == 0 && animation.name.size() == wanted.size() + 4);
}

}  // namespace

std::vector<int> findKnots(const GltfModel& model, int node) {
  std::map<int, int> numbered;
  std::vector<int> children;
  if (node >= 0) children = nodeAt(model, node).children;
  else std::copy_if(model.order.begin(), model.order.end(), std::back_inserter(children), [&](int at) { return model.parents[static_cast<std::size_t>(at)] < 0; });
  for (int child : children) {
    const int number = knotNumber(nodeAt(model, child).name);
    if (number < 0 || (node < 0 && nodeAt(model, child).mesh >= 0)) continue;
    if (!numbered.emplace(number, child).second) {
      model.note(model.nodeName(node) + " has two children that are knot " + std::to_string(number) + ": no rig is made of its knots; name them knot.0 to knot.n");
      return {};
    }
  }
  if (numbered.empty()) return {};
  std::vector<int> knots;
  for (const auto& [number, child] : numbered) {
    if (number != static_cast<int>(knots.size())) {
      model.note(model.nodeName(node) + " has a knot." + std::to_string(number) + " but no knot." + std::to_string(knots.size()) +
                 ": no rig is made of its knots; parent knot.0 to knot.n to the mesh itself");
      return {};
    }
    knots.push_back(child);
  }
  if (knots.size() < 2 || knots.size() > static_cast<std::size_t>(kMaxKnots)) {
    model.note(model.nodeName(node) + " has " + std::to_string(knots.size()) + (knots.size() == 1 ? " knot" : " knots") + ": no rig is made of them; a rig has 2 to " + std::to_string(kMaxKnots));
    return {};
  }
  return knots;
}

bool lieBeside(const GltfModel& model, const std::vector<int>& knots, const TriangleSoup& soup) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& position : soup.positions) {
    low = glm::min(low, glm::dvec3(position));
    high = glm::max(high, glm::dvec3(position));
  }
  const glm::dvec3 size = high - low;
  const double reach = kBeside * std::max({size.x, size.y, size.z});
  return std::all_of(knots.begin(), knots.end(), [&](int knot) {
    const glm::dvec3 at = restTransform(nodeAt(model, knot)).translation;
    return glm::all(glm::greaterThanEqual(at, low - reach)) && glm::all(glm::lessThanEqual(at, high + reach));
  });
}

std::optional<RigDescription> knotRig(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup, std::optional<Axis> axis) {
  const std::string place = model.nodeName(node);
  RigDescription rig;
  rig.axis = axis ? *axis : nearestAxis(model, knots);
  const Extent extent = extentAlong(soup, *rig.axis);
  if (!(extent.length > 0)) {
    model.note(place + " is flat along its knots: no rig is made of them");
    return std::nullopt;
  }
  const glm::dvec3 origin = restTransform(nodeAt(model, knots.front())).translation;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const GltfTransform rest = restTransform(nodeAt(model, knots[i]));
    const std::string knot_name = "knot." + std::to_string(i) + " of " + place;
    const double along = (glm::dot(extent.axis, rest.translation) - extent.low) / extent.length;
    RigDescription::Knot knot;
    const bool first = i == 0, last = i + 1 == knots.size();
    knot.at = first ? 0.0f : last ? 1.0f : static_cast<float>(along);
    if ((first || last) && std::abs(along - (first ? 0 : 1)) > kEndTolerance)
      model.note(fmt::format("{} lies {:.0f} % of the mesh's length away from its end and is taken to the end; move it there", knot_name, 100 * std::abs(along - (first ? 0 : 1))));
    if (!first && !(knot.at > rig.knots.back().at)) {
      model.note(knot_name + " does not lie between its neighbours along the " + toString(*rig.axis) + " axis: no rig is made of the knots; put them in order");
      return std::nullopt;
    }
    glm::dvec3 beside = (rest.translation - origin) / extent.length;
    beside -= glm::dot(beside, extent.axis) * extent.axis;
    if (glm::length(beside) > kStraight) {
      knot.offset = glm::vec3(beside);
      model.note(knot_name + " lies beside the straight line through knot.0: the part is bent by that at rest");
    }
    bool turned = false;
    const glm::dvec3 handle = tangentHandle(rest, extent.axis, &turned);
    const glm::dvec3 tangent = tangentOf(rest, handle);
    if (!turned) model.note(knot_name + ": its +Y axis does not point along the spline: its tangent is straight at rest");
    const bool straight = glm::length(tangent - extent.axis) <= kStraight;
    knot.tangent = glm::vec3(straight ? extent.axis : tangent);
    if (!straight) model.note(knot_name + ": its +Y axis times its scale is not 1 along the spline: the part is bent or squeezed by that at rest");
    rig.knots.push_back(knot);
  }
  return rig;
}

void addClips(const GltfModel& model, int node, const std::vector<int>& knots, const TriangleSoup& soup, const std::string& part_name,
              const std::vector<GltfAnimation>& animations, const GltfChannelIndex& index, std::vector<std::vector<bool>>& used, RigDescription& rig) {
  const Extent extent = extentAlong(soup, rig.axis.value_or(Axis::kPlusY));
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
    if (clip_of.try_emplace(rig.clips[i].name, i).second) names.add(rig.clips[i].name, targetsOf(rig.clips[i].tracks));
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
      const GltfTransform rest = restTransform(nodeAt(model, knots[k]));
      if (channels.translation) {
        tracks.push_back(mapChannel(*channels.translation, static_cast<int>(k), Target::kKnotOffset, glm::dvec4(-rest.translation / extent.length, 0),
                                    [&](const glm::dvec4& v) { return glm::dvec4(glm::dvec3(v) / extent.length, 0); }));
        if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
      }
      if (channels.rotation || channels.scale) {
        tracks.push_back(sampleTangent(model, model.nodeName(knots[k]), rest, channels, static_cast<int>(k), tangentHandle(rest, extent.axis)));
        if (still(tracks.back(), glm::vec4(0))) tracks.pop_back();
      }
    }
    if (!ours) continue;
    if (tracks.empty()) {
      if (!knots.empty() || !rig.knots.empty()) model.note("animation '" + animation.name + "' holds part '" + part_name + "' still and makes no clip of it");
      continue;
    }
    // One node may move several parts: what it is named after is then its own name, which all of them share.
    const std::string wanted = !namedAfterItsNode(model, animation) ? animation.name : knots.empty() && !nodeAt(model, node).name.empty() ? oneLine(nodeAt(model, node).name, 80) : part_name;
    // Motions of one name join; two that move the same thing are two clips.
    const std::string name = names.take(wanted, targetsOf(tracks));
    const auto [at, fresh] = clip_of.try_emplace(name, rig.clips.size());
    if (fresh) rig.clips.emplace_back().name = name;
    RigDescription::Clip& clip = rig.clips[at->second];
    std::size_t keys = 0;
    for (const RigDescription::Track& track : tracks) keys += track.keys.size();
    model.budget->take(keys * sizeof(RigDescription::Key), "animation '" + animation.name + "'");  // parts may share the node that moves them
    const float length = animation.duration > 0 ? animation.duration : 1;  // a pose of a single key lasts a second
    clip.duration = std::max(clip.duration.value_or(0), length);
    clip.tracks.insert(clip.tracks.end(), tracks.begin(), tracks.end());
  }
}

}  // namespace kelp::bake
