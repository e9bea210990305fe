// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "surface.h"
#include "workshop.h"

namespace kelp::view {

// The command line as data.
struct Arguments {
  std::string pack, picture;
  int frames = 0;                      // 0: until the user closes the window
  Surface surface = Surface::kShaded;  // what is shown first
  bool edit = false;                   // open the rig editor at once
  bool watch = false;
  std::optional<BakeOrder> bake;  // of --watch MODEL: how the pack is made
  bool help = false, version = false;
};

extern const char* const kHelp;

// words[0] is the program. On an error: nullopt, and in `wrong` the word, what is wrong and what to do.
std::optional<Arguments> parseArguments(int count, const char* const* words, std::string& wrong);

}  // namespace kelp::view
