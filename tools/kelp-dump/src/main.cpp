// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The command line and the one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <map>
#include <new>

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
      "  kelp-dump verify reed.kelp --deep            recompute clearance and levels and compare\n"
      "  kelp-dump rig reed.kelp > reed.rig.json      the rig as kelp-bake --rig reads it\n"
      "\n"
      "Exit codes: 0 ok, 1 usage, 2 input/output, 3 invalid pack, 4 failure at run time, 5 unsupported feature.");

  std::string path, part;
  Format format = Format::kText;
  bool deep = false;
  const std::map<std::string, Format> formats{{"text", Format::kText}, {"json", Format::kJson}};
  const auto addPack = [&](CLI::App* command) { command->add_option("PACK", path, "the .kelp file")->required(); };
  const auto addFormat = [&](CLI::App* command) {
    command->add_option("--format", format, "text or json")->transform(CLI::Transformer(formats))->option_text("text|json [text]");
  };
  CLI::App* const info_command = app.add_subcommand("info", "Print what is in a pack, on one screen");
  addPack(info_command);
  addFormat(info_command);
  CLI::App* const verify_command = app.add_subcommand("verify", "Check structure and checksums; list everything that is wrong");
  addPack(verify_command);
  verify_command->add_flag("--deep", deep, "also recompute clearance, levels and surface from the voxels, and compare");
  addFormat(verify_command);
  CLI::App* const rig_command = app.add_subcommand("rig", "Print the rig and clips of a part as rig JSON");
  addPack(rig_command);
  rig_command->add_option("--part", part, "name or index of the part")->option_text("NAME|INDEX [the first]");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "kelp-dump: %s; see kelp-dump --help\n", error.what());
    return kUsage;
  }
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
