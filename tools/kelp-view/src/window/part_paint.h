// SPDX-License-Identifier: MIT
// The colours of a model's parts on the GPU, for the surfaces that show parts.
#pragma once

#include <vector>

#include <glm/gtc/type_precision.hpp>

#include "kelp/gl/renderer.h"

namespace kelp::view {

class PartPaint {
 public:
  PartPaint() = default;
  ~PartPaint();
  PartPaint(const PartPaint&) = delete;
  PartPaint& operator=(const PartPaint&) = delete;

  // Sends the colours (sRGB), and sets what the view binds. This object must live until the view is drawn.
  void attach(std::vector<glm::u8vec3> colors, gl::View& view);

 private:
  std::vector<std::vector<glm::u8vec3>> colors_;  // of the one instance, as sent
  unsigned name_ = 0;
  int rows_ = 0;
};

}  // namespace kelp::view
