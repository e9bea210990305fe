// SPDX-License-Identifier: MIT
#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <io.h>
#include <shellapi.h>
#include <windows.h>

#include "file_system.h"
#include "kelp/common/console.h"

namespace kelp::console {
namespace {

constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

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
  // colours
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

bool isTerminal(Stream stream) {
  DWORD mode = 0;  // only a console has one; _isatty() takes NUL for a terminal
  return ::GetConsoleMode(::GetStdHandle(stream == Stream::kIn    ? STD_INPUT_HANDLE
                                         : stream == Stream::kOut ? STD_OUTPUT_HANDLE
                                                                  : STD_ERROR_HANDLE),
                          &mode) != 0;
}

std::string writeOut(std::string_view text) {
  if (isTerminal(Stream::kOut)) return writeToConsole(text) ? "" : "the console takes nothing";
  const std::error_code problem = writeAll(1, std::as_bytes(std::span(text)));
  return problem ? problem.message() : "";
}

Reading::Reading(const std::string& path) {
  if (path == "-") {
    file_ = 0;
    return;
  }
  file_ = ::_wopen(wide(path).c_str(), _O_RDONLY | _O_BINARY | _O_SEQUENTIAL);
  if (file_ < 0) problem_ = std::strerror(errno);
  own_ = file_ >= 0;
}

Reading::~Reading() {
  if (own_) ::_close(static_cast<int>(file_));
}

std::size_t Reading::read(std::span<std::byte> bytes) {
  if (!problem_.empty()) return 0;
  const int got = ::_read(static_cast<int>(file_), bytes.data(),
                          static_cast<unsigned>(std::min(bytes.size(), kMostAtOnce)));
  if (got < 0) problem_ = std::strerror(errno);
  begun_ = begun_ || got > 0;
  return got > 0 ? static_cast<std::size_t>(got) : 0;
}

bool isPipe(const std::string&) { return false; }  // they have no place among files

}  // namespace kelp::console
