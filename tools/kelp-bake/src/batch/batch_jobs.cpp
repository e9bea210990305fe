// SPDX-License-Identifier: MIT
#include "batch/batch_jobs.h"

#include <system_error>

#include "batch/shard.h"
#include "cli/clashes.h"

namespace kelp::bake_cli {
namespace {

namespace fs = std::filesystem;

// What is the batch's own and no asset's.
Values optionsOfAssets(Values values) {
  for (const char* own : {"output", "report"}) values.erase(own);
  return values;
}

bool checkFiles(const Options& options, const Values& values, Faults& faults) {
  bool all_there = true;
  const auto check = [&](const fs::path& file, const char* name) {
    std::error_code error;
    const std::string what =
        std::string(name) == "rig"
            ? ": no such file, nor a preset of that name; check the name, or see kelp-bake --help for presets"
            : ": no such file; check the name";
    if (fs::exists(file, error)) return;
    all_there = false;
    faults.add({Exit::kIo, values.find(name)->second.place.prefix() + file.string() + what});
  };
  check(options.input, "input");
  if (options.settings.rig_file) check(*options.settings.rig_file, "rig");
  if (options.settings.palette_file) check(*options.settings.palette_file, "palette");
  if (options.settings.ramp_file) check(*options.settings.ramp_file, "ramp");
  return all_there;
}

}  // namespace

Jobs prepareJobs(const Command& command) {
  const Values run = overlay(command.config, command.options);
  const auto given = [&](const char* name) {
    const auto found = run.find(name);
    return found == run.end() ? fs::path() : fs::path(found->second.text);
  };
  Faults faults;
  AssetList list = command.manifest ? readManifest(*command.manifest, given("output"), faults)
                                    : readList(*command.list, given("output"), faults);
  const Values under = optionsOfAssets(command.config), over = optionsOfAssets(command.options);
  std::vector<fs::path> option_files = command.option_files;
  option_files.insert(option_files.end(), list.files.begin(), list.files.end());

  Jobs out;
  out.all = list.assets.size();
  if (!given("report").empty()) out.report_file = given("report");
  FileRoles roles;
  if (out.report_file) roles.addWritten(*out.report_file, "--report", {});
  if (!given("cache").empty()) roles.addFolder(given("cache"), "--cache");
  std::vector<Job> jobs;
  for (Asset& asset : list.assets) {
    faults.keep([&] {
      asset.values = overlay(overlay(under, asset.values), over);
      Options options = readOptions(asset.values, faults);
      options.option_files = option_files;
      const bool there = checkFiles(options, asset.values, faults);
      addRoles(roles, options, {}, asset.values["output"].place);
      if (there) jobs.push_back({std::move(asset), std::move(options)});
    });
  }
  faults.throwIfAny();

  std::vector<Options> options;
  options.reserve(jobs.size());
  for (const Job& job : jobs) options.push_back(job.options);
  out.indices = chooseShard(options, command.shard.value_or(Shard{}));
  for (const std::size_t index : out.indices) out.jobs.push_back(std::move(jobs[index]));
  return out;
}

}  // namespace kelp::bake_cli
