// SPDX-License-Identifier: MIT
// Files for what reads files by their names: in memory, where the system has a place for that, and each
// written over by the next input's.
#pragma once

#include <filesystem>
#include <span>
#include <string>

class InputFolder {
 public:
  InputFolder();
  ~InputFolder();
  InputFolder(const InputFolder&) = delete;
  InputFolder& operator=(const InputFolder&) = delete;

  std::filesystem::path write(const std::string& name, std::span<const std::byte> bytes) const;

 private:
  std::filesystem::path folder_;
};
