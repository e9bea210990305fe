// SPDX-License-Identifier: MIT
// Shows progress on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "cli/options.h"

namespace kelp::bake_cli {

// Shows the current step with its rate and time left. In a batch also the time left for all assets, estimated
// from the voxels done. By default shows nothing if stderr is not a terminal.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressStyle style);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  // In a batch: sets the current asset, counted from 1. `seconds_left`: for the whole batch; negative:
  // unknown.
  void beginAsset(std::size_t number, std::size_t count, const std::string& output, double seconds_left);
  void show(std::string_view stage, double done);
  // Erases the bar, so that other lines can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void drawBar(double done, double seconds);
  void printJson(double done, double seconds);

  ProgressStyle style_;
  bool drawn_ = false;
  std::string stage_, output_;
  std::size_t number_ = 0, count_ = 0;            // 0: no batch
  double batch_left_ = -1, batch_left_now_ = -1;  // when the asset began, and when it was shown last
  int percent_ = -1;
  Clock::time_point asset_begin_{}, stage_begin_{}, last_{};
};

}  // namespace kelp::bake_cli
