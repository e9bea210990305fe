// SPDX-License-Identifier: MIT
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX  // libstdc++ defines it, too
#define NOMINMAX
#endif
#include <windows.h>

#include "file_system.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>

#include "kelp/common/error.h"
#include "kelp/common/output_file.h"

namespace kelp {
namespace {

constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

// For the thread that hears Ctrl-C. The path is complete while the file is not -1.
std::string g_message;
std::filesystem::path g_guarded;
std::atomic<int> g_file{-1};

std::error_code lastError() { return {errno, std::generic_category()}; }

BOOL WINAPI removeAndEnd(DWORD) {
  if (const int file = g_file.exchange(-1); file >= 0) {
    ::_close(file);  // an open file cannot be removed
    ::DeleteFileW(g_guarded.c_str());
  }
  ::_write(2, g_message.data(), static_cast<unsigned>(g_message.size()));
  ::ExitProcess(static_cast<UINT>(Exit::kInterrupted));
}

}  // namespace

void endOnInterrupt(const char* program) {
  g_message = std::string(program) + ": interrupted\n";
  ::SetConsoleCtrlHandler(&removeAndEnd, TRUE);
}

void guardFile(const std::filesystem::path& path, int file) {
  if (g_message.empty() || g_file >= 0) return;
  g_guarded = path;
  g_file = file;
}

void unguardFile(const std::filesystem::path& path) {
  if (g_file >= 0 && path == g_guarded) g_file = -1;
}

// Ctrl-C is heard on a thread of its own: there is nothing to hold back.
InterruptsWait::InterruptsWait() = default;
InterruptsWait::~InterruptsWait() = default;

long processId() { return static_cast<long>(::GetCurrentProcessId()); }

std::error_code createFile(const std::filesystem::path& path, int& file) {
  file =
      ::_wopen(path.c_str(), _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
  return file < 0 ? lastError() : std::error_code();
}

void keepPermissions(const std::filesystem::path&, int) {}

std::error_code writeAll(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const int some = ::_write(file, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), kMostAtOnce)));
    if (some == 0) return std::make_error_code(std::errc::no_space_on_device);
    if (some < 0) return lastError();
    bytes = bytes.subspan(static_cast<std::size_t>(some));
  }
  return {};
}

std::error_code flushToDisk(int file) { return ::_commit(file) != 0 ? lastError() : std::error_code(); }

std::error_code closeFile(int file) {
  int guarded = file;
  g_file.compare_exchange_strong(guarded, -1);  // its number may soon be another file's
  return ::_close(file) != 0 ? lastError() : std::error_code();
}

std::error_code replaceFile(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH)) return {};
  return {static_cast<int>(::GetLastError()), std::system_category()};
}

void flushFolder(const std::filesystem::path&) {}  // MOVEFILE_WRITE_THROUGH has done it

}  // namespace kelp
