// SPDX-License-Identifier: MIT
#include "progress_display.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace kelp::bake_cli {
namespace {

constexpr int kWidth = 30;
// An escape sequence that erases the line: only ever sent where a bar was asked for or stderr is a terminal.
constexpr const char* kEraseLine = "\r\x1b[K";

}  // namespace

ProgressDisplay::ProgressDisplay(ProgressStyle style) : style_(style) {
  if (style_ == ProgressStyle::kAuto) style_ = isatty(STDERR_FILENO) ? ProgressStyle::kBar : ProgressStyle::kNone;
}

void ProgressDisplay::show(std::string_view stage, double done) {
  if (style_ == ProgressStyle::kNone) return;
  const int percent = static_cast<int>(std::clamp(done, 0.0, 1.0) * 100.0);
  const bool new_stage = stage != stage_;
  if (!new_stage && percent == percent_) return;
  const auto now = std::chrono::steady_clock::now();
  if (!new_stage && percent < 100 && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  stage_ = stage;
  percent_ = percent;
  if (style_ == ProgressStyle::kJson) {
    fmt::print(stderr, "{{\"stage\":\"{}\",\"done\":{:.2f}}}\n", stage, percent / 100.0);
  } else {
    const int filled = percent * kWidth / 100;
    fmt::print(stderr, "{}{:<9} [{:#<{}}{:.<{}}] {:3} %", kEraseLine, stage, "", filled, "", kWidth - filled, percent);
    drawn_ = true;
  }
  std::fflush(stderr);
}

void ProgressDisplay::clear() {
  if (drawn_) std::fputs(kEraseLine, stderr);
  drawn_ = false;
}

}  // namespace kelp::bake_cli
