// SPDX-License-Identifier: MIT
#include "rig/skin_rig.h"

#include <map>
#include <vector>

#include "text/safe_json.h"

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

// What INFO says of one part. nullopt: it cannot be read.
std::optional<RigDescription::SkinGroup> groupOf(const Json& part) {
  if (!part.is_object() || !part.contains("joints") || !part.at("joints").is_array()) return std::nullopt;
  RigDescription::SkinGroup group;
  for (const Json& joint : part.at("joints")) {
    if (!joint.is_string()) return std::nullopt;
    group.joints.push_back(joint.get<std::string>());
  }
  if (!part.contains("knots")) return group;
  const Json& knots = part.at("knots");
  if (!knots.is_number_integer() || knots < kMinSkinKnots || knots > kMaxSkinKnots) return std::nullopt;
  group.knots = knots.get<int>();
  return group;
}

}  // namespace

SkinRig skinRig(std::string_view info, std::size_t parts) {
  const std::optional<Json> json = parseSafely(info);
  if (!json || !json->is_object() || !json->contains("skin")) return {};
  const Json& skin = json->at("skin");
  if (!skin.is_object() || !skin.contains("parts") || !skin.at("parts").is_array())
    return {std::nullopt, "it lists no parts"};
  if (skin.at("parts").size() != parts) return {std::nullopt, "it has another number of parts"};
  RigDescription rig;
  std::map<std::vector<std::string>, std::size_t> entries;  // of rigid parts
  for (const Json& part : skin.at("parts")) {
    const std::optional<RigDescription::SkinGroup> group = groupOf(part);
    if (!group) return {std::nullopt, "a part has no joints, or knots that no rig has"};
    if (group->knots == 0) {
      const auto [at, fresh] = entries.emplace(group->joints, rig.skin.size());
      if (!fresh) {
        ++rig.skin[at->second].pieces;
        continue;
      }
    }
    rig.skin.push_back(*group);
  }
  try {
    return {parseRig(printRig(rig)), ""};
  } catch (const RigError& error) {
    return {std::nullopt, error.what()};
  }
}

}  // namespace kelp::dump
