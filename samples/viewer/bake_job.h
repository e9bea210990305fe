// SPDX-License-Identifier: MIT
// kelp-bake as a child process, read as it goes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace viewer {

class BakeJob {
 public:
  // The program beside the viewer, or else the one in PATH; empty: there is none.
  static std::string findProgram();

  BakeJob() = default;
  ~BakeJob();  // interrupts it and waits
  BakeJob(const BakeJob&) = delete;
  BakeJob& operator=(const BakeJob&) = delete;

  // words: the program, then its arguments. Answers an empty line, or what is wrong. Only when none is running.
  std::string start(const std::vector<std::string>& words);
  // Takes in what it has said; never waits. True once, when it has come to its end.
  bool poll();
  void interrupt();  // it ends soon, and leaves nothing half written

  bool running() const { return process_ > 0; }
  const std::string& stage() const { return stage_; }
  float done() const { return done_; }  // share of the stage
  int exitCode() const { return exit_code_; }  // of the last one
  const std::string& text() const { return text_; }  // what it said, line by line, progress left out
  const std::string& lastLine() const { return last_line_; }

 private:
  void take(const std::string& line);
  void reap();  // waits for its end, which is near once it has closed its side of the pipe

  pid_t process_ = 0;
  int pipe_ = -1;
  int exit_code_ = 0;
  std::string pending_, text_, last_line_, stage_;
  float done_ = 0;
};

}  // namespace viewer
