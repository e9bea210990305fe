// SPDX-License-Identifier: MIT
// The calls of the operating system behind console.h and memory.h.
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX  // libstdc++ defines it, too
#define NOMINMAX
#endif
#include <algorithm>

#include <fcntl.h>
#include <io.h>
#include <windows.h>
// After windows.h, whose macros it needs.
#include <shellapi.h>

#include "file_system.h"
#include "kelp/common/console.h"
#include "kelp/common/memory.h"

namespace kelp::console {
namespace {

std::wstring wide(std::string_view text) {
  std::wstring out(text.size(), L'\0');  // UTF-8 has at least as many bytes as UTF-16 has units
  out.resize(static_cast<std::size_t>(
      text.empty() ? 0
                   : ::MultiByteToWideChar(CP_UTF8, 0, text.data(), static_cast<int>(text.size()), out.data(),
                                           static_cast<int>(out.size()))));
  return out;
}

std::string narrow(const wchar_t* text) {
  const int length = ::WideCharToMultiByte(CP_UTF8, 0, text, -1, nullptr, 0, nullptr, nullptr);
  std::string out(static_cast<std::size_t>(std::max(length, 1)), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, text, -1, out.data(), length, nullptr, nullptr);
  out.pop_back();  // the terminating zero
  return out;
}

// Writes to a console in UTF-16, whatever its code page is.
bool writeToConsole(std::string_view text) {
  const std::wstring letters = wide(text);
  const HANDLE console = ::GetStdHandle(STD_OUTPUT_HANDLE);
  for (std::size_t at = 0; at < letters.size();) {
    DWORD some = 0;
    if (!::WriteConsoleW(console, letters.data() + at,
                         static_cast<DWORD>(std::min<std::size_t>(letters.size() - at, 8000)), &some,
                         nullptr) ||
        some == 0)
      return false;
    at += some;
  }
  return true;
}

}  // namespace

void prepareStreams() {
  for (const int number : {0, 1, 2}) {
    if (::_get_osfhandle(number) < 0) static_cast<void>(::_open("NUL", number == 1 ? _O_RDONLY : _O_WRONLY));
    ::_setmode(number, _O_BINARY);
  }
  const HANDLE out = ::GetStdHandle(STD_OUTPUT_HANDLE);
  DWORD mode = 0;
  // colors
  if (::GetConsoleMode(out, &mode)) ::SetConsoleMode(out, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

std::vector<std::string> arguments(int argc, char** argv) {
  int count = 0;
  wchar_t** const words = ::CommandLineToArgvW(::GetCommandLineW(), &count);
  if (!words) return {argv, argv + argc};
  std::vector<std::string> out;
  for (int i = 0; i < count; ++i) out.push_back(narrow(words[i]));
  ::LocalFree(words);
  return out;
}

bool printsToTerminal() {
  DWORD mode = 0;  // only a console has one; _isatty() takes NUL for a terminal
  return ::GetConsoleMode(::GetStdHandle(STD_OUTPUT_HANDLE), &mode) != 0;
}

std::string writeOut(std::string_view text) {
  if (printsToTerminal()) return writeToConsole(text) ? "" : "the console takes nothing";
  const std::error_code problem = writeAll(1, std::as_bytes(std::span(text)));
  return problem ? problem.message() : "";
}

bool isPipe(const std::string&) { return false; }  // they have no place among files

}  // namespace kelp::console

namespace kelp {

std::uint64_t physicalMemory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return ::GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : ~std::uint64_t{0};
}

// Only the baker uses these, and it is not built for Windows.
std::uint64_t peakMemory() { return 0; }
void returnFreedMemory() {}

}  // namespace kelp
