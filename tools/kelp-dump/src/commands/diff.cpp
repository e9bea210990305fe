// SPDX-License-Identifier: MIT
#include "diff/diff.h"

#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "pack/pack_file.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

struct DiffOptions {
  std::string a, b, format = "text";
  double tolerance = 0;
};

Exit runDiff(const DiffOptions& options) {
  const bool json = isJson(options.format);
  if (!(options.tolerance >= 0 && options.tolerance <= 1))
    throw ToolError(
        Exit::kUsage,
        fmt::format("--tolerance {}: expected a share of the full range, 0 to 1; see kelp-dump diff --help",
                    options.tolerance));
  PackFile a(options.a), b(options.b);
  const DiffReport report = compare(a, b, options.tolerance);
  print(json ? diffJson(report) : diffText(report));
  return report.same() ? Exit::kOk : Exit::kDifference;
}

}  // namespace

Command addDiff(CLI::App& app) {
  const auto options = std::make_shared<DiffOptions>();
  CLI::App* const command =
      addCommand(app, "diff",
                 "Say which parts, levels, voxels, colors, rigs and clips of two packs differ; compression "
                 "and order do "
                 "not matter",
                 "  kelp-dump diff old.kelp new.kelp\n"
                 "  kelp-dump diff old.kelp new.kelp --tolerance 0.01    colors a step or two apart, "
                 "normals within 1.8 "
                 "degrees\n");
  command->add_option("A", options->a, "a .kelp file")->required();
  command->add_option("B", options->b, "another")->required();
  command
      ->add_option(
          "--tolerance", options->tolerance,
          "how far apart numbers may be, as a share of their range. The range of a color is white, of "
          "a normal half a turn, of knots and places the part's length, of times the time itself. "
          "Which voxels are solid has no tolerance")
      ->option_text("SHARE [0; up to 1]");
  addFormat(command, options->format);
  return {command, [options] { return runDiff(*options); }};
}

}  // namespace kelp::dump
