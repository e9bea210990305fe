// SPDX-License-Identifier: MIT
// Every option that the command line, manifests, lists and configurations share: what it is called, what it
// takes, what it means.
#pragma once

#include <span>
#include <string_view>

namespace kelp::bake_cli {

enum class OptionType { kText, kNumber, kTextOrNumber, kFlag };
// kPack: changes what is baked, or what is written beside it: may stand at an asset. kRun: how the program
// goes about it.
enum class OptionScope { kPack, kRun };
enum class OptionPath { kNone, kFile, kFileOrPreset };  // whether the value names a file

struct OptionInfo {
  const char* name;  // without dashes
  const char* metavar;
  OptionType type;
  OptionScope scope;
  OptionPath path;
  // `shown` is what it is where nothing is said; else there is no such word, and it is an example
  bool has_fallback;
  const char* shown;  // as written in a configuration
  const char* help;
};

std::span<const OptionInfo> optionTable();
// nullptr if there is none.
const OptionInfo* findOption(std::string_view name);

}  // namespace kelp::bake_cli
