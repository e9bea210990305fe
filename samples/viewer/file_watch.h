// SPDX-License-Identifier: MIT
// Whether files changed, by looking at them now and then: whoever saves writes in place, or renames, or deletes first, on whatever file system.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace viewer {

class FileWatch {
 public:
  static constexpr double kInterval = 0.25;  // seconds between two looks

  // From now on these, be they there or not. What is watched already is compared with what it was; of what is new, a change after `since`
  // (nanoseconds of the system's clock, as files' times) counts as one to come.
  void watch(const std::vector<std::string>& paths, std::int64_t since);
  void watch(const std::vector<std::string>& paths) { watch(paths, INT64_MAX); }

  // True once when something is other than it was, and has stood still from one look to the next. `now`: seconds, ascending.
  bool changed(double now);
  void accept();  // what is there now is no change
  static std::int64_t clock();  // now, for `since`

 private:
  struct Stamp {
    bool there = false;
    std::uint64_t device = 0, inode = 0;
    std::int64_t size = 0, time = 0;  // nanoseconds
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    Stamp known, seen;
  };

  static Stamp look(const std::string& path);

  std::map<std::string, File> files_;
  double next_look_ = 0;
};

}  // namespace viewer
