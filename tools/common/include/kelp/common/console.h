// SPDX-License-Identifier: MIT
// Standard streams, terminals, the command line and names of files.
#pragma once

#include <filesystem>
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

// True if standard output is a terminal.
bool printsToTerminal();

// For messages that quote files and their names: control characters, which a terminal would obey, become
// spaces (also U+0080 to U+009F).
std::string oneLine(std::string text);

// The same for printed JSON: control characters are escaped, so its strings keep their meaning. U+0000 to
// U+001F must be escaped already.
std::string escapeControls(std::string_view json);

// Writes all of `text` to standard output, unbuffered. Returns the reason if that fails ("No space left on
// device"), else an empty text.
std::string writeOut(std::string_view text);

// File names are UTF-8 in kelp's programs on Windows, and bytes elsewhere. Convert them with these two: on
// Windows std::filesystem expects another encoding in narrow text.
inline std::filesystem::path pathOf(std::string_view name) { return std::u8string(name.begin(), name.end()); }
inline std::string nameOf(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

// True if the file is a pipe: its size is unknown, and it can be read only once.
bool isPipe(const std::string& path);

}  // namespace kelp::console
