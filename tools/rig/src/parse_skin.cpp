// SPDX-License-Identifier: MIT
// The part of a rig's JSON that divides a skin.
#include <algorithm>
#include <cmath>
#include <set>

#include "json_place.h"
#include "words.h"

namespace kelp::rig {
namespace {

int readCount(const Place& place, int min, int max) {
  const double value = readNumber(place, min, max);
  if (value != std::floor(value)) fail(place, printable(value) + " is no whole number");
  return static_cast<int>(value);
}

// `taken`: the joints of the groups before.
RigDescription::SkinGroup readGroup(const Place& place, std::set<std::string>& taken) {
  static constexpr std::array<std::string_view, 3> kKeys{"joints", "knots", "pieces"};
  requireObject(place, kKeys);
  RigDescription::SkinGroup group;
  const Place joints = required(place, "joints", "say which joints move these parts: [\"Hip\", ...]");
  requireArray(joints);
  if (joints.json.empty()) fail(joints, "names no joint; a part follows at least one");
  for (std::size_t i = 0; i < joints.json.size(); ++i) {
    const Place joint = joints.at(i);
    if (!joint.json.is_string())
      fail(joint, std::string("must be the name of a joint, not ") + kindOf(joint.json));
    const auto& name = joint.json.get_ref<const std::string&>();
    checkName(joint, "joint", name);
    if (!taken.insert(name).second)
      fail(joint, "the joint '" + printable(name) + "' is named twice; a joint belongs to one entry");
    group.joints.push_back(name);
  }
  if (place.has("knots")) {
    const Place knots = place.at("knots");
    group.knots = readCount(knots, kMinSkinKnots, kMaxSkinKnots);
    if (group.joints.size() < 2)
      fail(knots, "a swept part runs along at least two joints; name more, or take \"knots\" out");
    if (place.has("pieces"))
      fail(place.at("pieces"), "a swept part is one piece; take \"knots\" or \"pieces\" out");
  }
  if (place.has("pieces")) group.pieces = readCount(place.at("pieces"), 1, kMaxSkinPieces);
  return group;
}

}  // namespace

void readSkin(const Place& place, RigDescription& rig) {
  static constexpr std::array<std::string_view, 1> kKeys{"parts"};
  requireObject(place, kKeys);
  const Place parts = required(place, "parts", "list the parts: [{\"joints\": [\"Hip\", ...]}, ...]");
  requireArray(parts);
  if (parts.json.empty()) fail(parts, "lists no part; a skin becomes at least one");
  std::set<std::string> taken;
  int sum = 0;
  for (std::size_t i = 0; i < parts.json.size(); ++i) {
    // A swept part begins as one for each of its joints.
    const RigDescription::SkinGroup& group = rig.skin.emplace_back(readGroup(parts.at(i), taken));
    sum += group.knots > 0 ? static_cast<int>(std::min<std::size_t>(group.joints.size(), kMaxSkinParts + 1))
                           : group.pieces;
    if (sum > kMaxSkinParts)
      fail(parts, "asks for more than " + std::to_string(kMaxSkinParts) +
                      " parts, counting the joints of those that are swept; a skin becomes at most so many");
  }
}

}  // namespace kelp::rig
