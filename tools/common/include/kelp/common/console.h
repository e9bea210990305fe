// SPDX-License-Identifier: MIT
// Standard streams, terminals, the command line, and files that are read from front to back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kelp::console {

// Call this first in main(). If a standard stream is closed, the first file that is opened would get its
// number, and output for the stream would go into that file. So closed streams are opened: reading and
// writing them fails (stderr takes everything). On Windows, line ends are not translated from here on.
void prepareStreams();

// The command line: UTF-8 on Windows, unchanged elsewhere. arguments[0] is the program.
std::vector<std::string> arguments(int argc, char** argv);

enum class Stream { kIn, kOut, kErr };
bool isTerminal(Stream stream);

// For messages that quote files and their names: control characters, which a terminal would obey, become
// spaces (also U+0080 to U+009F).
std::string oneLine(std::string text);

// The same for printed JSON: control characters are escaped, so its strings keep their meaning. U+0000 to
// U+001F must be escaped already.
std::string escapeControls(std::string_view json);

// Writes all of `text` to standard output, unbuffered. Returns the reason if that fails ("No space left on
// device"), else an empty text.
std::string writeOut(std::string_view text);

// Reads a file of any kind once, from front to back, also a pipe such as a shell's <(...). For one thread.
class Reading {
 public:
  // "-" is standard input. If nobody writes to a named pipe within two seconds, that is a problem().
  explicit Reading(const std::string& path);
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading();

  // Returns the number of bytes read, which may be less than asked for. 0 at the end or after a problem().
  std::size_t read(std::span<std::byte> bytes);
  // Why the file could not be opened or read; empty if it could.
  const std::string& problem() const { return problem_; }

 private:
  std::intptr_t file_ = -1;
  bool own_ = false, begun_ = false;
  std::string problem_;
};

// File names are UTF-8 in kelp's programs on Windows, and bytes elsewhere. Convert them with these two: on
// Windows std::filesystem expects another encoding in narrow text.
inline std::filesystem::path pathOf(std::string_view name) { return std::u8string(name.begin(), name.end()); }
inline std::string nameOf(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

// True if the file is a pipe. Reading can read it, but its size is unknown.
bool isPipe(const std::string& path);

}  // namespace kelp::console
