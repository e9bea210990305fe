// SPDX-License-Identifier: MIT
#include "input_folder.h"

#include <cstdio>
#include <cstdlib>
#include <random>

InputFolder::InputFolder() {
  std::error_code error;
  const std::filesystem::path memory = "/dev/shm", place = std::filesystem::is_directory(memory, error)
                                                               ? memory
                                                               : std::filesystem::temp_directory_path();
  std::random_device random;
  do folder_ = place / ("kelp_fuzz_" + std::to_string(random()));
  while (!std::filesystem::create_directory(folder_));
}

InputFolder::~InputFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path InputFolder::write(const std::string& name, std::span<const std::byte> bytes) const {
  std::filesystem::path path = folder_ / name;
  std::FILE* const file = std::fopen(path.string().c_str(), "wb");
  const bool whole = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  if (!file || std::fclose(file) != 0 || !whole) {
    std::perror(path.string().c_str());
    std::abort();
  }
  return path;
}
