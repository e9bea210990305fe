// SPDX-License-Identifier: MIT
#include "cli/options.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/messages.h"
#include "cli/option_values.h"
#include "contained/sandbox.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

constexpr const char* kExamples = R"(Examples:
  kelp-bake reed.glb -o reed.kelp                     128 voxels along the longest side
  kelp-bake reed.glb -o reed.kelp --resolution 256    finer
  kelp-bake fish.obj -o fish.kelp --axis -x --rig swim
  kelp-bake part.stl -o part.kelp --up +z --unit mm   as CAD programs write it
  kelp-bake plant.ply -o plant.kelp --voxel-size 0.01 --rig plant.rig.json
  kelp-bake cloud.vdb -o cloud.kelp --report cloud.json
  kelp-bake knight.vox -o knight.kelp --unit 0.05     voxels of 5 cm
  kelp-bake scan.vdb -o skull.kelp --grid density --isovalue 0.4
  kelp-bake truck.gltf -o truck.kelp --parts nodes    wheels turn by the file's animations
  kelp-bake fox.gltf -o fox.kelp --at Walk:0.3        a skinned fox in the middle of a step
  kelp-bake reed.glb -o reed.kelp -MD                 in a build: also writes a rule for make and ninja

The rig comes from --rig, or else from STEM.rig.json beside the input, from a glTF node's extras.kelp, from
empties named knot.0, knot.1, ... under a mesh, or from skins that animations move. Without a rig the part is
straight.

Exit codes: 0 done, 1 usage, 2 files, 3 invalid input, 4 failure at run time (memory, time, a
crash, a forbidden call), 5 unsupported feature, 130 interrupted.

Ctrl-C stops after the current step, a second Ctrl-C at once. An existing output stays as it was.)";

// Options of older versions, and what does their work now.
constexpr const char* kFarm = "see samples/farm";
constexpr const char* kBuild = "kelp_add_pack, make or Ninja through -MD rebuild only what changed";
constexpr std::pair<std::string_view, const char*> kGone[] = {
    {"--manifest", kFarm},
    {"--shard", kFarm},
    {"--plan", kFarm},
    {"--force", "a bake is always done anew"},
    {"--cache", kBuild},
    {"--cache-size", kBuild},
    {"--config", "give its options on the command line"},
    {"--print-config", "see kelp-bake --help"},
};

[[noreturn]] void misuse(const std::string& what) { throw ToolError(Exit::kUsage, what); }

void refuseGone(const std::string& input, const std::vector<std::string>& unknown) {
  if (input.starts_with('@'))
    misuse(input + ": a list of files is gone; " + kFarm + "; a file of that name is ./" + input);
  for (const std::string& word : unknown)
    for (const auto& [name, instead] : kGone)
      if (word.substr(0, word.find('=')) == name) misuse(std::string(name) + " is gone; " + instead);
}

// CLI11 takes the last word first, and knows no single dash with two letters, which compilers have.
std::vector<std::string> wordsForCli11(const std::vector<std::string>& words) {
  std::vector<std::string> reversed(words.rbegin(), words.rend() - 1);
  for (std::string& word : reversed)
    for (const auto& [brief, full] : {std::pair("-MD", "--write-deps"), std::pair("-MF", "--deps-file"),
                                      std::pair("-MP", "--deps-phony"), std::pair("-MT", "--deps-target")})
      if (word == brief) word = full;
  return reversed;
}

// Adds options to CLI11 under a heading of --help.
class Adder {
 public:
  explicit Adder(CLI::App& app) : app_(app) {}
  void heading(const char* heading) { heading_ = heading; }
  CLI::Option* option(const char* names, const char* value, const char* help, const Take& take) {
    const auto checked = [name = std::string(names), take](const std::string& given) {
      const std::string shown = name.substr(name.find(',') + 1);  // "-o,--output"
      if (given.empty()) misuse(shown + ": is empty; give a value, or leave it out");
      if (const char* const fault = take(given)) misuse(shown + " " + given + ": " + fault);
    };
    return app_.add_option_function<std::string>(names, checked, help)->type_name(value)->group(heading_);
  }
  CLI::Option* flag(const char* name, const char* help, bool& out) {
    return app_.add_flag(name, out, help)->group(heading_);
  }

