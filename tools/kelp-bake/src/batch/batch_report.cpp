// SPDX-License-Identifier: MIT
#include "batch/batch_report.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "cli/option_table.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"

namespace kelp::bake_cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string print(const OrderedJson& json) {
  return console::escapeControls(json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
}

OrderedJson headJson(const char* schema, const Command& command, const Jobs& jobs) {
  OrderedJson json{{"schema", schema},
                   {"kelp-bake", KELP_VERSION},
                   {"batch", (command.manifest ? *command.manifest : *command.list).string()}};
  json["shard"] = command.shard
                      ? OrderedJson{{"index", command.shard->index}, {"count", command.shard->count}}
                      : OrderedJson();
  json["all_assets"] = jobs.all;
  return json;
}

// A name that begins with what means something else on a command line.
std::string asArgument(const std::string& file) {
  return !file.empty() && (file[0] == '-' || file[0] == '@') ? "./" + file : file;
}

// The command line that bakes this asset alone, without options of the run.
OrderedJson argumentsOf(const Job& job) {
  const Values& values = job.asset.values;
  OrderedJson arguments = {asArgument(job.options.input.string()), "-o",
                           asArgument(job.options.output.string())};
  for (const OptionInfo& option : optionTable()) {
    const auto value = values.find(option.name);
    if (option.scope == OptionScope::kRun || value == values.end()) continue;
    if (option.type != OptionType::kFlag) {
      arguments.push_back(std::string("--") + option.name + "=" + value->second.text);
    } else if (value->second.text == "true") {
      arguments.push_back(std::string("--") + option.name);
    }
  }
  return arguments;
}

// What is known before the input is read.
OrderedJson filesOf(const Options& options) {
  OrderedJson files = {options.input.string()};
  for (const auto& file :
       {options.settings.rig_file, options.settings.palette_file, options.settings.ramp_file})
    if (file) files.push_back(file->string());
  return files;
}

}  // namespace

const char* toString(Status status) {
  constexpr const char* kNames[] = {"pending", "baked", "cached", "current", "failed"};
  return kNames[static_cast<int>(status)];
}

std::size_t BatchResult::count(Status status) const {
  return static_cast<std::size_t>(std::count_if(
      assets.begin(), assets.end(), [&](const AssetResult& asset) { return asset.status == status; }));
}

std::string planJson(const Command& command, const Jobs& jobs) {
  OrderedJson json = headJson("kelp-bake-plan/1", command, jobs);
  json["assets"] = OrderedJson::array();
  for (std::size_t i = 0; i < jobs.jobs.size(); ++i) {
    const Job& job = jobs.jobs[i];
    json["assets"].push_back({{"index", jobs.indices[i]},
                              {"input", job.options.input.string()},
                              {"output", job.options.output.string()},
                              {"files", filesOf(job.options)},
                              {"arguments", argumentsOf(job)}});
  }
  return print(json);
}

void writeBatchReport(const std::filesystem::path& path, const Command& command, const Jobs& jobs,
                      const BatchResult& result) {
  OrderedJson json = headJson("kelp-bake-batch/1", command, jobs);
  json["assets"] = OrderedJson::array();
  for (std::size_t i = 0; i < jobs.jobs.size(); ++i) {
    const AssetResult& asset = result.assets[i];
    json["assets"].push_back({{"index", jobs.indices[i]},
                              {"input", jobs.jobs[i].options.input.string()},
                              {"output", jobs.jobs[i].options.output.string()},
                              {"status", toString(asset.status)},
                              {"exit", static_cast<int>(asset.exit)},
                              {"error", asset.error.empty() ? OrderedJson() : OrderedJson(asset.error)},
                              {"notices", asset.notices},
                              {"pack_bytes", asset.pack_bytes},
                              {"seconds", asset.seconds}});
  }
  for (const Status status :
       {Status::kBaked, Status::kCached, Status::kCurrent, Status::kFailed, Status::kPending})
    json["counts"][toString(status)] = result.count(status);
  json["exit"] = static_cast<int>(result.exit);
  json["seconds"] = result.seconds;
  writeTextFile(path, print(json));
}

}  // namespace kelp::bake_cli
