// SPDX-License-Identifier: MIT
// What programs share at their edges: standard streams, terminals, the command line, files that are read from front to back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kelp::console {

// For the first line of main. A standard stream that is closed would give its number to the first file that is opened, and what is meant for it would go into that
// file: closed ones become such as nothing can be read from or written to (stderr: such as takes everything). On Windows line ends are not translated from here on.
void prepareStreams();

// The command line as UTF-8 on Windows, elsewhere as it is. arguments[0] is the program.
std::vector<std::string> arguments(int argc, char** argv);

enum class Stream { kIn, kOut, kErr };
bool isTerminal(Stream stream);

// What a terminal would obey (control characters, U+0080 to U+009F among them) becomes a space: for messages that quote files and their names.
std::string oneLine(std::string text);

// The same of JSON, whose strings stay what they are: such characters are escaped. As JSON is printed, with U+0000 to U+001F escaped already.
std::string escapeControls(std::string_view json);

// Bytes of memory that this machine has; the greatest number if it does not say.
std::uint64_t physicalMemory();

// All of `text` to standard output, at once. Why not ("No space left on device"), or nothing.
std::string writeOut(std::string_view text);

// A file of any kind, read once from front to back: pipes too, as a shell's <(...) is one. No thread but its own may use it.
class Reading {
 public:
  // "-" is standard input. A named pipe that nobody writes to is not waited for longer than two seconds.
  explicit Reading(const std::string& path);
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading();

  // The bytes that came: fewer than asked for, 0 at the end or if problem() says so.
  std::size_t read(std::span<std::byte> bytes);
  // Why it could not be opened or read, or nothing.
  const std::string& problem() const { return problem_; }

 private:
  std::intptr_t file_ = -1;
  bool own_ = false, begun_ = false;
  std::string problem_;
};

// Names of files are UTF-8 in kelp's programs on Windows, and bytes elsewhere; std::filesystem takes narrow text for another coding there.
inline std::filesystem::path pathOf(std::string_view name) { return std::u8string(name.begin(), name.end()); }
inline std::string nameOf(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

// Whether the file is a pipe, which Reading reads and nothing that must know a size can.
bool isPipe(const std::string& path);

}  // namespace kelp::console
