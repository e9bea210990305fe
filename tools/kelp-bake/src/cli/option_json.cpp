// SPDX-License-Identifier: MIT
#include "cli/option_json.h"

#include <algorithm>

#include "kelp/import/core/outer_rig.h"

namespace kelp::bake_cli {
namespace {

void expectType(const JsonValue& value, OptionType type, const std::string& name) {
  using Kind = JsonValue::Kind;
  switch (type) {
    case OptionType::kText:
      return expectKind(value, Kind::kString, name, "a text");
    case OptionType::kNumber:
      return expectKind(value, Kind::kNumber, name, "a number");
    case OptionType::kFlag:
      return expectKind(value, Kind::kBool, name, "true or false");
    case OptionType::kTextOrNumber:
      if (value.kind != Kind::kNumber) expectKind(value, Kind::kString, name, "a text or a number");
  }
}

}  // namespace

bool namesFile(const OptionInfo& option, const std::string& text) {
  if (option.path != OptionPath::kFileOrPreset) return option.path == OptionPath::kFile;
  const std::vector<std::string> names = bake::rigNames();
  return std::find(names.begin(), names.end(), text) == names.end();
}

void expectKind(const JsonValue& value, JsonValue::Kind kind, const std::string& name, const char* wanted) {
  if (value.kind != kind)
    throw faultAt(value.place, quoted(name) + " is " + value.kindName() + "; give " + wanted);
}

Value optionOf(const JsonValue::Member& member, const std::filesystem::path& folder, bool of_run_too) {
  const OptionInfo* option = findOption(member.name);
  if (!option)
    throw faultAt(member.place,
                  quoted(member.name) + " is not an option; see kelp-bake --help, and leave the dashes out");
  if (option->scope == OptionScope::kRun && !of_run_too)
    throw faultAt(
        member.place,
        quoted(member.name) + " is of the whole run; give it on the command line or in a configuration");
  const JsonValue& value = member.value;
  expectType(value, option->type, member.name);
  if (value.text.empty())
    throw faultAt(value.place, quoted(member.name) + " is empty; leave it out for the default");
  return {namesFile(*option, value.text) ? (folder / value.text).string() : value.text, value.place};
}

}  // namespace kelp::bake_cli
