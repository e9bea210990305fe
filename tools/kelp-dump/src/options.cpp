// SPDX-License-Identifier: MIT
#include "options.h"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "text.h"

namespace kelp::dump {
namespace {

constexpr const char* kCommands = "use info, verify, diff, rig, extract, slice or schema, see kelp-dump --help";
constexpr const char* kExits =
    "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack or rig, 4 failure at run time, 5 unsupported feature, 7 difference found, 130 interrupted.";

CLI::App* addCommand(CLI::App& app, const char* name, const char* what, const char* examples) {
  CLI::App* const command = app.add_subcommand(name, what);
  command->footer(std::string(examples) + "\n" + kExits);
  return command;
}

// What the sub-commands share: the pack, text or JSON, a part.
struct Shared {
  std::string path, format = "text", part;
  int level = 0;

  void addPack(CLI::App* command) { command->add_option("PACK", path, "the .kelp file; - reads standard input (at most 512 MiB)")->required(); }
  void addFormat(CLI::App* command) { command->add_option("--format", format, "for people or for programs (kelp-dump schema describes it)")->option_text("text|json [text]"); }
  void addPart(CLI::App* command, const char* otherwise) { command->add_option("--part", part, "name or index of the part")->option_text(std::string("NAME|INDEX [") + otherwise + "]"); }
  void addLevel(CLI::App* command) { command->add_option("--level", level, "level of detail: each has half of the voxels along a side")->option_text("N [0, the finest]"); }
  Format form() const {
    if (format != "text" && format != "json") throw DumpError(kUsage, "--format " + format + ": expected text or json; see kelp-dump --help");
    return format == "json" ? Format::kJson : Format::kText;
  }
};

struct ExtractOutputs {
  std::vector<std::pair<std::string, std::string>> files = {{"vox", ""}, {"vdb", ""}, {"nvdb", ""}, {"ply", ""}, {"slices", ""}};

