// SPDX-License-Identifier: MIT
// The options that command line, manifests, lists and configurations share: name, type and meaning.
#pragma once

#include <span>
#include <string_view>

namespace kelp::bake_cli {

enum class OptionType { kText, kNumber, kTextOrNumber, kFlag };
// kPack: changes a pack or the files written beside it; an asset of a manifest may set it. kRun: belongs to
// the whole run.
enum class OptionScope { kPack, kRun };
enum class OptionPath { kNone, kFile, kFileOrPreset };  // whether the value is a file name

struct OptionInfo {
  const char* name;     // without dashes
  const char* group;    // its heading in --help
  const char* metavar;  // "a|b|FILE": what is in small letters is to be typed as it is
  OptionType type;
  OptionScope scope;
  OptionPath path;
  // true: `shown` is the default; false: an example
  bool has_fallback;
  const char* shown;  // as written in a configuration
  const char* help;
};

std::span<const OptionInfo> optionTable();
// nullptr if there is none.
const OptionInfo* findOption(std::string_view name);

}  // namespace kelp::bake_cli
