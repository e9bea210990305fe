// SPDX-License-Identifier: MIT
// Prints for --method: the steps of a ray and the time of a frame.
#pragma once

#include <memory>

#include "canvas.h"
#include "drawer.h"

namespace kelp::render {

class MethodReport {
 public:
  MethodReport(const Options& options, Canvas& canvas) : options_(options), canvas_(canvas) {}

  // Draws a frame into the canvas, which is clear, takes the time until OpenGL has finished, and counts
  // steps.
  void draw(Drawer& drawer, const gl::View& view, std::span<const runtime::Instance> instances);
  // One line to standard output: means over the frames drawn. ToolError kIo if it cannot be written.
  void print() const;

 private:
  const Options& options_;
  Canvas& canvas_;
  std::unique_ptr<CountTarget> target_;
  StepCount count_;
  double seconds_ = 0;
  int frames_ = 0;
};

}  // namespace kelp::render
