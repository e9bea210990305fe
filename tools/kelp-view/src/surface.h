// SPDX-License-Identifier: MIT
// What the colours of the picture mean.
#pragma once

#include <optional>
#include <string_view>

namespace kelp::view {

// All except kShaded and kDistances are surface functions of kelp-view (gl::RendererOptions::surface_glsl).
// kDistances: not of surfaces, but on a slice through the middle of the view. kParts and kFit: each part has
// one colour, its own, or that of how closely it follows its skin.
enum class Surface { kShaded, kNormals, kLevels, kSteps, kDistances, kParts, kFit, kCount };

const char* toString(Surface surface);
std::optional<Surface> parseSurface(std::string_view name);
// All of their names, with commas.
inline constexpr char kSurfaceNames[] = "shaded, normals, levels, steps, distances, parts or fit";

// Null for those that have no surface function.
const char* glslOf(Surface surface);

inline bool showsParts(Surface surface) { return surface == Surface::kParts || surface == Surface::kFit; }
// What key P shows next: parts, then the fit if it is known, then the shaded model.
Surface afterParts(Surface surface, bool fit_known);

}  // namespace kelp::view
