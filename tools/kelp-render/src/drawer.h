// SPDX-License-Identifier: MIT
// Draws a frame: by kelp's runtime, or by the paper's method as published.
#pragma once

#include <memory>
#include <span>

#include "count_target.h"
#include "kelp/gl/renderer.h"
#include "scene.h"
#include "views.h"

namespace kelp::render {

class Drawer {
 public:
  Drawer() = default;
  virtual ~Drawer() = default;
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  // Draws into the bound framebuffer, with depth. ToolError if that fails.
  virtual void draw(const gl::View& view, std::span<const runtime::Instance> instances) = 0;
  // The steps of one ray through each pixel of the target, which is bound afterwards. Rays to the sun and the
  // sky, and rays through fog, do not count.
  virtual StepCount count(const gl::View& view, std::span<const runtime::Instance> instances,
                          CountTarget& target) = 0;
};

// Both need the context to be current, here and in every call. ToolError kUnsupported for a scene that
// the paper's method cannot draw: fog, or parts that do not fit into dense 3D textures.
std::unique_ptr<Drawer> makeKelpDrawer(const Options& options, const ViewStyle& style, const Scene& scene,
                                       bool es);
std::unique_ptr<Drawer> makePaperDrawer(const Options& options, const ViewStyle& style, const Scene& scene,
                                        bool es);

}  // namespace kelp::render
