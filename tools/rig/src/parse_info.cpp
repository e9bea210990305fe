// SPDX-License-Identifier: MIT
// The INFO of a pack -> what concerns its rigs.
#include <algorithm>
#include <map>
#include <optional>
#include <set>

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

}  // namespace

RiggedPack::RiggedPack(const Pack& pack) {
  const Json info = parseInfo(pack.infoJson());
  const Json &options = memberOf(info, "options"), &noted = memberOf(info, "axes"),
             &skin = memberOf(info, "skin"), &rigs = memberOf(skin, "rigs");
  skinned = skin.is_object();
  std::set<std::string_view> names;
  if (rigs.is_array())
    for (const Json& name : rigs)
      if (name.is_string()) names.insert(name.get_ref<const std::string&>());
  for (const Part& part : pack.parts()) {
    given.push_back(!skinned || names.contains(part.name));
    const Json& axis = memberOf(noted, part.name);
    axes.push_back((axis.is_string() ? parseAxis(axis.get_ref<const std::string&>()) : std::nullopt)
                       .value_or(axisByPlace(part.to_object, part.pivot).value_or(Axis::kPlusY)));
  }
  sides.resize(given.size());
  if (!skinned) findSides(pack);
  by_part = std::count(sides.begin(), sides.end(), std::nullopt) > 1 || memberOf(options, "parts") == "nodes";
}

// By their names.
void RiggedPack::findSides(const Pack& pack) {
  for (std::uint32_t of = 0; of < pack.parts().size(); ++of) {
    const Part& body = pack.parts()[of];
    if (body.cages.empty()) continue;
    if (body.sections >= 0) {
      const auto part = static_cast<std::size_t>(body.sections);
      sides[part] = Side{of, kSections};
      given[part] = false;
    }
    std::set<std::uint16_t> followed;
    for (const Influences& node : body.cages[0].influences)
      for (int i = 0; i < 4 && node.weights[i] > 0; ++i) followed.insert(node.parts[i]);
    std::map<std::string, int> names{{std::string(body.name) + " " + kOwnSide, -1}};
    for (int corner = 0; corner < 4; ++corner)
      names[std::string(body.name) + " " + cornerName(corner, axes[of])] = corner;
    for (const std::uint16_t part : followed) {
      const auto its = names.find(std::string(pack.parts()[part].name));
      if (its == names.end()) continue;
      sides[part] = Side{of, its->second};
      given[part] = false;
    }
  }
}

}  // namespace kelp