 private:
  CLI::App& app_;
  const char* heading_ = "Options";
};

void addModelOptions(Adder& add, bake::Settings& settings, Options& options) {
  add.heading("Size and place");
  add.option("--resolution", "N",
             "voxels along the longest side of the largest part, 1 to 8192 (default 128)",
             [&settings](const std::string& given) {
               settings.resolution_given = true;
               return number(settings.resolution)(given);
             });
  add.option("--voxel-size", "LENGTH",
             "edge of a voxel in meters, in place of --resolution; voxels of .vox and .binvox stay, with "
             "this size",
             number(settings.voxel_size));
  add.option("--up", "+x|-x|+y|-y|+z|-z", "the file's axis that points up (default +y; of .vox +z)",
             axis(settings.up));
  add.option("--unit", "m|cm|mm|in|ft|METERS",
             "the file's unit of length (default m); of .vox, the size of a voxel", unit(options));
  add.option("--pad", "N",
             "empty voxels on every side of a part, 0 to 1024 (default 0), except along the axis of a part "
             "that bends",
             number(settings.pad));
  add.heading("Bending");
  add.option(
      "--rig", "FILE|none|sway|swim|breathe|twist|skin",
      "a rig file (JSON; \"parts\": one rig for each part), a preset, or skin: the file's skin (default: "
      "STEM.rig.json beside the input, or else the rig or the skin in the file)",
      rig(settings));
  add.option("--axis", "+x|-x|+y|-y|+z|-z",
             "the axis to bend along if the rig has none, in the file's axes (default: --up)",
             axis(settings.axis));
  add.option("--bend", "shear|sweep|cage",
             "how solid parts bend whose rig does not say; sweep: sections stay perpendicular to the "
             "spline, which may curl; shear: they stay level (default); cage: as sweep, drawn through a "
             "lattice of nodes, which a program may move too",
             bend(settings));
  add.option(
      "--cell", "2|4|8|16",
      "the side of a cage's cells in voxels, of parts whose rig does not say (default 8; of skins: as large "
      "as the fit allows); at most 256 of them along a part",
      number(settings.cell));
  add.heading("Model");
  add.option("--scene", "NAME|INDEX",
             "glTF: the scene to bake, by name or by index from 0; a number in the range of indices is an "
             "index (default: the file's default scene)",
             text(settings.scene));
  add.option(
      "--fill", "auto|solid|surface",
      "what to fill; auto: closed components, small holes closed by fans; solid: all; surface: none",
      choice(
          settings.fill, "unknown; use auto, solid or surface",
          {{"auto", bake::Fill::kAuto}, {"solid", bake::Fill::kSolid}, {"surface", bake::Fill::kSurface}}));
  add.option("--parts", "one|nodes",
             "one: a single part, besides nodes that have their own rig; nodes: a part for every glTF node "
             "with a mesh, with its animations as clips, or for every .vox object",
             choice(settings.parts, "unknown; use one or nodes",
                    {{"one", bake::Parts::kOne}, {"nodes", bake::Parts::kNodes}}));
  add.flag("--keep-culled",
           "glTF: bake closed surfaces of one side too that are turned inside out around the rest, as "
           "outlines for toon shading and skies",
           settings.keep_culled);
  add.option("--at", "CLIP:SECONDS",
             "glTF: bake nodes, skins and morph targets at a moment of an animation, e.g. Walk:0.3",
             moment(settings.at));
  add.option("--frame", "N", "MagicaVoxel: the frame of the animation to bake, from 0 (default: the first)",
             number(settings.frame));
}

