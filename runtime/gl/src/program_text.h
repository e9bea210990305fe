// SPDX-License-Identifier: MIT
// The texts of programs: shaders/ put together for a dialect of GLSL. No graphics API.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kelp/formats/spline.h"
#include "kelp/gl/renderer.h"

namespace kelp::gl {

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

// For parts that bend so; without `bend`, for all. `surface`: the host's kelpSurface. Null: kelp's own.
ProgramText solidProgramText(Dialect dialect, const char* surface, Features features,
                             std::optional<Bend> bend);
// For fog: for parts that have heat too, or with the sun's shadow of fog on itself.
ProgramText fogProgramText(Dialect dialect, Bend bend, bool heat, bool shadow);

// What View::debug draws with instead, and in addition: colors of solids of either bend, and of fog; lines.
ProgramText debugProgramText(Dialect dialect);
ProgramText debugFogProgramText(Dialect dialect, Bend bend);
ProgramText lineProgramText(Dialect dialect);

// The text of kelp::gl::Renderer::traceGlsl(). Without #line: in a host's shader the host numbers the
// strings.
ShaderText traceText(Dialect dialect, Features features);

}  // namespace kelp::gl
