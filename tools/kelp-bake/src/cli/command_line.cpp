// SPDX-License-Identifier: MIT
#include "cli/command_line.h"

#include <algorithm>
#include <charconv>
#include <list>

#include <CLI/CLI.hpp>

#include "cli/config_file.h"
#include "cli/json_places.h"
#include "cli/option_table.h"
#include "cli/summary.h"
#include "contained/sandbox.h"

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
  kelp-bake reed.glb -o reed.kelp -MD --cache ~/.cache/kelp
                                                      in a build: writes a rule, bakes nothing twice
  kelp-bake --manifest assets.json --report done.json
                                                      many assets; skips packs that are up to date
  kelp-bake --manifest assets.json --shard 2/4        the second of four machines
  kelp-bake @models.txt -o packs --resolution 64      the files that a text file lists, one per line
  kelp-bake --print-config > all.toml                 all options, for kelp-bake --config all.toml

The rig comes from --rig, or else from STEM.rig.json beside the input, from a glTF node's extras.kelp, from
empties named knot.0, knot.1, ... under a mesh, or from skins that animations move. Without a rig the part is
straight.

Exit codes: 0 done, 1 usage, 2 files, 3 invalid input, 4 failure at run time (memory, time, a
crash, a forbidden call), 5 unsupported feature, 130 interrupted. A batch continues after a bad asset and
exits with the highest code of all.

Ctrl-C stops after the current step, a second Ctrl-C at once. An existing output stays as it was.)";

// The compilers' spelling: a single dash and two letters, which CLI11 would take apart. CLI11 takes the last
// first.
std::vector<std::string> reversed(std::vector<std::string> arguments) {
  for (std::string& argument : arguments) {
    for (const auto& [brief, full] : {std::pair("-MD", "--write-deps"), std::pair("-MF", "--deps-file"),
                                      std::pair("-MP", "--deps-phony"), std::pair("-MT", "--deps-target")})
      if (argument == brief) argument = full;
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

// CLI11 holds pointers to where values go.
class SharedOptions {
 public:
  SharedOptions(CLI::App& app, bool of_run_too) {
    add("input", app.add_option("input", texts_.emplace_back(),
                                "glTF/GLB, OBJ, PLY, STL, OFF, Draco (.drc), VDB, NVDB, MagicaVoxel (.vox), "
                                ".binvox or .raw file; or @LIST, a text file with one input per line")
                     ->type_name("FILE"));
    add("output", app.add_option("-o,--output", texts_.emplace_back(),
                                 "the pack to write; an existing one is replaced when the new one is "
                                 "complete. Of a batch: the folder for its packs")
                      ->type_name("FILE"));
    for (const OptionInfo& option : optionTable()) {
      if (option.scope == OptionScope::kRun && !of_run_too) continue;
      const std::string name = std::string("--") + option.name;
      if (option.type == OptionType::kFlag) {
        flags_.push_back(
            {option.name, app.add_flag(name, flag_values_.emplace_back(), option.help)->group(option.group)});
      } else {
        add(option.name, app.add_option(name, texts_.emplace_back(), option.help)
                             ->type_name(option.metavar)
                             ->group(option.group));
      }
    }
  }
  SharedOptions(const SharedOptions&) = delete;
  SharedOptions& operator=(const SharedOptions&) = delete;

  Values given(const Place& place) const {
    Values values;
    auto text = texts_.begin();
    for (const auto& [name, option] : options_) {
      if (option->count() > 0) values[name] = {*text, place};
      ++text;
    }
    auto flag = flag_values_.begin();
    for (const auto& [name, option] : flags_) {
      if (option->count() > 0) values[name] = {*flag ? "true" : "false", place};
      ++flag;
    }
    return values;
  }

 private:
  void add(const std::string& name, CLI::Option* option) { options_.push_back({name, option}); }

  std::vector<std::pair<std::string, CLI::Option*>> options_, flags_;
  std::list<std::string> texts_;
  std::list<bool> flag_values_;
};

[[noreturn]] void misuse(const std::string& what) { throw ToolError(Exit::kUsage, what); }

Shard parseShard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  const bool divided = first == std::errc() && slash != end && *slash == '/';
  const auto [rest, second] = divided ? std::from_chars(slash + 1, end, shard.count)
                                      : std::from_chars_result{slash, std::errc::invalid_argument};
  constexpr unsigned kMost = 100000;
  if (second != std::errc() || rest != end || shard.index < 1 || shard.index > shard.count ||
      shard.count > kMost)
    misuse("--shard " + text +
           ": is not a share; give I/N with I from 1 to N, such as 1/4 for the first of four");
  return shard;
}

// Options that cannot be used together, and missing ones.
void checkCommand(const Command& command) {
  const auto given = [&](const char* name) { return command.options.count(name) > 0; };
  if (command.print_config) {
    if (command.plan)
      misuse("--print-config and --plan cannot be used together: both write to stdout; choose one");
    return;
  }
  if (command.isBatch()) {
    if (command.manifest && (given("input") || command.list))
      misuse(
          "--manifest and an input cannot be used together; add the input to the manifest, or bake it alone");
    if (given("deps-target") || command.config.count("deps-target") > 0)
      misuse(
          "-MT cannot be used with a batch, because each pack has its own rule; leave it out, or set "
          "\"deps-target\" for an asset");
    if (given("deps-file") || command.config.count("deps-file") > 0)
      misuse(
          "-MF cannot be used with a batch, because each pack has its own rule; use -MD, which writes "
          "OUT.d for each, or set \"deps-file\" for an asset");
    if (command.plan && given("report"))
      misuse("--plan and --report cannot be used together: a plan bakes nothing; leave one out");
    if (command.plan && command.force)
      misuse("--plan and --force cannot be used together: a plan lists all assets anyway; leave --force out");
    return;
  }
  for (const auto& [name, is_given] :
       {std::pair("--shard", command.shard.has_value()), std::pair("--plan", command.plan),
        std::pair("--force", command.force)})
    if (is_given)
      misuse(std::string(name) + " is only for batches; give --manifest FILE or @LIST, or leave it out");
  const auto isDash = [&](const char* name) {
    return given(name) && command.options.find(name)->second.text == "-";
  };
  if (isDash("input"))
    misuse(
        "-: the input cannot be standard input, because its name tells the format; write it to a file first");
  if (isDash("output"))
    misuse(
        "-o -: a pack cannot be written to standard output, because it replaces a file when it is complete; "
        "name a file");
  for (const char* name : {"report", "deps-file"})
    if (isDash(name)) misuse(std::string("--") + name + " -: is not a file; name one, or /dev/stdout");
  if (!given("input"))
    misuse("input is required: give a file to bake, @LIST, or --manifest FILE; see kelp-bake --help");
  if (!given("output"))
    misuse("-o is required: name the pack to write, such as -o model.kelp; see kelp-bake --help");
}

}  // namespace