void addLookOptions(Adder& add, bake::Settings& settings, bool& no_distance) {
  add.heading("Colors");
  add.option("--palette", "FILE",
             "use only these colors: a GIMP palette (.gpl) or a picture of at most 256 colors",
             text(settings.palette_file));
  add.flag("--keep-materials", "give every material its own palette entries; --report names them",
           settings.keep_materials);
  add.heading("Volumes");
  add.option("--grid", "NAME|INDEX",
             "volumes: the grid to bake, by name or by index from 0 (default: density, or the only level set "
             "or fog volume)",
             text(settings.grid));
  add.option("--volume", "auto|solid|fog",
             "volumes; auto: solid for level sets, masks, and densities with --isovalue, fog for other "
             "densities; solid; fog",
             choice(settings.volume, "unknown; use auto, solid or fog",
                    {{"auto", bake::VolumeKind::kAuto},
                     {"solid", bake::VolumeKind::kSolid},
                     {"fog", bake::VolumeKind::kFog}}));
  add.option("--isovalue", "VALUE",
             "volumes: solid where a density is at least VALUE, or a level set at most VALUE (default: 0 for "
             "level sets, half the greatest value for densities)",
             number(settings.isovalue));
  add.option("--color-grid", "NAME|INDEX",
             "volumes: the vector grid with the colors of a solid (default: Cd or color)",
             text(settings.color_grid));
  add.option("--heat-grid", "NAME|INDEX|none",
             "volumes: the grid that makes fog glow (default: flame, flames, heat or temperature); none: no "
             "glow",
             [&settings](const std::string& given) {
               return settings.heat_grid = given == "none" ? "" : given, nullptr;
             });
  add.option("--density", "FACTOR", "volumes: multiplies the density of fog (default 1)",
             number(settings.density));
  add.option("--ramp", "FILE",
             "volumes: colors of glowing fog, cold to hot: a GIMP palette (.gpl) or a picture (default: a "
             "black body's)",
             text(settings.ramp_file));
  add.heading("Pack");
  add.option("--levels", "N", "levels of detail (default: as many as it takes to reach one brick)",
             countingNumber(settings.levels));
  add.flag("--no-distance",
           "leave out the exact distances, which games ask for collisions and shaders for soft shadows",
           no_distance);
  add.option("--effort", "fast|best",
             "how hard to try to make the pack small; best: a little smaller, the writing takes longer "
             "(default fast)",
             choice(settings.effort, "unknown; use fast or best",
                    {{"fast", Effort::kFast}, {"best", Effort::kBest}}));
}

// `write_deps`: -MD.
void addRunOptions(Adder& add, Options& options, bool& write_deps) {
  add.heading("Run");
  add.option("--threads", "N", "threads (default: all); the pack is the same with any number",
             countingNumber(options.settings.threads));
  add.option("--max-memory", "SIZE",
             "refuse a bake or a file that needs more memory, e.g. 4G (default: the machine's memory; for "
             "pictures 1G plus 256 bytes per byte of their files)",
             bytes(options.settings.max_memory));
  add.option("--max-import-time", "SECONDS",
             "refuse a file that takes longer to read, or whose bake stands still for longer (default 1800)",
             countingNumber(options.max_import_seconds));
  add.option("--progress", "auto|bar|json|none",
             "auto: a bar if stderr is a terminal; bar; json: each line on stderr is JSON (kelp-dump schema "
             "bake-progress); none",
             choice(options.progress, "unknown; use auto, bar, json or none",
                    {{"auto", ProgressStyle::kAuto},
                     {"bar", ProgressStyle::kBar},
                     {"json", ProgressStyle::kJson},
                     {"none", ProgressStyle::kNone}}));
  add.option("--report", "FILE", "write a report as JSON: what was baked and how long it took",
             text(options.report_file));
  add.heading("Make rules");
  add.flag("--write-deps", "write a make rule with all files that were read to OUT.d (also -MD)", write_deps);
  add.flag("--deps-phony",
           "add an empty rule for each of these files, so that make goes on when one is deleted (also -MP)",
           options.phony_deps);
  add.option("--deps-target", "NAME", "the target of the rule, unescaped (default: the output; also -MT)",
             text(options.deps_target));
  add.option("--deps-file", "FILE", "write the rule to FILE instead of OUT.d (also -MF)",
             text(options.dependency_file));
}

