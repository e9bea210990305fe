// SPDX-License-Identifier: MIT
// Bakes a model, and again whenever a file changes that the last bake has read.
#pragma once

#include <optional>

#include "bake_job.h"
#include "file_watch.h"

namespace kelp::view {

// kelp-view --watch SOURCE OPTIONS...
struct BakeOrder {
  std::string source;
  std::vector<std::string> options;  // for kelp-bake, without its output and its rig
  std::string output;
  std::string rig;  // a file or a preset; empty: kelp-bake looks for one
};

class Workshop {
 public:
  explicit Workshop(BakeOrder order, std::string program = BakeJob::findProgram());
  ~Workshop();
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;

  enum class News { kNothing, kBaked, kFailed };
  // Starts and stops bakes. Call it each frame. `now`: seconds, ascending.
  News update(double now);

  const BakeOrder& order() const { return order_; }
  // The file to save a rig to, so that the next bake reads it.
  std::string rigPath() const;
  void useRig(const std::string& path);  // from the next bake on

  bool baking() const { return wanted_ || job_.running(); }
  const BakeJob& job() const { return job_; }
  const std::string& error() const { return error_; }  // of the last bake; empty: no error
  int exitCode() const { return exit_code_; }

 private:
  void start();
  News finish();
  std::vector<std::string> presumed() const;  // the files that a bake will probably read

  BakeOrder order_;
  std::string program_, dependencies_path_;
  BakeJob job_;
  FileWatch watch_;
  std::vector<std::string> dependencies_;  // read by the last bake that succeeded
  bool wanted_ = true;
  std::int64_t started_ = 0;
  std::string error_;
  int exit_code_ = 0;
};

// The files after the colon of a make rule, as kelp-bake -MF writes it.
std::vector<std::string> readDependencies(const std::string& rule);

}  // namespace kelp::view
