// SPDX-License-Identifier: MIT
#include "options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include <CLI/CLI.hpp>

namespace kelp::bake_cli {
namespace {

using bake::BakeError;
using bake::Exit;

constexpr const char* kExamples = R"(Examples:
  kelp-bake reed.glb -o reed.kelp                     128 voxels along the longest side
  kelp-bake reed.glb -o reed.kelp --resolution 256    finer
  kelp-bake fish.obj -o fish.kelp --axis -x --rig swim
  kelp-bake part.stl -o part.kelp --up +z --unit mm   as CAD programs write it
  kelp-bake plant.ply -o plant.kelp --voxel-size 0.01 --rig plant.rig.json
  kelp-bake cloud.vdb -o cloud.kelp --report cloud.json
  kelp-bake knight.vox -o knight.kelp --unit 0.05     voxels of 5 cm, colours and their order as painted
  kelp-bake scan.vdb -o skull.kelp --grid density --isovalue 0.4
  kelp-bake truck.gltf -o truck.kelp --parts nodes    wheels turn by the file's animations
  kelp-bake fox.gltf -o fox.kelp --at Walk:0.3        the skinned fox in the midst of a step

A rig comes from --rig, from STEM.rig.json beside the input, from a glTF node's extras.kelp, or from empties named
knot.0, knot.1, ... under a mesh; without any the part is straight. Exit codes: 0 done, 1 usage, 2 files, 3 invalid input,
4 out of memory, 5 unsupported feature, 130 interrupted (Ctrl-C lets a file that is being read come to its end; a second
one stops at once; an existing output stays as it was in either case).)";

// A number that is all of the text.
template <class Number>
std::optional<Number> parseNumber(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int wholeNumber(const std::string& option, const std::string& text) {
  const std::optional<int> value = parseNumber<int>(text);
  if (!value) throw BakeError(Exit::kUsage, option + " " + text + ": not a whole number; see kelp-bake --help");
  return *value;
}

double finiteNumber(const std::string& option, const std::string& text) {
  const std::optional<double> value = parseNumber<double>(text);
  if (!value || !std::isfinite(*value)) throw BakeError(Exit::kUsage, option + " " + text + ": not a number; see kelp-bake --help");
  return *value;
}

// What the library takes as "leave it to me" is no number a user may give.
int positiveNumber(const std::string& option, const std::string& text) {
  const int value = wholeNumber(option, text);
  if (value < 1) throw BakeError(Exit::kUsage, option + " " + text + ": less than 1; leave the option out for the default");
  return value;
}

// In metres.
double parseUnit(const std::string& text) {
  static const std::map<std::string, double> kUnits = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
  if (const auto unit = kUnits.find(text); unit != kUnits.end()) return unit->second;
  const std::optional<double> metres = parseNumber<double>(text);
  if (!metres) throw BakeError(Exit::kUsage, "--unit " + text + ": not a unit; use m, cm, mm, in, ft, or the length of one in metres, such as 0.01");
  return *metres;
}

// "Walk:0.3": names may hold colons, numbers do not.
bake::Moment parseMoment(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::optional<double> seconds = colon == std::string::npos ? std::nullopt : parseNumber<double>(text.substr(colon + 1));
  if (!seconds || colon == 0 || !std::isfinite(*seconds) || *seconds < 0)
    throw BakeError(Exit::kUsage, "--at " + text + ": not a moment; give an animation's name and a time in seconds from 0 on, such as Walk:0.3");
  return {text.substr(0, colon), *seconds};
}

// The compilers' spelling: a single dash and two letters, which CLI11 would take apart.
std::vector<std::string> readArguments(int argc, const char* const* argv) {
  std::vector<std::string> arguments;
  for (int i = argc - 1; i > 0; --i) {  // CLI11 takes them last first
    const std::string argument = argv[i];
    arguments.push_back(argument == "-MD" ? "--write-deps" : argument == "-MF" ? "--deps-file" : argument);
  }
  return arguments;
}

}  // namespace

std::optional<std::uint64_t> parseBytes(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !(value > 0)) return std::nullopt;
  std::string unit(end, text.data() + text.size());
  unit.erase(std::remove(unit.begin(), unit.end(), ' '), unit.end());
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::map<std::string, int> kShift = {{"", 0}, {"b", 0}, {"k", 10}, {"kb", 10}, {"kib", 10}, {"m", 20}, {"mb", 20}, {"mib", 20}, {"g", 30}, {"gb", 30}, {"gib", 30}, {"t", 40}, {"tb", 40}, {"tib", 40}};
  const auto shift = kShift.find(unit);
  if (shift == kShift.end()) return std::nullopt;
  const double bytes = std::ldexp(value, shift->second);
  if (!(bytes >= 1 && bytes < 9e18)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

std::optional<Options> parseOptions(int argc, const char* const* argv) {
  CLI::App app("Bakes a mesh or a volume into a voxel pack (.kelp) that bends in real time.", "kelp-bake");
  app.set_version_flag("--version", "kelp-bake " KELP_VERSION " (" KELP_BUILD ")");
  app.footer(kExamples);
  std::string input, output, resolution, voxel_size, rig, axis, up, unit, pad, fill = "auto", parts = "one", at, palette, grid, volume = "auto", isovalue, color_grid, heat_grid, density, ramp, levels, threads, max_memory, scene, frame, progress = "auto", report, deps;
  bool write_deps = false;
  Options options;
  app.add_option("input", input, "glTF/GLB, OBJ, PLY, STL, OFF, Draco (.drc), VDB, NVDB, MagicaVoxel (.vox), .binvox or .raw file")->required()->type_name("FILE");
  app.add_option("-o,--output", output, "the pack to write; an existing one is replaced when the new one is complete")->required()->type_name("FILE");
  const auto resolution_option = app.add_option("--resolution", resolution, "voxels along the longest side of the largest part, 1 to 8192 (default 128)")->type_name("N");
  app.add_option("--voxel-size", voxel_size, "edge of a voxel in metres; .vox and .binvox keep their voxels, and get this size")->type_name("LENGTH")->excludes(resolution_option);
  app.add_option("--rig", rig, "a rig as JSON, or a preset: none, sway, swim")->type_name("FILE|PRESET");
  app.add_option("--axis", axis, "the axis to bend along where the rig names none, in the file's own axes: +x -x +y -y +z -z (default: --up)")->type_name("AXIS");
  app.add_option("--up", up, "the file's axis that points up, +y in the pack: +x -x +y -y +z -z (default +y, of .vox +z)")->type_name("AXIS");
  app.add_option("--unit", unit, "the length of a unit of the file: m, cm, mm, in, ft, or a number of metres (default m); a voxel of .vox is a unit")->type_name("UNIT");
  app.add_option("--pad", pad, "empty voxels on every side of a part, 0 to 1024 (default 0); none along the axis of one that bends")->type_name("N");
  app.add_option("--scene", scene, "the scene of a glTF file to bake, by index from 0 or by name; a number that is an index counts as one (default: the file's own default)")->type_name("NAME|INDEX");
  app.add_option("--fill", fill, "auto: solid where closed, holes capped; solid; surface")->type_name("auto|solid|surface");
  app.add_option("--parts", parts, "one: one part beside those with rigs of their own; nodes: of glTF, a part for every node with a mesh, and clips of their animations; .vox: a part for every object")->type_name("one|nodes");
  app.add_option("--at", at, "glTF: bake nodes, skins and morph targets as an animation has them at a time, e.g. Walk:0.3")->type_name("CLIP:SECONDS");
  app.add_option("--frame", frame, "MagicaVoxel: the frame of its animation to bake, from 0 on (default: where it begins)")->type_name("N");
  app.add_option("--palette", palette, "bake with these colours alone: a GIMP palette (.gpl) or a picture of at most 256 colours")->type_name("FILE");
  app.add_flag("--keep-materials", options.settings.keep_materials, "materials of one colour keep palette entries of their own; --report names them");
  app.add_option("--grid", grid, "volumes: the grid to bake, by name or else by index from 0; needed where a file has several")->type_name("NAME|INDEX");
  app.add_option("--volume", volume, "volumes: auto: level sets and masks are solid, densities fog unless --isovalue is given; solid; fog")->type_name("auto|solid|fog");
  app.add_option("--isovalue", isovalue, "volumes: solid where a density is at least this, or a level set at most (default 0 for level sets, half the greatest value for others)")->type_name("VALUE");
  app.add_option("--color-grid", color_grid, "volumes: the grid of vectors that colours a solid (default: Cd or color)")->type_name("NAME|INDEX");
  const auto heat_option = app.add_option("--heat-grid", heat_grid, "volumes: the grid that fog glows of (default: flame, flames, heat or temperature); none")->type_name("NAME|INDEX|none");
  app.add_option("--density", density, "volumes: factor on the densities of fog (default 1)")->type_name("FACTOR");
  app.add_option("--ramp", ramp, "volumes: the colours that fog glows in, cold to hot: a GIMP palette (.gpl) or a picture (default: those of a black body)")->type_name("FILE");
  app.add_option("--levels", levels, "levels of detail (default: down to one brick)")->type_name("N");
  app.add_option("--threads", threads, "threads (default: all); the pack does not depend on it")->type_name("N");
  app.add_option("--max-memory", max_memory, "refuse to start a bake that needs more, e.g. 4G (default: the machine's memory; pictures get 1G and 256 bytes for each of the files' own)")->type_name("SIZE");
  app.add_option("--progress", progress, "auto: a bar on a terminal; bar; json: a line a step on stderr; none")->type_name("auto|bar|json|none");
  app.add_option("--report", report, "write what was done and how long it took, as JSON")->type_name("FILE");
  app.add_flag("--write-deps", write_deps, "write the files that were read as a make rule to OUT.d (also -MD)");
  app.add_option("--deps-file", deps, "where to write that rule instead (also -MF)")->type_name("FILE");
  try {
    std::vector<std::string> arguments = readArguments(argc, argv);
    app.parse(arguments);
  } catch (const CLI::CallForHelp&) {
    std::fputs(app.help().c_str(), stdout);
    return std::nullopt;
  } catch (const CLI::CallForVersion&) {
    std::fputs("kelp-bake " KELP_VERSION " (" KELP_BUILD ")\n", stdout);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw BakeError(Exit::kUsage, std::string(error.what()) + "; see kelp-bake --help");
  }

  options.input = input;
  options.output = output;
  if (!resolution.empty()) {
    options.settings.resolution = wholeNumber("--resolution", resolution);
    options.settings.resolution_given = true;
  }
  if (!voxel_size.empty()) {
    options.settings.voxel_size = parseNumber<double>(voxel_size);
    if (!options.settings.voxel_size) throw BakeError(Exit::kUsage, "--voxel-size " + voxel_size + ": not a number; give a length such as 0.01");
  }
  if (!rig.empty()) {
    const std::vector<std::string> presets = presetNames();
    if (std::find(presets.begin(), presets.end(), rig) != presets.end()) {
      options.settings.rig_preset = rig;
    } else {
      options.settings.rig_file = rig;
    }
  }
  if (!axis.empty()) {
    options.settings.axis = parseAxis(axis);
    if (!options.settings.axis) throw BakeError(Exit::kUsage, "--axis " + axis + ": not an axis; use one of +x -x +y -y +z -z");
  }
  if (!up.empty()) {
    options.settings.up = parseAxis(up);
    if (!options.settings.up) throw BakeError(Exit::kUsage, "--up " + up + ": not an axis; use one of +x -x +y -y +z -z");
  }
  options.unit_given = !unit.empty();
  if (options.unit_given) options.settings.unit = parseUnit(unit);
  if (!pad.empty()) options.settings.pad = wholeNumber("--pad", pad);
  if (!scene.empty()) options.settings.scene = scene;
  if (fill == "solid") {
    options.settings.fill = bake::Fill::kSolid;
  } else if (fill == "surface") {
    options.settings.fill = bake::Fill::kSurface;
  } else if (fill != "auto") {
    throw BakeError(Exit::kUsage, "--fill " + fill + ": unknown; use auto, solid or surface");
  }
  if (parts == "nodes") {
    options.settings.parts = bake::Parts::kNodes;
  } else if (parts != "one") {
    throw BakeError(Exit::kUsage, "--parts " + parts + ": unknown; use one or nodes");
  }
  if (!at.empty()) options.settings.at = parseMoment(at);
  if (!frame.empty()) options.settings.frame = wholeNumber("--frame", frame);
  if (!palette.empty()) options.settings.palette_file = palette;
  if (!grid.empty()) options.settings.grid = grid;
  if (volume == "solid") {
    options.settings.volume = bake::VolumeKind::kSolid;
  } else if (volume == "fog") {
    options.settings.volume = bake::VolumeKind::kFog;
  } else if (volume != "auto") {
    throw BakeError(Exit::kUsage, "--volume " + volume + ": unknown; use auto, solid or fog");
  }
  if (!isovalue.empty()) options.settings.isovalue = finiteNumber("--isovalue", isovalue);
  if (!color_grid.empty()) options.settings.color_grid = color_grid;
  if (heat_option->count() > 0) options.settings.heat_grid = heat_grid == "none" ? "" : heat_grid;
  if (!density.empty()) options.settings.density = finiteNumber("--density", density);
  if (!ramp.empty()) options.settings.ramp_file = ramp;
  if (!levels.empty()) options.settings.levels = positiveNumber("--levels", levels);
  if (!threads.empty()) options.settings.threads = positiveNumber("--threads", threads);
  if (!max_memory.empty()) {
    const std::optional<std::uint64_t> bytes = parseBytes(max_memory);
    if (!bytes) throw BakeError(Exit::kUsage, "--max-memory " + max_memory + ": not a size; use a number with K, M, G or T, such as 4G");
    options.settings.max_memory = *bytes;
  }
  static const std::map<std::string, ProgressStyle> kStyles = {{"auto", ProgressStyle::kAuto}, {"bar", ProgressStyle::kBar}, {"json", ProgressStyle::kJson}, {"none", ProgressStyle::kNone}};
  const auto style = kStyles.find(progress);
  if (style == kStyles.end()) throw BakeError(Exit::kUsage, "--progress " + progress + ": unknown; use auto, bar, json or none");
  options.progress = style->second;
  if (!report.empty()) options.report_file = report;
  if (!deps.empty()) {
    options.dependency_file = deps;
  } else if (write_deps) {
    options.dependency_file = output + ".d";
  }
  return options;
}

}  // namespace kelp::bake_cli