std::optional<Command> parseCommandLine(const std::vector<std::string>& words) {
  CLI::App app("Bakes a mesh or a volume into a voxel pack (.kelp) that bends in real time.", "kelp-bake");
  app.set_version_flag("--version", "");
  app.footer(kExamples);
  const SharedOptions shared(app, true);
  Command command;
  std::string manifest, shard, config;
  CLI::Option* const manifest_option =
      app.add_option("--manifest", manifest, "bake the assets that a JSON file lists")
          ->type_name("FILE")
          ->group("Batches");
  CLI::Option* const shard_option =
      app.add_option("--shard", shard,
                     "of a batch, bake only the I-th of N shares; each asset is in one share")
          ->type_name("I/N")
          ->group("Batches");
  CLI::Option* const config_option =
      app.add_option("--config", config,
                     "read options from a file; the command line and manifests override it")
          ->type_name("FILE")
          ->group("Configuration");
  app.add_flag("--print-config", command.print_config,
               "bake nothing; write every option with its meaning to stdout, in the form --config reads")
      ->group("Configuration");
  app.add_flag("--plan", command.plan,
               "of a batch, bake nothing; write what would be baked to stdout, as JSON")
      ->group("Batches");
  app.add_flag("--force", command.force, "of a batch, also bake packs that are up to date")->group("Batches");
  try {
    app.parse(reversed({words.begin() + 1, words.end()}));
  } catch (const CLI::CallForHelp&) {
    writeStdout(app.help());
    return std::nullopt;
  } catch (const CLI::CallForVersion&) {
    writeStdout("kelp-bake " KELP_VERSION " (" KELP_BUILD ")\nBakes are " + describe(containmentOfKernel()) +
                ".\n");
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    misuse(std::string(error.what()) + "; see kelp-bake --help");
  }
  command.options = shared.given({});
  for (const auto& [name, value] : command.options)
    if (value.text.empty())
      misuse((name == "input" ? name : "--" + name) + ": is empty; give a value, or leave it out");
  if (manifest_option->count() > 0) command.manifest = manifest;
  if (command.manifest && manifest.empty()) misuse("--manifest: is empty; name a file");
  if (config_option->count() > 0) {
    if (config.empty()) misuse("--config: is empty; name a file");
    command.config = readConfig(config);
    if (!isStream(config)) command.option_files.push_back(config);
  }
  if (shard_option->count() > 0) command.shard = parseShard(shard);
  if (const auto input = command.options.find("input");
      input != command.options.end() && input->second.text.front() == '@') {
    command.list = input->second.text.substr(1);
    if (command.list->empty()) misuse("@: has no file name; give @FILE");
    command.options.erase(input);
  }
  checkCommand(command);
  return command;
}

Values parseAssetLine(const std::vector<std::string>& words, const Place& place) {
  CLI::App app;
  app.set_help_flag();
  const SharedOptions shared(app, false);
  try {
    app.parse(reversed(words));
  } catch (const CLI::ParseError& error) {
    throw faultAt(place, std::string(error.what()) +
                             "; each line is an input and its options; put names with spaces in quotes");
  }
  return shared.given(place);
}

}  // namespace kelp::bake_cli