  void add(CLI::App* command) {
    constexpr const char* kWhat[] = {"MagicaVoxel: colours by index, materials, one model a part", "OpenVDB: solid parts as level sets with their colours, fog as densities",
                                     "NanoVDB: the same", "a mesh of the visible voxel faces, in metres", "a folder of PNGs, one a layer of voxels"};
    for (std::size_t i = 0; i < files.size(); ++i) command->add_option("--" + files[i].first, files[i].second, kWhat[i])->option_text(files[i].first == "slices" ? "FOLDER" : "OUT");
  }
  int run(const CLI::App& command, const Shared& shared) const {
    const std::pair<std::string, std::string>* wanted = nullptr;
    for (const auto& file : files) {
      if (command.count("--" + file.first) == 0) continue;
      if (wanted) throw DumpError(kUsage, "--" + wanted->first + " and --" + file.first + ": one format at a time; see kelp-dump extract --help");
      wanted = &file;
    }
    if (!wanted) throw DumpError(kUsage, "extract: no format; name one with --vox, --vdb, --nvdb, --ply or --slices, see kelp-dump extract --help");
    return extract(shared.path, wanted->first, wanted->second, shared.part, shared.level);
  }
};

int runRig(const CLI::App& command, const Shared& shared, const std::string& axis, const std::string& new_rig, const std::string& output) {
  if (command.count("--set") > 0) return setRig(shared.path, shared.part, new_rig, axis, output);
  if (command.count("-o") > 0) throw DumpError(kUsage, "-o: the rig is printed to standard output; -o goes with --set, see kelp-dump rig --help");
  return rig(shared.path, shared.part, axis);
}

}  // namespace

int runCommandLine(const std::vector<std::string>& words) {
  CLI::App app("Says what is in a .kelp pack and whether it is sound, gives its voxels back and its rigs anew. Data goes to stdout, everything else to stderr.", "kelp-dump");
  app.set_version_flag("--version", "kelp-dump " KELP_VERSION " (" KELP_BUILD ", extract: " + extractFormats() + ")");
  app.require_subcommand(1);
  app.footer(
      std::string("Examples:\n"
                  "  kelp-dump info reed.kelp                     what it is, its parts, clips and colours, where the bytes go\n"
                  "  kelp-dump verify reed.kelp --deep            recompute empty boxes and levels and compare\n"
                  "  kelp-dump diff old.kelp new.kelp             which parts, voxels, colours, rigs and clips differ\n"
                  "  kelp-dump rig reed.kelp > reed.rig.json      the rig as kelp-bake --rig reads it\n"
                  "  kelp-dump rig reed.kelp --set reed.rig.json  and back into the pack, without baking\n"
                  "  kelp-dump extract reed.kelp --vox reed.vox   its voxels for MagicaVoxel; --vdb, --nvdb, --ply, --slices for others\n"
                  "  kelp-dump slice reed.kelp -o layer.png       a layer of voxels as a picture\n"
                  "  cat reed.kelp | kelp-dump info - --format json\n"
                  "\n"
                  "kelp-dump COMMAND --help says more. ") +
      kExits);

  Shared shared;
  bool deep = false, count = false;
  std::string other, axis, new_rig, output, schema_name, across = "y";
  double tolerance = 0;
  ExtractOutputs outputs;
  SliceOptions slicing;
  int at = 0;

  CLI::App* const info_command = addCommand(app, "info", "Print what is in a pack, on one screen; reads its header and tables alone",
                                            "Examples:\n  kelp-dump info reed.kelp\n  kelp-dump info reed.kelp --count              how many voxels are solid, what the colours are used for\n"
                                            "  kelp-dump info reed.kelp --format json | jq '.parts[].name'\n");
  shared.addPack(info_command);
  info_command->add_flag("--count", count, "also read all voxels and count them: bricks, solid and surface voxels, the use of each colour, what pages decode to");
  shared.addFormat(info_command);

  CLI::App* const verify_command = addCommand(app, "verify", "Check structure and checksums; list everything that is wrong",
                                              "Examples:\n  kelp-dump verify reed.kelp\n  kelp-dump verify reed.kelp --deep --format json\n  ssh farm cat reed.kelp | kelp-dump verify -\n");
  shared.addPack(verify_command);
  verify_command->add_flag("--deep", deep, "also recompute empty boxes, levels and surface from the voxels, and compare");
  shared.addFormat(verify_command);

  CLI::App* const diff_command = addCommand(app, "diff", "Say which parts, levels, voxels, colours, rigs and clips of two packs differ; compression and order do not matter",
                                            "Examples:\n  kelp-dump diff old.kelp new.kelp\n  kelp-dump diff old.kelp new.kelp --tolerance 0.01    colours a step or two apart, normals within 1.8 degrees\n"
                                            "  git show HEAD:reed.kelp | kelp-dump diff - reed.kelp --format json\n");
  diff_command->add_option("A", shared.path, "a .kelp file; - reads standard input (at most 512 MiB)")->required();
  diff_command->add_option("B", other, "another")->required();
  diff_command->add_option("--tolerance", tolerance, "how far numbers may be apart, as a share of their range: of white for colours, of a half turn for normals, of a part's length for knots and places, of themselves for times; voxels are there or not")
      ->option_text("SHARE [0; up to 1]");
  shared.addFormat(diff_command);

  CLI::App* const rig_command = addCommand(app, "rig", "Print the rig and clips of a part as rig JSON, or put others in their place",
                                           "Examples:\n  kelp-dump rig reed.kelp > reed.rig.json\n  kelp-dump rig reed.kelp --set reed.rig.json           reed.kelp is replaced, whole, once the new one is on the disk\n"
                                           "  kelp-dump rig fish.kelp --part tail --set swim -o swimming.kelp\n\n"
                                           "--set takes what kelp-bake --rig takes and refuses what it refuses. Voxels stay as they are, so the axis must be the one that the part was baked along.\n");
  shared.addPack(rig_command);
  shared.addPart(rig_command, "the first");
  rig_command->add_option("--axis", axis, "where the spline runs in the file that the rig is for; vectors are in that file's axes. With --set: of a preset, or of a rig that names none")->option_text("+x|-x|+y|-y|+z|-z [as baked; with --set, as kelp-bake]");
  rig_command->add_option("--set", new_rig, "give the part this rig, and its clips in place of those that move it")->option_text("FILE|PRESET");
  rig_command->add_option("-o,--output", output, "with --set: where the pack goes; - is standard output")->option_text("OUT [PACK itself]");

  CLI::App* const extract_command = addCommand(app, "extract", "Write the voxels of a pack in another program's format",
                                               "Examples:\n  kelp-dump extract reed.kelp --vox reed.vox\n  kelp-dump extract reed.kelp --ply - --level 2 > reed.ply\n  kelp-dump extract smoke.kelp --vdb smoke.vdb\n");
  shared.addPack(extract_command);
  outputs.add(extract_command);
  shared.addPart(extract_command, "all");
  shared.addLevel(extract_command);

  CLI::App* const slice_command = addCommand(app, "slice", "Write a picture of one layer of voxels",
                                             "Examples:\n  kelp-dump slice reed.kelp -o reed.png                       the middle layer across the spline: black where solid\n"
                                             "  kelp-dump slice reed.kelp -o reed.png --axis z --what clearance --scale 4\n  kelp-dump slice reed.kelp -o reed.png --what normals --at 12\n\n"
                                             "occupancy  dark at the surface, grey inside, white where empty; clearance  of empty voxels, 4 grey steps a voxel, the farther from solid the brighter; solid is orange;\n"
                                             "normals  (n + 1) / 2 as red, green, blue, grey inside; colour  as in the palette; density, heat  of fog, their codes. Where normals and colours have nothing, the\n"
                                             "picture is transparent. Across y: x to the right, z down; across z: x to the right, y up; across x: z to the right, y up.\n");
  shared.addPack(slice_command);
  slice_command->add_option("-o,--output", output, "the PNG; - is standard output")->required()->option_text("OUT.png REQUIRED");
  slice_command->add_option("--axis", across, "across the layer, in the part's axes; y runs along the spline")->option_text("x|y|z [y]");
  slice_command->add_option("--at", at, "which layer, from 0")->option_text("N [the middle one]");
  shared.addLevel(slice_command);
  shared.addPart(slice_command, "the first");
  slice_command->add_option("--what", slicing.what, "what to show")->option_text("occupancy|clearance|normals|colour|density|heat [occupancy; of fog, density]");
  slice_command->add_option("--scale", slicing.scale, "pixels along a voxel's side")->option_text("N [1; up to 64]");

  CLI::App* const schema_command = addCommand(app, "schema", "Print the JSON schema of what kelp's programs write and read",
                                              "Examples:\n  kelp-dump schema info > info.schema.json\n  kelp-dump schema rig > rig.schema.json              for an editor that completes and checks rigs\n");
  schema_command->add_option("NAME", schema_name, "info, verify, diff: what --format json prints; rig: what kelp-bake --rig reads; bake-report: what kelp-bake --report writes, of a batch bake-batch; bake-plan, bake-progress: --plan and --progress json")
      ->option_text("info|verify|diff|rig|bake-report|bake-batch|bake-plan|bake-progress [all of kelp-dump]");

  // CLI11 says of a sub-command that does not exist only that one is missing.
  const std::string first = words.size() > 1 ? words[1] : "";
  const bool is_option = first.rfind('-', 0) == 0;
  if (words.size() > 1 && !is_option && app.get_subcommands([&](const CLI::App* command) { return command->get_name() == first; }).empty())
    throw DumpError(kUsage, nameText(first, 40) + ": not a sub-command; " + kCommands);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));  // CLI11 takes the last first
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      std::ostringstream text;
      app.exit(error, text);
      print(text.str());
      return kOk;
    }
    if (words.size() <= 1) throw DumpError(kUsage, std::string("no sub-command; ") + kCommands);
    if (is_option) throw DumpError(kUsage, nameText(first, 40) + ": no option of kelp-dump itself, which begins with a sub-command; " + kCommands);
    // What is missing may be missing because of what is there and is not known.
    const std::vector<std::string> unknown = app.remaining(true);
    throw DumpError(kUsage, (unknown.empty() ? std::string(error.what()) : nameText(unknown.front()) + ": is not expected here") + "; see kelp-dump " + first + " --help");
  }
  for (const CLI::App* command : app.get_subcommands())
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results())
        if (value.empty()) throw DumpError(kUsage, option->get_name() + ": is empty; give a value, or leave it out; see kelp-dump " + first + " --help");
  if (info_command->parsed()) return info(shared.path, count, shared.form());
  if (verify_command->parsed()) return verify(shared.path, deep, shared.form());
  if (diff_command->parsed()) return diff(shared.path, other, tolerance, shared.form());
  if (rig_command->parsed()) return runRig(*rig_command, shared, axis, new_rig, output);
  if (extract_command->parsed()) return outputs.run(*extract_command, shared);
  if (schema_command->parsed()) return schema(schema_name);
  if (across != "x" && across != "y" && across != "z") throw DumpError(kUsage, "--axis " + across + ": expected x, y or z; see kelp-dump slice --help");
  slicing.axis = across[0];
  slicing.part = shared.part;
  slicing.level = shared.level;
  if (slice_command->count("--at") > 0) slicing.at = at;
  return slice(shared.path, slicing, output);
}

}  // namespace kelp::dump
