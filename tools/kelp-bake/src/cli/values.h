// SPDX-License-Identifier: MIT
// Options as text with their places, from the command line, a manifest, a list or a configuration.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// Where a value was written. Line and column count from 1, columns in characters. An empty `file` means the
// command line.
struct Place {
  std::filesystem::path file;
  std::size_t line = 0, column = 0;

  bool isCommandLine() const { return file.empty(); }
  // "plants.json:3:14: "; empty for the command line.
  std::string prefix() const;
};

// The place of a byte in a text.
Place placeAt(const std::filesystem::path& file, std::string_view text, std::size_t offset);

struct Value {
  std::string text;
  Place place;
};

// By the option's long name without dashes, and "input" and "output".
using Values = std::map<std::string, Value, std::less<>>;

// `base` overridden by `over`. If two options exclude each other, one in `over` removes the other from
// `base`.
Values overlay(Values base, const Values& over);

// An error about a value: kUsage on the command line, kInvalid in a file.
ToolError faultAt(const Place& place, const std::string& what);

}  // namespace kelp::bake_cli
