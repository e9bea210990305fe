// SPDX-License-Identifier: MIT
// The colours of all parts of a scene on the GPU, for --view parts and --view fit.
#pragma once

#include <span>

#include "kelp/gl/renderer.h"

namespace kelp::render {

class PartTexture {
 public:
  // Of each instance's parts: their own colours, or those of how closely they follow their skin.
  PartTexture(std::span<const runtime::Instance> instances, bool fit);
  ~PartTexture();
  PartTexture(const PartTexture&) = delete;
  PartTexture& operator=(const PartTexture&) = delete;

  // For a renderer whose surface is kPartSurface. The texture must live until the view is drawn.
  void attach(gl::View& view) const;

 private:
  unsigned name_ = 0;
  int rows_ = 0;
};

}  // namespace kelp::render
