// SPDX-License-Identifier: MIT
// JSON whose every value knows where it was written, so that whoever wrote it can be told.
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
  std::string text;              // of a string; of a number or truth value as it was written
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

// Safe for hostile text: bounds depth, values and members. ToolError kInvalid with line and column for what
// cannot be read on from; what can goes to `faults`: names that are there twice, control characters.
JsonValue parseJson(const std::filesystem::path& file, std::string_view text, Faults& faults);

// A name as messages show it.
std::string quoted(const std::string& name);

// Whether a file comes as a stream, "-" or a pipe: it has no folder, and cannot be read again.
bool isStream(const std::filesystem::path& file);

// The text of a file that the user named, a pipe perhaps: at most 16 MiB. ToolError kIo or kInvalid;
// `named_at` is who named it.
std::string readTextFile(const std::filesystem::path& file, const Place& named_at);

}  // namespace kelp::bake_cli
