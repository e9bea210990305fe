// SPDX-License-Identifier: MIT
#include "surface.h"

namespace kelp::view {

const char* toString(Surface surface) {
  constexpr const char* kNames[] = {"shaded", "normals", "distances", "parts", "steps",
                                    "levels", "bounds",  "splines",   "cages"};
  return kNames[static_cast<int>(surface)];
}

std::optional<Surface> parseSurface(std::string_view name) {
  for (int i = 0; i < static_cast<int>(Surface::kCount); ++i) {
    if (name == toString(static_cast<Surface>(i))) return static_cast<Surface>(i);
  }
  return {};
}

const char* glslOf(Surface surface) {
  return surface == Surface::kNormals
             ? "vec4 kelpSurface(KelpSurface s) { return vec4(0.5 + 0.5 * s.normal, 1.0); }"
             : nullptr;
}

}  // namespace kelp::view
