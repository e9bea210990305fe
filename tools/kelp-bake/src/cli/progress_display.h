// SPDX-License-Identifier: MIT
// Shows progress on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "cli/options.h"

namespace kelp::bake_cli {

// Shows the current step with its rate and time left. By default shows nothing if stderr is not a terminal.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressStyle style);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(std::string_view stage, double done);
  // Erases the bar, so that other lines can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void drawBar(double done, double seconds);
  void printJson(double done, double seconds);

  ProgressStyle style_;
  bool drawn_ = false;
  std::string stage_;
  int percent_ = -1;
  Clock::time_point stage_begin_{}, last_{};
};

}  // namespace kelp::bake_cli
