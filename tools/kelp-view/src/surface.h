// SPDX-License-Identifier: MIT
// The meaning of the picture's colors.
#pragma once

#include <optional>
#include <string_view>

namespace kelp::view {

// All except kShaded and kDistances are surface functions of kelp-view (gl::RendererOptions::surface_glsl).
// kDistances: not of surfaces, but on a slice through the middle of the view.
enum class Surface { kShaded, kNormals, kLevels, kSteps, kDistances, kCount };

const char* toString(Surface surface);
std::optional<Surface> parseSurface(std::string_view name);
// All of their names, with commas.
inline constexpr char kSurfaceNames[] = "shaded, normals, levels, steps or distances";

// Null for those that have no surface function.
const char* glslOf(Surface surface);

}  // namespace kelp::view
