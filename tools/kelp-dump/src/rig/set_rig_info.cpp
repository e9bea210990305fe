// SPDX-License-Identifier: MIT
#include "rig/set_rig_info.h"

#include <fmt/format.h>

#include "text/safe_json.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kelp::dump {
namespace {

using Json = nlohmann::ordered_json;

const Json* optionsOf(const std::optional<Json>& info) {
  if (!info || !info->is_object() || !info->contains("options") || !info->at("options").is_object())
    return nullptr;
  return &info->at("options");
}

// kelp-bake writes the members of "options" in a fixed order, so the same options are the same bytes. Whether
// a member comes before "axis", before "rig".
bool beforeAxis(const std::string& key) { return key == "voxel_size" || key == "resolution"; }
bool beforeRig(const std::string& key) {
  return beforeAxis(key) || key == "axis" || key == "up" || key == "unit" || key == "pad";
}

template <class Before>
Json with(const Json& options, const char* key, const Json& value, Before before) {
  Json out = Json::object();
  bool there = false;
  for (const auto& [name, member] : options.items()) {
    if (!there && (name == key || !before(name))) {
      out[key] = value;
      there = true;
    }
    if (name != key) out[name] = member;
  }
  if (!there) out[key] = value;
  return out;
}

}  // namespace

std::optional<BakeOptions> bakeOptions(std::string_view text) {
  BakeOptions read;
  const std::optional<Json> info = parseSafely(text);
  if (!info && !text.empty()) return std::nullopt;
  const Json* const options = optionsOf(info);
  if (!options) return read;
  const auto axis = [&](const char* key) {
    return options->contains(key) && options->at(key).is_string()
               ? parseAxis(options->at(key).get_ref<const std::string&>())
               : std::nullopt;
  };
  read.axis = axis("axis");
  read.up = axis("up");
  if (options->contains("bend") && options->at("bend").is_string())
    read.bend = parseBend(options->at("bend").get_ref<const std::string&>());
  // MagicaVoxel's files have z up, unless the user said otherwise.
  const Json* const source =
      info->contains("source") && info->at("source").is_object() ? &info->at("source") : nullptr;
  if (!read.up && source && source->value("format", Json()) == "MagicaVoxel") read.up = Axis::kPlusZ;
  if (options->contains("pad") && options->at("pad").is_number_integer())
    read.pad = options->at("pad").get<std::int64_t>();
  return read;
}

std::string infoWithRig(std::string_view text, const std::string& part, const std::string& preset,
                        const std::string& file_name, std::string_view file_content,
                        std::optional<Axis> axis) {
  std::optional<Json> info = parseSafely(text);
  const Json* const options = optionsOf(info);
  if (!options) return std::string(text);
  const Json rig =
      preset.empty()
          ? Json{{"name", file_name},
                 {"xxh3", fmt::format("{:016x}", XXH3_64bits(file_content.data(), file_content.size()))}}
          : Json(preset);
  if (!part.empty()) {
    Json set = rig.is_object() ? rig : Json{{"preset", rig}};
    if (axis) set["axis"] = toString(*axis);
    Json& rigs = (*info)["rigs"];
    if (!rigs.is_object()) rigs = Json::object();
    rigs[part] = set;
    return info->dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  Json changed = *options;
  if (axis) changed = with(changed, "axis", toString(*axis), beforeAxis);
  (*info)["options"] = with(changed, "rig", rig, beforeRig);
  return info->dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace kelp::dump
