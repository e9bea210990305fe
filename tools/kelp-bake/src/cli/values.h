// SPDX-License-Identifier: MIT
// Options as they were written, before anything is made of them: on the command line, in a manifest, in a
// list, in a configuration.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "kelp/bake/bake.h"

namespace kelp::bake_cli {

// Where something was written. Line and column count from 1, columns in characters; an empty file is the
// command line.
struct Place {
  std::filesystem::path file;
  std::size_t line = 0, column = 0;

  bool isCommandLine() const { return file.empty(); }
  // "plants.json:3:14: ", or nothing for the command line.
  std::string prefix() const;
};

// The place of a byte of a text.
Place placeAt(const std::filesystem::path& file, std::string_view text, std::size_t offset);

struct Value {
  std::string text;
  Place place;
};

// By the option's long name without dashes; beside them "input" and "output".
using Values = std::map<std::string, Value, std::less<>>;

// `over` where it says something, else `base`. Of two options that exclude each other, what `over` says
// displaces what `base` does.
Values overlay(Values base, const Values& over);

// An error about what was written in a place: usage on the command line, invalid input in a file.
ToolError faultAt(const Place& place, const std::string& what);

}  // namespace kelp::bake_cli
