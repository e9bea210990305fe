// SPDX-License-Identifier: MIT
// The text of a rig file: one rig, or the rigs of parts by name.
#include <algorithm>
#include <array>

#include "json_place.h"
#include "kelp/rig/rig_file.h"

namespace kelp {
namespace {

using namespace rig;

std::vector<RigFile::PartRig> readParts(const Place& place) {
  if (!place.json.is_object())
    fail(place, std::string("must be an object that maps names of parts to rigs, not ") + kindOf(place.json));
  if (place.json.empty()) fail(place, "names no part; give one a rig, or take \"parts\" out");
  std::vector<RigFile::PartRig> parts;
  for (const auto& member : place.json.items()) {
    const Place entry = place.at(member.key());
    checkName(entry, "part", member.key());
    parts.push_back({member.key(), readRig(entry, RigPlace::kPart)});
  }
  return parts;
}

}  // namespace

const RigDescription* RigFile::find(std::string_view part) const {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const PartRig& its) { return its.name == part; });
  return found == parts.end() ? nullptr : &found->rig;
}

RigFile parseRigFile(std::string_view text) {
  static constexpr std::array<std::string_view, 2> kKeys{"kelp", "parts"};
  static constexpr std::array<std::string_view, 8> kOfParts{"axis",      "knots", "clips", "sockets",
                                                            "parent_at", "bend",  "roll",  "sides"};
  const Json json = parseJson(text);
  const Place place{json, ""};
  RigFile file;
  if (!place.has("parts")) {
    file.whole = readRig(place, RigPlace::kFile);
    return file;
  }
  for (const std::string_view key : kOfParts)
    if (json.contains(key))
      fail(place.at(std::string(key)), "beside \"parts\" it belongs to no part; move it into a part's rig");
  refuseSkin(place);
  requireObject(place, kKeys);
  requireVersion(place);
  file.parts = readParts(place.at("parts"));
  return file;
}

}  // namespace kelp
