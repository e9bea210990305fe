// SPDX-License-Identifier: MIT
// What every system has calls of its own for: system_posix.cpp, system_windows.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace kelp::dump {

// From now on Ctrl-C, and whatever else asks a program to end, removes the NewFile that there is and ends the program with 130. Where it is ignored, as under nohup, it stays so.
void catchInterrupts();

// A file beside `path` that takes its place when it is complete, and is gone if that is never. One at a time. Each call answers why it failed, or nothing.
class NewFile {
 public:
  NewFile() = default;
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  // With the permissions of the file that is there.
  std::string create(const std::string& path);
  std::string write(std::span<const std::byte> bytes);
  // Onto the disk, then into place.
  std::string commit();
  const std::string& name() const { return name_; }

 private:
  std::string path_, name_;  // the latter empty: there is none
  int file_ = -1;
};

}  // namespace kelp::dump
