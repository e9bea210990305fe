// SPDX-License-Identifier: MIT
#include "cli/progress_display.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace kelp::bake_cli {
namespace {

constexpr int kWidth = 30;
// An escape sequence that erases the line: only ever sent where a bar was asked for or stderr is a terminal.
constexpr const char* kEraseLine = "\r\x1b[K";
// Before this a rate is a guess.
constexpr double kEnoughSeconds = 0.5;

bool isTerminal() {
  const char* const kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && !(kind && std::strcmp(kind, "dumb") == 0);
}

// Characters to a line; a longer one would wrap, and could not be erased.
std::size_t lineWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

// "0:07", "71:05"
std::string clockText(double seconds) {
  const auto whole = static_cast<long>(std::ceil(std::min(seconds, 1e8)));
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

ProgressDisplay::ProgressDisplay(ProgressStyle style) : style_(style) {
  if (style_ == ProgressStyle::kAuto) style_ = isTerminal() ? ProgressStyle::kBar : ProgressStyle::kNone;
}

void ProgressDisplay::show(std::string_view stage, double done) {
  if (style_ == ProgressStyle::kNone) return;
  const double share = std::clamp(done, 0.0, 1.0);
  const int percent = static_cast<int>(share * 100.0);
  const bool new_stage = stage != stage_;
  if (!new_stage && percent == percent_) return;
  const auto now = Clock::now();
  if (new_stage) stage_begin_ = now;
  if (!new_stage && percent < 100 && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  stage_ = stage;
  percent_ = percent;
  const double seconds = std::chrono::duration<double>(now - stage_begin_).count();
  style_ == ProgressStyle::kJson ? printJson(share, seconds) : drawBar(share, seconds);
  std::fflush(stderr);
}

void ProgressDisplay::drawBar(double done, double seconds) {
  const auto filled = static_cast<std::size_t>(percent_ * kWidth / 100);
  std::string line = fmt::format("{:<9} [{}{}] {:3} %", stage_, std::string(filled, '#'),
                                 std::string(kWidth - filled, '.'), percent_);
  if (done > 0 && done < 1 && seconds >= kEnoughSeconds)
    line +=
        fmt::format(", {:.3g} %/s, {} left", 100 * done / seconds, clockText(seconds * (1 - done) / done));
  std::fputs((kEraseLine + line.substr(0, std::max<std::size_t>(lineWidth(), 2) - 1)).c_str(), stderr);
  drawn_ = true;
}

void ProgressDisplay::printJson(double done, double seconds) {
  nlohmann::ordered_json json{
      {"kind", "progress"}, {"stage", stage_}, {"done", std::floor(done * 100) / 100}, {"seconds", seconds}};
  if (done > 0) json["seconds_left"] = seconds * (1 - done) / done;  // of the stage
  std::fputs((json.dump() + '\n').c_str(), stderr);
}

void ProgressDisplay::clear() {
  if (drawn_) std::fputs(kEraseLine, stderr);
  drawn_ = false;
}

}  // namespace kelp::bake_cli
