// SPDX-License-Identifier: MIT
#pragma once

#include "cli/json_places.h"
#include "cli/option_table.h"

namespace kelp::bake_cli {

// The value of an option, as the command line would have it, from a member of its name in a file; names of
// files are relative to `folder`. `of_run_too`: options of the whole run may stand there. ToolError with the
// place for what is no option, or not of its kind.
Value optionOf(const JsonValue::Member& member, const std::filesystem::path& folder, bool of_run_too);

// Whether this value of the option is the name of a file.
bool namesFile(const OptionInfo& option, const std::string& text);

// ToolError with the place if a value is not of a kind. `wanted`: "the name of a file".
void expectKind(const JsonValue& value, JsonValue::Kind kind, const std::string& name, const char* wanted);

}  // namespace kelp::bake_cli
