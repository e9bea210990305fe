// SPDX-License-Identifier: MIT
// kelp-bake as a child process whose progress is read while it runs.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace kelp::view {

class BakeJob {
 public:
  // The path of kelp-bake: beside kelp-view, else in PATH. Empty if there is none.
  static std::string findProgram();

  BakeJob() = default;
  ~BakeJob();  // interrupts the bake and waits
  BakeJob(const BakeJob&) = delete;
  BakeJob& operator=(const BakeJob&) = delete;

  // Starts the program words[0] with the other words as arguments. Answers an empty text, or what is wrong.
  // Call it only while no bake runs.
  std::string start(const std::vector<std::string>& words);
  // Reads what it has written; never waits. Answers true once, when the program has ended.
  bool poll();
  void interrupt();  // asks it to stop; it leaves no half-written file

  bool running() const { return process_ > 0; }
  const std::string& stage() const { return stage_; }
  float done() const { return done_; }               // of the stage, 0 to 1
  int exitCode() const { return exit_code_; }        // of the last one
  const std::string& text() const { return text_; }  // its messages, one a line, without the progress
  const std::string& lastLine() const { return last_line_; }

 private:
  void take(const std::string& line);
  void reap();  // waits until it ends; call it once it has closed its side of the pipe

  pid_t process_ = 0;
  int pipe_ = -1;
  int exit_code_ = 0;
  std::string pending_, text_, last_line_, stage_;
  float done_ = 0;
};

}  // namespace kelp::view
