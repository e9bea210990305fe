// SPDX-License-Identifier: MIT
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "text/text.h"

namespace kelp::dump {
namespace {

// The schema of kelp-dump's JSON, reduced to what one command prints.
std::string schemaOfCommand(const std::string& name) {
  auto json = nlohmann::ordered_json::parse(kDumpSchema);
  json.erase("oneOf");
  json["$id"] = json["$id"].get<std::string>() + "-" + name;
  json["$ref"] = "#/$defs/" + name;
  return json.dump(2) + "\n";
}

std::string schemaNamed(const std::string& name) {
  if (name.empty()) return kDumpSchema;
  if (name == "rig") return kRigSchema;
  if (name == "bake-report") return kReportSchema;
  if (name == "bake-progress") return kProgressSchema;
  if (name == "info" || name == "verify" || name == "diff") return schemaOfCommand(name);
  throw ToolError(Exit::kUsage, "schema " + nameText(name, 40) +
                                    ": there is no schema of this name; choose info, verify, diff, rig, "
                                    "bake-report or bake-progress");
}

}  // namespace

Command addSchema(CLI::App& app) {
  const auto name = std::make_shared<std::string>();
  CLI::App* const command = addCommand(
      app, "schema", "Print the JSON schema of what kelp's programs write and read",
      "  kelp-dump schema info > info.schema.json\n"
      "  kelp-dump schema rig > rig.schema.json              for an editor that completes and checks "
      "rigs\n");
  command
      ->add_option("NAME", *name,
                   "info, verify, diff: what --format json prints; rig: what kelp-bake --rig reads; "
                   "bake-report, bake-progress: what kelp-bake --report and --progress json write")
      ->option_text("info|verify|diff|rig|bake-report|bake-progress [all of kelp-dump]");
  return {command, [name] {
            print(schemaNamed(*name));
            return Exit::kOk;
          }};
}

}  // namespace kelp::dump
