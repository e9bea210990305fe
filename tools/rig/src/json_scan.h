// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

namespace kelp::rig {

inline constexpr std::size_t kMaxTextBytes = std::size_t{16} << 20;
inline constexpr int kMaxDepth = 16;  // the language itself is five deep

// RigError for JSON text that is too long or nested too deeply. Call it before parsing.
void checkJsonBounds(std::string_view text);

// Line and column, from 1, of byte `offset` of `text`.
struct LineColumn {
  std::size_t line = 1;
  std::size_t column = 1;
};
LineColumn lineColumn(std::string_view text, std::size_t offset);

}  // namespace kelp::rig
