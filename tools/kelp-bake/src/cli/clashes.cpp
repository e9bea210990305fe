// SPDX-License-Identifier: MIT
#include "cli/clashes.h"

#include <string>
#include <system_error>

#include "kelp/common/links.h"

namespace kelp::bake_cli {
namespace {

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
