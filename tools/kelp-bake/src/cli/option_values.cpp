// SPDX-License-Identifier: MIT
#include "cli/option_values.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "kelp/import/core/outer_rig.h"

namespace kelp::bake_cli {
namespace {

std::optional<std::uint64_t> parseBytes(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  std::string unit;
  for (const char c : std::string_view(end, text.data() + text.size()))
    if (c != ' ') unit += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  static const std::map<std::string, int> kShift = {
      {"", 0},     {"b", 0},  {"k", 10},  {"kb", 10},  {"kib", 10}, {"m", 20},  {"mb", 20},
      {"mib", 20}, {"g", 30}, {"gb", 30}, {"gib", 30}, {"t", 40},   {"tb", 40}, {"tib", 40}};
  const auto shift = kShift.find(unit);
  if (shift == kShift.end()) return std::nullopt;
  const double bytes = std::ldexp(value, shift->second);
  if (!(bytes >= 1 && bytes < 9e18)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace

Take countingNumber(int& out) {
  return [&out](const std::string& given) -> const char* {
    if (const char* const fault = number(out)(given)) return fault;
    return out < 1 ? "less than 1; leave the option out for the default" : nullptr;
  };
}

Take axis(std::optional<Axis>& out) {
  return [&out](const std::string& given) {
    out = parseAxis(given);
    return out ? nullptr : "not an axis; use one of +x -x +y -y +z -z";
  };
}

Take unit(Options& options) {
  return [&options](const std::string& given) -> const char* {
    static const std::map<std::string, double> kUnits = {
        {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
    const auto known = kUnits.find(given);
    const auto meters = known != kUnits.end() ? known->second : parseNumber<double>(given);
    if (!meters) return "not a unit; use m, cm, mm, in, ft, or the length of one in meters, such as 0.01";
    options.settings.unit = *meters;
    options.unit_given = true;
    return nullptr;
  };
}

// Names may hold colons, numbers do not.
Take moment(std::optional<bake::Moment>& out) {
  return [&out](const std::string& given) -> const char* {
    const std::size_t colon = given.rfind(':');
    const auto seconds =
        colon == std::string::npos ? std::nullopt : parseNumber<double>(given.substr(colon + 1));
    if (!seconds || colon == 0 || *seconds < 0)
      return "not a moment; give an animation's name and a time in seconds from 0 on, such as Walk:0.3";
    out = bake::Moment{given.substr(0, colon), *seconds};
    return nullptr;
  };
}

Take bytes(std::uint64_t& out) {
  return [&out](const std::string& given) -> const char* {
    const auto value = parseBytes(given);
    if (!value) return "not a size; use a number with K, M, G or T, such as 4G";
    out = *value;
    return nullptr;
  };
}

Take bend(bake::Settings& settings) {
  return [&settings](const std::string& given) {
    settings.caged = given == toString(Bend::kSweep, true);
    settings.bend = settings.caged ? Bend::kSweep : parseBend(given);
    return settings.bend ? nullptr : "unknown; use shear, sweep or cage";
  };
}

Take rig(bake::Settings& settings) {
  return [&settings](const std::string& given) {
    const std::vector<std::string> names = bake::rigNames();
    if (std::find(names.begin(), names.end(), given) != names.end())
      settings.rig_preset = given;
    else
      settings.rig_file = given;
    return nullptr;
  };
}

}  // namespace kelp::bake_cli
