// SPDX-License-Identifier: MIT
// The command line.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace underwater {

struct Arguments {
  std::string packs;    // folder
  std::string picture;  // of the last frame; empty: none
  int frames = 0;       // 0: until the window is closed
  int plants = 400;
  double start = 0;            // seconds into the scene
  glm::ivec2 size{1280, 720};  // pixels
};

extern const char* const kUsage;

// nullopt: it is not as kUsage says.
std::optional<Arguments> parse(int count, const char* const* words);

}  // namespace underwater
