// SPDX-License-Identifier: MIT
#include "kelp/common/links.h"

#include <charconv>
#include <string>
#include <system_error>

namespace kelp {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as many as Linux follows

// Follows links until `done(path)` holds, or the path is no link.
template <class Done>
fs::path follow(fs::path path, const Done& done) {
  std::error_code error;
  for (int links = 0; links < kMostLinks && !done(path) && fs::is_symlink(path, error); ++links)
    path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

// N of /dev/fd/N and /proc/PROCESS/fd/N.
std::optional<int> streamNumber(const fs::path& path) {
  const std::string folder = path.parent_path().generic_string(), name = path.filename().generic_string();
  if (folder != "/dev/fd" && !(folder.starts_with("/proc/") && folder.ends_with("/fd"))) return {};
  int number = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, problem] = std::from_chars(name.data(), end, number);
  return problem == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace

fs::path followLinks(const fs::path& path) {
  return follow(path, [](const fs::path&) { return false; });
}

std::optional<int> streamOf(const fs::path& path) {
  std::optional<int> number;
  follow(path, [&](const fs::path& at) { return (number = streamNumber(at)).has_value(); });
  return number;
}

}  // namespace kelp
