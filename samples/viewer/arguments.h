// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "workshop.h"

namespace viewer {

struct Arguments {
  std::string pack, picture;
  int frames = 0;     // 0: until the window is closed
  bool edit = false;  // begin with the rig editor open
  bool watch = false;
  std::optional<BakeOrder> bake;  // what makes the pack
  bool help = false, version = false;
};

extern const char* const kUsage;

// Or, in `wrong`, what is wrong with them.
std::optional<Arguments> parseArguments(int count, const char* const* words, std::string& wrong);

}  // namespace viewer
