// SPDX-License-Identifier: MIT
// A plant that gives way: bent sideways without growing longer, pushed by the current and by whoever comes near, and swinging
// back.
#pragma once

#include <span>

#include <glm/glm.hpp>

#include "kelp/formats/spline.h"

namespace underwater {

inline constexpr float kMostLean = 0.45f;  // heights: as far as a stalk leans, with what bends it harder pulling in vain

// Leans a straight stalk: its top moves by `lean` heights in x and z, its foot stays upright, and its length stays what it was,
// so the top comes down. Knots as at rest; lean is at most kMostLean long.
void leanStalk(const glm::vec2& lean, float height, std::span<kelp::Knot> knots);

// Something that pushes plants aside.
struct Visitor {
  glm::vec3 at{0};
  glm::vec3 velocity{0};  // metres a second
  float reach = 0;        // metres from `at` where it is felt
};

// How far a visitor wants to lean a plant that stands at `foot` and is `height` metres tall: away from it and a little along with
// it; heights.
glm::vec2 pushOf(const Visitor& visitor, const glm::vec3& foot, float height);

// The water's drift at a place and a time, in heights: a swell that rolls over the reef.
glm::vec2 currentAt(const glm::vec2& at, double seconds);

// The lean at most kMostLean long: shorter ones hardly change, longer ones come near.
glm::vec2 limitLean(const glm::vec2& lean);

// A lean that follows what is wanted like a weight on a damped spring.
struct Sway {
  glm::vec2 lean{0}, speed{0};
  void follow(const glm::vec2& wanted, float seconds);
};

}  // namespace underwater