void check(const Options& options) {
  refuseGone(options.input.string(), {});
  const auto has_name = [](const char* option, const std::filesystem::path& file) {
    if (file == "-") misuse(std::string(option) + " -: is no file; kelp-bake needs one with a name");
  };
  has_name("input", options.input);
  has_name("-o", options.output);
  has_name("--report", options.report_file.value_or(""));
  has_name("-MF", options.dependency_file.value_or(""));
  for (const auto& [option, given] : {std::pair("--deps-phony", options.phony_deps),
                                      std::pair("--deps-target", options.deps_target.has_value())})
    if (given && !options.dependency_file)
      misuse(std::string(option) + ": there is no rule; add -MD or -MF FILE, or leave it out");
  if (options.settings.resolution_given && options.settings.voxel_size)
    misuse("--voxel-size: excludes --resolution; choose one");
  bake::checkSettings(options.settings);
}

namespace fs = std::filesystem;

// The place of a file that may not exist yet.
fs::path placeOf(const fs::path& path) {
  std::error_code error;
  const fs::path real = followLinks(path), place = fs::weakly_canonical(fs::absolute(real, error), error);
  return error ? real : place;
}

bool areSame(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::exists(a, error)) return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
  return placeOf(a) == placeOf(b);
}

}  // namespace

std::optional<Options> parseCommandLine(const std::vector<std::string>& words) {
  CLI::App app("Bakes a mesh or a volume into a voxel pack (.kelp) that bends in real time.", "kelp-bake");
  app.set_version_flag("--version", "");
  app.footer(kExamples);
  Options options;
  bool no_distance = false, write_deps = false;
  Adder add(app);
  add.option("input", "FILE",
             "glTF/GLB/VRM, OBJ, PLY, STL, OFF, Draco (.drc), VDB, NVDB, MagicaVoxel (.vox), .binvox or .raw "
             "file",
             text(options.input))
      ->required();
  add.option("-o,--output", "FILE",
             "the pack to write; an existing one is replaced when the new one is complete",
             text(options.output))
      ->required();
  addModelOptions(add, options.settings, options);
  addLookOptions(add, options.settings, no_distance);
  addRunOptions(add, options, write_deps);
  try {
    app.parse(wordsForCli11(words));
  } catch (const CLI::CallForHelp&) {
    writeStdout(app.help());
    return std::nullopt;
  } catch (const CLI::CallForVersion&) {
    writeStdout("kelp-bake " KELP_VERSION " (" KELP_BUILD ")\nBakes are " + describe(containmentOfKernel()) +
                ".\n");
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    refuseGone(options.input.string(), app.remaining());
    misuse(std::string(error.what()) + "; see kelp-bake --help");
  }
  options.settings.distance = !no_distance;
  if (write_deps && !options.dependency_file) options.dependency_file = options.output.string() + ".d";
  check(options);
  return options;
}

void checkClashes(const Options& options, const std::vector<fs::path>& read) {
  std::vector<fs::path> inputs = read;
  inputs.push_back(options.input);
  for (const auto& file :
       {options.settings.rig_file, options.settings.palette_file, options.settings.ramp_file})
    if (file) inputs.push_back(*file);
  std::vector<std::pair<std::string, fs::path>> outputs{{"-o", options.output}};
  if (options.report_file) outputs.emplace_back("--report", *options.report_file);
  if (options.dependency_file) outputs.emplace_back("-MF", *options.dependency_file);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string name = outputs[i].first + " " + outputs[i].second.string();
    for (const fs::path& input : inputs)
      if (areSame(outputs[i].second, input))
        throw ToolError(Exit::kUsage, name + ": would overwrite " + input.string() +
                                          ", which the bake reads; write to another name");
    for (std::size_t other = 0; other < i; ++other)
      if (areSame(outputs[i].second, outputs[other].second))
        throw ToolError(Exit::kUsage, name + ": is the same file as " + outputs[other].first +
                                          "; give each file a name of its own");
  }
}

}  // namespace kelp::bake_cli
