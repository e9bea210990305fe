// SPDX-License-Identifier: MIT
// JSON values with their line and column, for error messages.
#pragma once

#include <string>
#include <vector>

#include "cli/faults.h"
#include "cli/values.h"

namespace kelp::bake_cli {

struct JsonValue {
  enum class Kind { kNull, kBool, kNumber, kString, kArray, kObject };
  struct Member;

  Kind kind = Kind::kNull;
  std::string text;              // a string's text; a number or truth value as written
  std::vector<JsonValue> items;  // of an array
  std::vector<Member> members;   // of an object, in the file's order
  Place place;

  const char* kindName() const;  // "a number", ...
};
struct JsonValue::Member {
  std::string name;
  Place place;
  JsonValue value;
};

// Parses JSON. Throws ToolError kInvalid with line and column for a syntax error. Other faults (duplicate
// names, control characters) go to `faults`. Safe for hostile text: limits depth, values and members.
JsonValue parseJson(const std::filesystem::path& file, std::string_view text, Faults& faults);

// A name as shown in messages.
std::string quoted(const std::string& name);

// Whether a file is a stream ("-" or a pipe): it has no folder and can be read only once.
bool isStream(const std::filesystem::path& file);

// The text of a file or pipe, at most 16 MiB. Throws ToolError kIo or kInvalid. `named_at`: where the user
// named the file.
std::string readTextFile(const std::filesystem::path& file, const Place& named_at);

}  // namespace kelp::bake_cli
