// SPDX-License-Identifier: MIT
// A file that is either the old one or the new one, whole, at every moment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace kelp::bake {

// Bytes go to a new file in the folder of the final place (through links, so that a link stays one), which is removed unless it was committed.
// Many processes may write to one place at once: the last to commit stays. Not for several threads.
class OutputFile {
 public:
  // BakeError kIo if nothing can be written there, or something there is no regular file.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // false if they could not be written, for the reason that error() then is (as errno); commit() fails after that.
  bool write(std::span<const std::byte> bytes);
  int error() const { return error_; }
  // Onto the disk, then into place; the folder too, or a crash might forget the name. BakeError kIo.
  void commit();

  // Removes what a process that was ended before it could do so has left of an OutputFile for `path`, if it can; says nothing if not.
  static void removeLeftBy(long process, const std::filesystem::path& path);

 private:
  std::filesystem::path final_, folder_, path_;
  int file_ = -1;
  int error_ = 0;
};

// Whether writeTextFile could write `path`, asked before the long work: BakeError kIo. What is no regular file (/dev/null) and what names an open stream (/dev/stdout)
// is written as it is.
void checkTextOutput(const std::filesystem::path& path);

}  // namespace kelp::bake
