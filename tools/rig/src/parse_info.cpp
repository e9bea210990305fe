// SPDX-License-Identifier: MIT
// The INFO of a pack -> what concerns its rigs.
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
  by_part = pack.parts().size() > 1 || memberOf(options, "parts") == "nodes";
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
}

}  // namespace kelp
