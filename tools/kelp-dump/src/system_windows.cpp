// SPDX-License-Identifier: MIT
#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "kelp/console/console.h"
#include "system.h"

namespace kelp::dump {
namespace {

constexpr int kInterrupted = 130;
constexpr int kMostOthers = 100;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

// The NewFile that there is, for the thread that is told of Ctrl-C. Its name is complete while the file is not -1.
std::filesystem::path g_temporary;
std::atomic<int> g_file{-1};

BOOL WINAPI removeAndExit(DWORD) {
  if (const int file = g_file.exchange(-1); file >= 0) {
    ::_close(file);  // else it could not be removed
    ::DeleteFileW(g_temporary.c_str());
  }
  constexpr char kMessage[] = "kelp-dump: interrupted\n";
  ::_write(2, kMessage, sizeof kMessage - 1);
  ::ExitProcess(kInterrupted);
}

}  // namespace

void catchInterrupts() { ::SetConsoleCtrlHandler(&removeAndExit, TRUE); }

NewFile::~NewFile() {
  if (name_.empty()) return;
  g_file = -1;
  if (file_ >= 0) ::_close(file_);
  ::DeleteFileW(console::pathOf(name_).c_str());
}

std::string NewFile::create(const std::string& path) {
  const std::size_t name_at = path.find_last_of("/\\:") + 1;
  const std::string stem = path.substr(0, name_at) + "." + path.substr(name_at) + "." + std::to_string(::GetCurrentProcessId());
  std::string name;
  // A killed program of this number may have left its own.
  for (int others = 0; file_ < 0; ++others) {
    name = others == 0 ? stem + ".tmp" : stem + "-" + std::to_string(others) + ".tmp";
    g_temporary = console::pathOf(name);
    file_ = ::_wopen(g_temporary.c_str(), _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
    if (file_ < 0 && (errno != EEXIST || others == kMostOthers)) return std::strerror(errno);
  }
  g_file = file_;
  path_ = path;
  name_ = name;
  return {};
}

std::string NewFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const int some = ::_write(file_, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), kMostAtOnce)));
    if (some <= 0) return std::strerror(some < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(some));
  }
  return {};
}

std::string NewFile::commit() {
  if (::_commit(file_) != 0) return std::strerror(errno);
  g_file = -1;
  if (::_close(std::exchange(file_, -1)) != 0) return std::strerror(errno);
  if (!::MoveFileExW(console::pathOf(name_).c_str(), console::pathOf(path_).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
    return std::system_category().message(static_cast<int>(::GetLastError()));
  name_.clear();
  return {};
}

}  // namespace kelp::dump
