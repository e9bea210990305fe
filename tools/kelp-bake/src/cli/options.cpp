// SPDX-License-Identifier: MIT
#include "cli/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "kelp/import/core/outer_rig.h"

namespace kelp::bake_cli {
namespace {

// A number that is all of the text.
template <class Number>
std::optional<Number> parseNumber(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// The values of one bake, read one by one. What cannot be is noted with its place.
class Reader {
 public:
  Reader(const Values& values, Faults& faults) : values_(values), faults_(faults) {}

  const std::string* find(const char* name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) return nullptr;
    if (!found->second.text.empty()) return &found->second.text;
    fail(name, "is empty; leave it out for the default");
    return nullptr;
  }
  void fail(const char* name, const std::string& what) const {
    const Value& value = values_.find(name)->second;
    faults_.add(value.place, std::string("--") + name + " " + value.text + ": " + what);
  }

  template <class Text>
  void text(const char* name, std::optional<Text>& out) const {
    if (const std::string* given = find(name)) out = *given;
  }
  template <class Number>
  bool wholeNumber(const char* name, Number& out) const {
    const std::string* given = find(name);
    if (!given) return false;
    const std::optional<int> value = parseNumber<int>(*given);
    if (!value) return fail(name, "not a whole number; see kelp-bake --help"), false;
    out = *value;
    return true;
  }
  // What the library takes as "leave it to me" is no number a user may give.
  void positiveNumber(const char* name, int& out) const {
    if (wholeNumber(name, out) && out < 1) fail(name, "less than 1; leave the option out for the default");
  }
  template <class Number>
  void finiteNumber(const char* name, Number& out) const {
    const std::string* given = find(name);
    if (!given) return;
    const std::optional<double> value = parseNumber<double>(*given);
    if (!value || !std::isfinite(*value)) return fail(name, "not a number; see kelp-bake --help");
    out = *value;
  }
  void axis(const char* name, std::optional<Axis>& out) const {
    const std::string* given = find(name);
    if (!given) return;
    out = parseAxis(*given);
    if (!out) fail(name, "not an axis; use one of +x -x +y -y +z -z");
  }
  void bend(const char* name, std::optional<Bend>& out) const {
    const std::string* given = find(name);
    if (!given) return;
    out = parseBend(*given);
    if (!out) fail(name, "unknown; use shear or sweep");
  }
  // `names`: "auto, solid or surface".
  template <class Choice>
  void choice(const char* name, Choice& out, const std::map<std::string, Choice>& choices,
              const char* names) const {
    const std::string* given = find(name);
    if (!given) return;
    const auto found = choices.find(*given);
    if (found == choices.end()) return fail(name, std::string("unknown; use ") + names);
    out = found->second;
  }
  bool flag(const char* name) const {
    const std::string* given = find(name);
    return given && *given == "true";
  }
  // In metres.
  bool unit(const char* name, double& out) const {
    static const std::map<std::string, double> kUnits = {
        {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
    const std::string* given = find(name);
    if (!given) return false;
    const auto known = kUnits.find(*given);
    const std::optional<double> metres = known != kUnits.end() ? known->second : parseNumber<double>(*given);
    if (!metres)
      return fail(name, "not a unit; use m, cm, mm, in, ft, or the length of one in metres, such as 0.01"),
             false;
    out = *metres;
    return true;
  }
  // "Walk:0.3": names may hold colons, numbers do not.
  void moment(const char* name, std::optional<bake::Moment>& out) const {
    const std::string* given = find(name);
    if (!given) return;
    const std::size_t colon = given->rfind(':');
    const std::optional<double> seconds =
        colon == std::string::npos ? std::nullopt : parseNumber<double>(given->substr(colon + 1));
    if (!seconds || colon == 0 || !std::isfinite(*seconds) || *seconds < 0)
      return fail(name,
                  "not a moment; give an animation's name and a time in seconds from 0 on, such as Walk:0.3");
    out = bake::Moment{given->substr(0, colon), *seconds};
  }
  void bytes(const char* name, std::uint64_t& out) const {
    const std::string* given = find(name);
    if (!given) return;
    const std::optional<std::uint64_t> value = parseBytes(*given);
    if (!value) return fail(name, "not a size; use a number with K, M, G or T, such as 4G");
    out = *value;
  }

 private:
  const Values& values_;
  Faults& faults_;
};

void readRig(const Reader& read, bake::Settings& settings) {
  const std::string* rig = read.find("rig");
  if (!rig) return;
  const std::vector<std::string> names = bake::rigNames();
  if (std::find(names.begin(), names.end(), *rig) != names.end()) {
    settings.rig_preset = *rig;
  } else {
    settings.rig_file = *rig;
  }
}

// What the library finds wrong with the settings names the option first; so its place is known.
void check(const Values& values, const bake::Settings& settings, Faults& faults) {
  for (const ToolError& fault : bake::settingsFaults(settings)) {
    const std::string what = fault.what();
    const std::size_t end = what.find_first_of(": ", 2);
    const auto value = what.rfind("--", 0) == 0 ? values.find(what.substr(2, end - 2)) : values.end();
    if (value == values.end())
      faults.add(fault);
    else
      faults.add(value->second.place, what);
  }
}

}  // namespace

std::optional<std::uint64_t> parseBytes(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !(value > 0)) return std::nullopt;
  std::string unit(end, text.data() + text.size());
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::map<std::string, int> kShift = {
      {"", 0},     {"b", 0},  {"k", 10},  {"kb", 10},  {"kib", 10}, {"m", 20},  {"mb", 20},
      {"mib", 20}, {"g", 30}, {"gb", 30}, {"gib", 30}, {"t", 40},   {"tb", 40}, {"tib", 40}};
  const auto shift = kShift.find(unit);
  if (shift == kShift.end()) return std::nullopt;
  const double bytes = std::ldexp(value, shift->second);
  if (!(bytes >= 1 && bytes < 9e18)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

Options readOptions(const Values& values) {
  Faults faults;
  Options options = readOptions(values, faults);
  faults.throwIfAny();
  return options;
}

Options readOptions(const Values& values, Faults& faults) {
  const Reader read(values, faults);
  Options options;
  bake::Settings& settings = options.settings;
  if (const std::string* input = read.find("input")) options.input = *input;
  if (const std::string* output = read.find("output")) options.output = *output;
  if (values.count("resolution") > 0 && values.count("voxel-size") > 0)
    read.fail("voxel-size", "excludes --resolution; choose one");
  settings.resolution_given = read.wholeNumber("resolution", settings.resolution);
  read.finiteNumber("voxel-size", settings.voxel_size);
  readRig(read, settings);
  read.axis("axis", settings.axis);
  read.bend("bend", settings.bend);
  read.axis("up", settings.up);
  options.unit_given = read.unit("unit", settings.unit);
  read.wholeNumber("pad", settings.pad);
  read.text("scene", settings.scene);
  read.choice("fill", settings.fill,
              {{"auto", bake::Fill::kAuto}, {"solid", bake::Fill::kSolid}, {"surface", bake::Fill::kSurface}},
              "auto, solid or surface");
  read.choice("parts", settings.parts, {{"one", bake::Parts::kOne}, {"nodes", bake::Parts::kNodes}},
              "one or nodes");
  read.moment("at", settings.at);
  read.wholeNumber("frame", settings.frame);
  read.text("palette", settings.palette_file);
  settings.keep_materials = read.flag("keep-materials");
  read.text("grid", settings.grid);
  read.choice("volume", settings.volume,
              {{"auto", bake::VolumeKind::kAuto},
               {"solid", bake::VolumeKind::kSolid},
               {"fog", bake::VolumeKind::kFog}},
              "auto, solid or fog");
  read.finiteNumber("isovalue", settings.isovalue);
  read.text("color-grid", settings.color_grid);
  read.text("heat-grid", settings.heat_grid);
  if (settings.heat_grid == "none") settings.heat_grid = "";
  read.finiteNumber("density", settings.density);
  read.text("ramp", settings.ramp_file);
  read.positiveNumber("levels", settings.levels);
  settings.distance = !read.flag("no-distance");
  read.choice("effort", settings.effort, {{"fast", Effort::kFast}, {"best", Effort::kBest}}, "fast or best");
  read.positiveNumber("threads", settings.threads);
  read.bytes("max-memory", settings.max_memory);
  read.positiveNumber("max-import-time", options.max_import_seconds);
  read.choice("progress", options.progress,
              {{"auto", ProgressStyle::kAuto},
               {"bar", ProgressStyle::kBar},
               {"json", ProgressStyle::kJson},
               {"none", ProgressStyle::kNone}},
              "auto, bar, json or none");
  read.text("cache", options.cache_folder);
  read.bytes("cache-size", options.cache_bytes);
  read.text("report", options.report_file);
  read.text("deps-file", options.dependency_file);
  if (!options.dependency_file && read.flag("write-deps"))
    options.dependency_file = options.output.string() + ".d";
  options.phony_deps = read.flag("deps-phony");
  read.text("deps-target", options.deps_target);
  for (const auto& [of_rule, given] : {std::pair("deps-phony", options.phony_deps),
                                       std::pair("deps-target", options.deps_target.has_value())})
    if (given && !options.dependency_file)
      read.fail(of_rule, "is of a rule that is not written; add -MD or -MF FILE, or leave it out");
  check(values, settings, faults);
  return options;
}

}  // namespace kelp::bake_cli
