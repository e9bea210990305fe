// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The command line and the one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "commands.h"

namespace {

using namespace kelp::dump;

int run(int argc, char** argv) {
  CLI::App app("Says what is in a .kelp pack and whether it is sound, and gives its voxels back. Data goes to stdout, everything else to stderr.", "kelp-dump");
  app.set_version_flag("--version", "kelp-dump " KELP_VERSION " (extract: " + extractFormats() + ")");
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  kelp-dump info reed.kelp                     what it is, its parts, clips and colours, where the bytes go\n"
      "  kelp-dump info reed.kelp --format json       the same for programs (kelp-dump.schema.json)\n"
      "  kelp-dump verify reed.kelp --deep            recompute empty boxes and levels and compare\n"
      "  kelp-dump rig reed.kelp > reed.rig.json      the rig as kelp-bake --rig reads it\n"
      "  kelp-dump extract reed.kelp --vox reed.vox   its voxels for MagicaVoxel; --vdb, --nvdb, --ply, --slices for others\n"
      "\n"
      "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack, 4 failure at run time, 5 unsupported feature.");

  std::string path, part, axis = "+y";
  std::string format_name = "text";
  bool deep = false;
  int level = 0;
  const auto addPack = [&](CLI::App* command) { command->add_option("PACK", path, "the .kelp file")->required(); };
  const auto addFormat = [&](CLI::App* command) {
    command->add_option("--format", format_name, "text or json")->option_text("text|json [text]");
  };
  CLI::App* const info_command = app.add_subcommand("info", "Print what is in a pack, on one screen");
  addPack(info_command);
  addFormat(info_command);
  CLI::App* const verify_command = app.add_subcommand("verify", "Check structure and checksums; list everything that is wrong");
  addPack(verify_command);
  verify_command->add_flag("--deep", deep, "also recompute empty boxes, levels and surface from the voxels, and compare");
  addFormat(verify_command);
  CLI::App* const rig_command = app.add_subcommand("rig", "Print the rig and clips of a part as rig JSON");
  addPack(rig_command);
  rig_command->add_option("--part", part, "name or index of the part")->option_text("NAME|INDEX [the first]");
  rig_command->add_option("--axis", axis, "where the spline runs in the file that the rig is for; vectors are in that file's axes")->option_text("+x|-x|+y|-y|+z|-z [+y]");
  CLI::App* const extract_command = app.add_subcommand("extract", "Write the voxels of a pack in another program's format");
  addPack(extract_command);
  std::vector<std::pair<std::string, std::string>> outputs = {{"vox", ""}, {"vdb", ""}, {"nvdb", ""}, {"ply", ""}, {"slices", ""}};
  constexpr const char* kWhat[] = {"MagicaVoxel: colours by index, materials, one model a part", "OpenVDB: solid parts as level sets with their colours, fog as densities",
                                   "NanoVDB: the same", "a mesh of the visible voxel faces, in metres", "a folder of PNGs, one a layer of voxels"};
  for (std::size_t i = 0; i < outputs.size(); ++i)
    extract_command->add_option("--" + outputs[i].first, outputs[i].second, kWhat[i])->option_text(outputs[i].first == "slices" ? "FOLDER" : "OUT");
  extract_command->add_option("--part", part, "name or index of the part")->option_text("NAME|INDEX [all]");
  extract_command->add_option("--level", level, "level of detail: each has half of the voxels along a side")->option_text("N [0, the finest]");

  // CLI11 says of a sub-command that does not exist only that one is missing.
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands([&](const CLI::App* command) { return command->get_name() == argv[1]; }).empty()) {
    throw DumpError(kUsage, std::string(argv[1]) + ": not a sub-command; use info, verify, rig or extract, see kelp-dump --help");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc == 1) throw DumpError(kUsage, "no sub-command; use info, verify, rig or extract, see kelp-dump --help");
    throw DumpError(kUsage, std::string(error.what()) + "; see kelp-dump --help");
  }
  if (format_name != "text" && format_name != "json") throw DumpError(kUsage, "--format " + format_name + ": expected text or json; see kelp-dump --help");
  const Format format = format_name == "json" ? Format::kJson : Format::kText;
  if (info_command->parsed()) return info(path, format);
  if (verify_command->parsed()) return verify(path, deep, format);
  if (rig_command->parsed()) return rig(path, part, axis);
  std::string wanted, output;
  for (const auto& [name, file] : outputs) {
    if (extract_command->count("--" + name) == 0) continue;
    if (!wanted.empty()) throw DumpError(kUsage, "--" + wanted + " and --" + name + ": one format at a time; see kelp-dump extract --help");
    wanted = name;
    output = file;
  }
  if (wanted.empty()) throw DumpError(kUsage, "extract: no format; name one with --vox, --vdb, --nvdb, --ply or --slices, see kelp-dump extract --help");
  if (output.empty()) throw DumpError(kUsage, "--" + wanted + ": no name for the output; see kelp-dump extract --help");
  return extract(path, wanted, output, part, level);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const DumpError& error) {
    std::fprintf(stderr, "kelp-dump: %s\n", error.what());
    return error.exit;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "kelp-dump: out of memory; close other programs or use a machine with more memory\n");
    return kFailure;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kelp-dump: unexpected failure (%s); please report this as a fault of kelp-dump\n", error.what());
    return kFailure;
  }
}
