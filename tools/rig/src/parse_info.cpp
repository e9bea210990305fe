// SPDX-License-Identifier: MIT
// The INFO of a pack -> what concerns its rigs.
#include <map>
#include <optional>

#include "json_place.h"
#include "kelp/common/json_depth.h"
#include "kelp/rig/rig_file.h"

namespace kelp {
namespace {

using rig::Json;

// An empty object for text that kelp-bake does not write.
Json parseInfo(std::string_view text) {
  constexpr std::size_t kMaxBytes = std::size_t{4} << 20, kMaxMembers = 4096;
  constexpr int kMaxDepth = 16;
  if (text.size() > kMaxBytes || nestedDeeper(text, kMaxDepth) || hasLargerObjects(text, kMaxMembers))
    return Json::object();
  Json json = Json::parse(text, nullptr, false);
  return json.is_object() ? json : Json::object();
}

// The member of an object; null if there is none.
const Json& memberOf(const Json& json, std::string_view key) {
  static const Json kNull;
  if (!json.is_object()) return kNull;
  const auto found = json.find(std::string(key));
  return found == json.end() ? kNull : *found;
}

// A part's entry. Nothing if it cannot be read.
std::optional<RigDescription::SkinGroup> groupOf(const Json& part) {
  const Json &joints = memberOf(part, "joints"), &knots = memberOf(part, "knots");
  if (!joints.is_array()) return std::nullopt;
  RigDescription::SkinGroup group;
  for (const Json& joint : joints) {
    if (!joint.is_string()) return std::nullopt;
    group.joints.push_back(joint.get<std::string>());
  }
  if (knots.is_null()) return group;
  if (!knots.is_number_integer() || knots < kMinSkinKnots || knots > kMaxSkinKnots) return std::nullopt;
  group.knots = knots.get<int>();
  return group;
}

// Why the skin's parts, of which the pack has `count`, cannot be read; empty if they can.
std::string readSkinParts(const Json& skin, std::size_t count, RiggedPack& out) {
  const Json& parts = memberOf(skin, "parts");
  if (!parts.is_array()) return "it lists no parts";
  if (parts.size() != count) return "it has another number of parts";
  RigDescription rig;
  std::map<std::vector<std::string>, std::size_t> entries;  // of rigid parts
  for (const Json& part : parts) {
    const std::optional<RigDescription::SkinGroup> group = groupOf(part);
    if (!group) return "a part has no joints, or knots that no rig has";
    out.given.push_back(memberOf(part, "rig") == true);
    if (group->knots == 0) {
      const auto [entry, fresh] = entries.emplace(group->joints, rig.skin.size());
      if (!fresh) {
        ++rig.skin[entry->second].pieces;
        continue;
      }
    }
    rig.skin.push_back(*group);
  }
  try {
    out.skin = parseRig(printRig(rig));
  } catch (const RigError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

RiggedPack::RiggedPack(const Pack& pack) {
  const Json info = parseInfo(pack.infoJson());
  const Json &options = memberOf(info, "options"), &noted = memberOf(info, "axes"),
             &divided = memberOf(info, "skin");
  if (!divided.is_null()) skin_problem = readSkinParts(divided, pack.parts().size(), *this);
  by_part = pack.parts().size() > 1 || memberOf(options, "parts") == "nodes" || !skin.skin.empty();
  skin_asked = memberOf(options, "rig") == "skin";
  for (const Part& part : pack.parts()) {
    const Json& axis = memberOf(noted, part.name);
    axes.push_back((axis.is_string() ? parseAxis(axis.get_ref<const std::string&>()) : std::nullopt)
                       .value_or(axisByPlace(part.to_object, part.pivot).value_or(Axis::kPlusY)));
  }
}

}  // namespace kelp
