// SPDX-License-Identifier: MIT
// How far the work is, on stderr.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "options.h"

namespace kelp::bake_cli {

class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressStyle style);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(std::string_view stage, double done);
  // Takes the bar away, so that other lines may follow.
  void clear();

 private:
  ProgressStyle style_;
  bool drawn_ = false;
  std::string stage_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace kelp::bake_cli
