// SPDX-License-Identifier: MIT
// Notices changed files by looking at them four times a second. This finds every way to save (writing in
// place, renaming, deleting first) on every file system.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kelp::view {

class FileWatch {
 public:
  static constexpr double kInterval = 0.25;  // seconds between two looks

  // Watches these files from now on; they need not exist. A file that is watched already is compared with its
  // known state. For a new one, a change after `since` counts (nanoseconds, as the times of files).
  void watch(const std::vector<std::string>& paths, std::int64_t since);
  void watch(const std::vector<std::string>& paths) { watch(paths, INT64_MAX); }

  // True once when a file has changed, and then stayed the same from one look to the next. `now`: seconds,
  // ascending.
  bool changed(double now);
  void accept();                // takes the present state as known
  static std::int64_t clock();  // the time now, for `since`

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

}  // namespace kelp::view
