// SPDX-License-Identifier: MIT
// The meaning of the picture's colors.
#pragma once

#include <optional>
#include <string_view>

namespace kelp::view {

// kNormals is a surface function of kelp-view (gl::RendererOptions::surface_glsl). kDistances: not of
// surfaces, but on a slice through the middle of the view. From kParts on: gl::DebugView, in its order.
enum class Surface {
  kShaded,
  kNormals,
  kDistances,
  kParts,
  kSteps,
  kLevels,
  kBounds,
  kSplines,
  kCages,
  kCount
};

const char* toString(Surface surface);
std::optional<Surface> parseSurface(std::string_view name);
// All of their names, with commas.
inline constexpr char kSurfaceNames[] =
    "shaded, normals, distances, parts, steps, levels, bounds, splines or cages";

// Null for those that have no surface function.
const char* glslOf(Surface surface);
// True if one renderer draws both.
inline bool shareRenderer(Surface a, Surface b) {
  return glslOf(a) == glslOf(b) && (a == Surface::kDistances) == (b == Surface::kDistances);
}

}  // namespace kelp::view
