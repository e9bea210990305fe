// SPDX-License-Identifier: MIT
// How the parts of a model look where the picture shows parts: their colours, their joints, and what is said
// of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/type_precision.hpp>

#include "model.h"
#include "surface.h"

namespace kelp::view {

// The parts that the user looks at; -1: none.
struct PartFocus {
  int pointed = -1;  // the mouse points at it
  int chosen = -1;   // clicked

  // Whose numbers are shown.
  int part() const { return pointed >= 0 ? pointed : chosen; }
};

// sRGB, for kParts and kFit.
glm::u8vec3 colorOf(const Model& model, Surface surface, int part);
// Those of all parts. The part that is pointed at is lighter; where one is chosen, all others are darker.
std::vector<glm::u8vec3> colorsOf(const Model& model, Surface surface, const PartFocus& focus);

// A part's pivot, which is its joint, as posed, and where it hangs on the part that it follows: the nearest
// point of a swept part's spline, else the pivot. World.
struct PartJoint {
  glm::vec3 at{0};
  std::optional<glm::vec3> from;  // nullopt: it follows no part
};
PartJoint jointOf(const Model& model, int part);

// Why the fit cannot be shown.
inline constexpr char kNoFit[] =
    "The pack does not say how closely its parts follow a skin. kelp-bake measures it when it bakes a "
    "skinned "
    "glTF file that has clips.";

bool isSwept(const Model& model, int part);
// "arm.0: swept, 6 knots", "joints: a, b, c", "fit: mean 0.20, 95 % 0.64, max 1.80 voxels"; without a skin
// the first line alone. Parts of a skin that are not swept are rigid.
std::vector<std::string> describePart(const Model& model, int part);

}  // namespace kelp::view
