// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The command line and the one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include <CLI/CLI.hpp>

#include "commands.h"

namespace {

using namespace kelp::dump;

int run(int argc, char** argv) {
  CLI::App app("Says what is in a .kelp pack and whether it is sound. Data goes to stdout, everything else to stderr.", "kelp-dump");
  app.set_version_flag("--version", "kelp-dump " KELP_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  kelp-dump info reed.kelp                     what it is, its parts, clips and colours, where the bytes go\n"
      "  kelp-dump info reed.kelp --format json       the same for programs (kelp-dump.schema.json)\n"
      "  kelp-dump verify reed.kelp --deep            recompute empty boxes and levels and compare\n"
      "  kelp-dump rig reed.kelp > reed.rig.json      the rig as kelp-bake --rig reads it\n"
      "\n"
      "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack, 4 failure at run time, 5 unsupported feature.");

  std::string path, part;
  std::string format_name = "text";
  bool deep = false;
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

  // CLI11 says of a sub-command that does not exist only that one is missing.
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands([&](const CLI::App* command) { return command->get_name() == argv[1]; }).empty()) {
    throw DumpError(kUsage, std::string(argv[1]) + ": not a sub-command; use info, verify or rig, see kelp-dump --help");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc == 1) throw DumpError(kUsage, "no sub-command; use info, verify or rig, see kelp-dump --help");
    throw DumpError(kUsage, std::string(error.what()) + "; see kelp-dump --help");
  }
  if (format_name != "text" && format_name != "json") throw DumpError(kUsage, "--format " + format_name + ": expected text or json; see kelp-dump --help");
  const Format format = format_name == "json" ? Format::kJson : Format::kText;
  if (info_command->parsed()) return info(path, format);
  if (verify_command->parsed()) return verify(path, deep, format);
  return rig(path, part);
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
