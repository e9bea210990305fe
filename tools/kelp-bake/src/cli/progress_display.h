// SPDX-License-Identifier: MIT
// How far the work is, on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "cli/options.h"

namespace kelp::bake_cli {

// Steps of a bake have no common measure: rate and time left are of the step that is shown, and in a batch
// the time left for all of it stands behind them, by the voxels that are done. Nothing on what is no
// terminal, unless it was asked for.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressStyle style);
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  // Of a batch: the asset that what follows is about, from 1 on. `seconds_left` for all of the batch; less
  // than 0: not known yet.
  void beginAsset(std::size_t number, std::size_t count, const std::string& output, double seconds_left);
  void show(std::string_view stage, double done);
  // Takes the bar away, so that other lines may follow.
  void clear();
  // The same for a bar that a process which has ended left there.
  void takeOver();

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
