// SPDX-License-Identifier: MIT
#pragma once

#include "cli/json_places.h"
#include "cli/option_table.h"

namespace kelp::bake_cli {

// Converts a JSON member named like an option to its value, as on the command line. File names are relative
// to `folder`. `of_run_too`: also accept options of the run. Throws ToolError with the place for an unknown
// option or a value of the wrong type.
Value optionOf(const JsonValue::Member& member, const std::filesystem::path& folder, bool of_run_too);

// Whether this value of the option is a file name.
bool namesFile(const OptionInfo& option, const std::string& text);

// Throws ToolError with the place if a value has the wrong type. `wanted`: "the name of a file".
void expectKind(const JsonValue& value, JsonValue::Kind kind, const std::string& name, const char* wanted);

}  // namespace kelp::bake_cli
