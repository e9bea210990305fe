// SPDX-License-Identifier: MIT
#include "method_report.h"

#include <chrono>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/error.h"

namespace kelp::render {

void MethodReport::draw(Drawer& drawer, const gl::View& view, std::span<const runtime::Instance> instances) {
  if (frames_++ == 0) {
    // Drivers compile shaders when something is drawn for the first time. That is no part of a frame.
    canvas_.restrict(true);
    drawer.draw(view, instances);
    canvas_.restrict(false);
    canvas_.clear();
    target_ = std::make_unique<CountTarget>(options_.size);
  }
  count_ += drawer.count(view, instances, *target_);
  canvas_.bind();
  canvas_.finish();
  const auto start = std::chrono::steady_clock::now();
  drawer.draw(view, instances);
  canvas_.finish();
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void MethodReport::print() const {
  const double steps =
      count_.rays == 0 ? 0 : static_cast<double>(count_.steps) / static_cast<double>(count_.rays);
  const double milliseconds = 1000 * seconds_ / frames_;
  const std::string line =
      fmt::format("method {}: {:.1f} steps per ray that meets the box, {:.{}f} ms a frame\n",
                  toString(options_.method), steps, milliseconds, milliseconds < 10 ? 2 : 0);
  if (const std::string problem = console::writeOut(line); !problem.empty())
    throw ToolError(
        Exit::kIo,
        fmt::format("standard output cannot be written: {}; free space or choose another file", problem));
}

}  // namespace kelp::render
