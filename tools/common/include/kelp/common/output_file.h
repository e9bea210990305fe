// SPDX-License-Identifier: MIT
// Writing files: at every moment the place holds the old file or the new one, whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kelp {

// A file that replaces `path` when commit() is called.
//
// The bytes go to a temporary file in the same folder. commit() flushes it to the disk and renames it.
// Without commit() the destructor removes it. Symbolic links are followed, so a link stays a link. An
// existing file keeps its permissions. Several processes may write to one path: the last commit wins.
//
// Failures are ToolError kIo with a line that names the file, the reason and the remedy. One thread at a time
// may use an object.
class OutputFile {
 public:
  // Creates the temporary file. ToolError if the folder cannot be written to, or if `path` is a folder, a
  // device or an open stream (/dev/stdout).
  explicit OutputFile(const std::filesystem::path& path);
  // The same, except that "-" is standard output: bytes are written there as they come, and nothing is
  // replaced.
  static OutputFile orStandardOutput(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Bytes are buffered, so a failure may be reported by a later call.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text.data(), text.size()))); }
  // A number as it is in memory, which is little-endian.
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T value) { write(std::as_bytes(std::span(&value, 1))); }

  // As write(), but returns false where that throws. For callbacks of libraries without exceptions. After a
  // failure it keeps returning false, and commit() throws the reason.
  bool tryWrite(std::span<const std::byte> bytes);
  bool failed() const { return !problem_.empty(); }

  // For a library that writes to a stream and seeks in it. Write nothing else then. Not for standard output.
  void writeBy(const std::function<void(std::ostream&)>& write);

  // Writes what is buffered to the temporary file, for another process or reader of it. Throws as write()
  // does.
  void flush();
  const std::filesystem::path& path() const { return path_; }  // as given; empty: standard output
  // The open file, which may be read, too (not on Windows): for a process that writes or checks the bytes.
  int descriptor() const { return file_; }

  // Flushes to the disk and puts the file in place. Flushes the folder too: after a crash the new name is
  // there.
  void commit();

 private:
  OutputFile();  // standard output
  bool isStandardOutput() const { return path_.empty(); }
  void create();
  void put(std::span<const std::byte> bytes);
  void putBuffer();
  void throwIfFailed() const;

  std::filesystem::path path_;       // as given
  std::filesystem::path final_;      // where its links lead
  std::filesystem::path temporary_;  // empty where there is none
  int file_ = -1;
  std::string problem_;  // why writing failed
  std::vector<std::byte> buffer_;
};

// Tests whether an OutputFile can be created at `path`, before long work. Leaves nothing behind. ToolError
// kIo.
void checkOutput(const std::filesystem::path& path);

// ToolError kUsage if `output` is the file `input`, under any name. Does nothing if one of them does not
// exist.
void checkNotOverwritten(const std::filesystem::path& output, const std::filesystem::path& input);

// Writes a text, such as a report, by an OutputFile. An open stream (/dev/stdout) or a device (/dev/null) is
// written to directly. ToolError kIo.
void writeTextFile(const std::filesystem::path& path, std::string_view text);

// Tests whether writeTextFile can write `path`, before long work. ToolError kIo.
void checkTextOutput(const std::filesystem::path& path);

// The place that a path names once its last component is followed through symbolic links, 40 at most. That
// place need not exist. A program that writes there replaces the file and keeps the link.
std::filesystem::path followLinks(const std::filesystem::path& path);

// The descriptor of the open stream that a path names, also through links: 1 for /dev/stdout, /dev/fd/1 and
// /proc/self/fd/1. Nothing if the path names no stream. A stream is written to; it must not be replaced.
std::optional<int> streamOf(const std::filesystem::path& path);

// From now on Ctrl-C and other requests to end (SIGINT, SIGTERM, SIGHUP) remove the temporary file of the
// current OutputFile, print "PROGRAM: interrupted" and end the process with exit code 130. Only one
// OutputFile at a time is removed so. Requests that are ignored (nohup) stay ignored. `program` must stay
// valid.
void endOnInterrupt(const char* program);
// The two halves of it, for a program with a handler of its own. Not on Windows. guardOutput() comes before
// the first OutputFile; endInterrupted() removes the file, prints `message` (one line of at most 62 bytes)
// and ends the process. It may be called in a signal handler.
void guardOutput(const std::string& message);
[[noreturn]] void endInterrupted();

}  // namespace kelp
