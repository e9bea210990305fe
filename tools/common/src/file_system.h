// SPDX-License-Identifier: MIT
// The calls of the operating system behind OutputFile: file_system_posix.cpp, file_system_windows.cpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <system_error>

namespace kelp {

long processId();

// Creates a file that does not exist yet and opens it for writing (on POSIX for reading, too).
// std::errc::file_exists if there is one.
std::error_code createFile(const std::filesystem::path& path, int& file);
// Gives the open file the permissions of another one, if that exists.
void keepPermissions(const std::filesystem::path& from, int file);
std::error_code writeAll(int file, std::span<const std::byte> bytes);
std::error_code flushToDisk(int file);
std::error_code closeFile(int file);
// Renames a file over another one, in one step.
std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to);
// Makes a rename in this folder last. Does nothing where a system has no such call.
void flushFolder(const std::filesystem::path& folder);

// From here to unguardFile an interrupt removes the file, if guardOutput or endOnInterrupt was called.
void guardFile(const std::filesystem::path& path, int file);
// Does nothing if another file is guarded.
void unguardFile(const std::filesystem::path& path);

// Interrupts wait while one of these exists, so that no file is created without being guarded.
class InterruptsWait {
 public:
  InterruptsWait();
  ~InterruptsWait();
  InterruptsWait(const InterruptsWait&) = delete;
  InterruptsWait& operator=(const InterruptsWait&) = delete;
};

}  // namespace kelp
