// SPDX-License-Identifier: MIT
#include "kelp/common/skin_info.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "kelp/common/json_depth.h"

namespace kelp {
namespace {

constexpr double kFarthest = 1e6;  // voxels: more than any part has along a side
constexpr int kMaxDepth = 32;      // what kelp-bake writes is 5 levels deep

// Null if there is none.
const nlohmann::json* memberOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);  // the end, if this is no object
  return found == object.end() ? nullptr : &*found;
}

// A distance in voxels; -1 if there is none that can be true.
double distanceAt(const nlohmann::json& fit, const char* key) {
  const nlohmann::json* const number = memberOf(fit, key);
  if (!number || !number->is_number()) return -1;
  const double distance = number->get<double>();
  return distance >= 0 && distance <= kFarthest ? distance : -1;
}

std::optional<PartFit> fitOf(const nlohmann::json& part) {
  const nlohmann::json* const fit = memberOf(part, "fit");
  if (!fit) return {};
  const PartFit its{distanceAt(*fit, "mean"), distanceAt(*fit, "p95"), distanceAt(*fit, "max")};
  if (its.mean < 0 || its.p95 < 0 || its.max < std::max(its.mean, its.p95)) return {};
  return its;
}

}  // namespace

std::vector<PartSkin> readSkin(std::string_view info_json, std::size_t parts) {
  std::vector<PartSkin> skin(parts);
  if (nestedDeeper(info_json, kMaxDepth)) return skin;
  const nlohmann::json info = nlohmann::json::parse(info_json, nullptr, false);
  const nlohmann::json* const whole = memberOf(info, "skin");
  const nlohmann::json* const list = whole ? memberOf(*whole, "parts") : nullptr;
  if (!list || !list->is_array()) return skin;
  for (std::size_t i = 0; i < std::min(parts, list->size()); ++i) {
    const nlohmann::json& part = (*list)[i];
    skin[i].fit = fitOf(part);
    const nlohmann::json* const joints = memberOf(part, "joints");
    if (!joints || !joints->is_array()) continue;
    for (const nlohmann::json& joint : *joints)
      if (joint.is_string()) skin[i].joints.push_back(joint.get<std::string>());
  }
  return skin;
}

std::vector<PartSkin> skinOf(const Pack& pack) {
  std::vector<PartSkin> skin = readSkin(pack.infoJson(), pack.parts().size());
  if (pack.clips().empty()) {
    for (PartSkin& part : skin) part.fit.reset();
  }
  return skin;
}

bool knowsFit(const std::vector<PartSkin>& skin) {
  return std::any_of(skin.begin(), skin.end(), [](const PartSkin& part) { return part.fit.has_value(); });
}

}  // namespace kelp
