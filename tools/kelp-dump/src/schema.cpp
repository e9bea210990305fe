// SPDX-License-Identifier: MIT
#include "schemas.h"

#include <nlohmann/json.hpp>

#include "commands.h"
#include "text.h"

namespace kelp::dump {

int schema(const std::string& name) {
  if (name.empty()) print(kDumpSchema);
  else if (name == "rig") print(kRigSchema);
  else if (name == "bake-report") print(kReportSchema);
  else if (name == "bake-batch") print(kBatchSchema);
  else if (name == "bake-plan") print(kPlanSchema);
  else if (name == "bake-progress") print(kProgressSchema);
  else {
    auto json = nlohmann::ordered_json::parse(kDumpSchema);
    if (name != "info" && name != "verify" && name != "diff") throw DumpError(kUsage, "schema " + nameText(name, 40) + ": there is none of this name; choose info, verify, diff, rig, bake-report, bake-batch, bake-plan or bake-progress");
    // The same document, of which only this command's output is an instance.
    json.erase("oneOf");
    json["$id"] = json["$id"].get<std::string>() + "-" + name;
    json["$ref"] = "#/$defs/" + name;
    print(json.dump(2) + "\n");
  }
  return kOk;
}

}  // namespace kelp::dump
