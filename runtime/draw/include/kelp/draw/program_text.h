// SPDX-License-Identifier: MIT
// The texts of programs: the files of shaders/, put together for a dialect of GLSL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kelp/draw/planner.h"

namespace kelp::draw {

enum class Dialect : std::uint8_t { kGl330, kEs300, kVulkan };

// Strings that are one text, one after the other. They live as long as the library, and as the host's
// surface.
struct ShaderText {
  std::array<const char*, 64> strings{};
  std::size_t count = 0;
  std::span<const char* const> all() const { return {strings.data(), count}; }
};
struct ProgramText {
  ShaderText vertex, fragment;
};

// The text of a program for solid parts has the features that are given, and `surface`, the host's
// kelpSurface (shaders/surface.glsl), in place of kelp's own. Null: kelp's own.
ProgramText programText(Program program, Dialect dialect, Features features = Features::kNone,
                        const char* surface = nullptr);

// kelpTrace and what it needs, for a host's own shaders: comes after #version. Without #line.
ShaderText traceText(Dialect dialect, Features features);

}  // namespace kelp::draw
