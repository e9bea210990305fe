// SPDX-License-Identifier: MIT
#include "pack_file.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "kelp/console/console.h"
#include "text.h"

namespace kelp::dump {

PackFile::PackFile(const std::string& path) : path_(path) {
  if (path == "-" || console::isPipe(path)) {
    if (path == "-") path_ = "standard input";
    piped_.emplace(path);
    return;
  }
  errno = 0;
  Result<FileSource> opened = FileSource::open(path.c_str());
  if (!opened) {
    const int reason = errno;
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(console::pathOf(path), ignored);
    if (std::filesystem::is_directory(status)) throw DumpError(kIo, fmt::format("{}: is a folder; name a .kelp file", path));
    if (std::filesystem::is_other(status)) throw DumpError(kIo, fmt::format("{}: is a device, no file; name a .kelp file, or - for standard input", path));
    throw DumpError(kIo, fmt::format("{}: can not be opened: {}; check the path and its permissions", path, reason ? std::strerror(reason) : opened.error().detail));
  }
  file_ = *std::move(opened);
}

const Pack& PackFile::pack() {
  if (!pack_) {
    Result<Pack> opened = Pack::open(source());
    if (!opened) fail(opened.error());
    pack_ = *std::move(opened);
  }
  return *pack_;
}

const Pack* PackFile::packIfSound() {
  if (!pack_) {
    if (Result<Pack> opened = Pack::open(source())) pack_ = *std::move(opened);
  }
  return pack_ ? &*pack_ : nullptr;
}

std::string PackFile::partList() {
  const std::span<const Part> parts = pack().parts();
  std::string names;
  for (std::size_t i = 0; i < parts.size() && i < 12; ++i) names += fmt::format("{}{} '{}'", i ? ", " : "", i, nameText(parts[i].name, 40));
  return names + (parts.size() > 12 ? ", ..." : "");
}

std::uint32_t PackFile::findPart(const std::string& wanted) {
  const std::span<const Part> parts = pack().parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == wanted) return static_cast<std::uint32_t>(i);
  std::uint32_t index = 0;
  const auto [end, problem] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (problem == std::errc() && end == wanted.data() + wanted.size() && index < parts.size()) return index;
  throw DumpError(kUsage, fmt::format("{}: there is no part '{}'; parts are {}; choose one of them", path_, nameText(wanted), partList()));
}

void PackFile::fail(const Error& error, const std::string& where) const {
  std::string message = path_ + ": ";
  if (!where.empty()) message += where + ": ";
  if (error.offset != Error::kNoOffset) message += fmt::format("byte {}: ", error.offset);
  message += toString(error.code);
  if (*error.detail) message += fmt::format(" ({})", error.detail);
  throw DumpError(exitCode(error.code), message + "; " + remedy(error.code));
}

Exit exitCode(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo: return kIo;
    case ErrorCode::kNotAPack:
    case ErrorCode::kTruncated:
    case ErrorCode::kChecksum:
    case ErrorCode::kCorrupt:
    case ErrorCode::kLimit:
    case ErrorCode::kNotMonotone: return kInvalid;
    case ErrorCode::kUnsupportedVersion:
    case ErrorCode::kUnsupportedFeature: return kUnsupported;
    case ErrorCode::kMisuse:
    case ErrorCode::kOutOfMemory:
    case ErrorCode::kGraphics: return kFailure;
  }
  return kFailure;
}

const char* remedy(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo: return "check the disk and the file's permissions";
    case ErrorCode::kNotAPack: return "packs are made by kelp-bake: check that this is the right file";
    case ErrorCode::kTruncated: return "the file is not complete: copy or bake it again";
    case ErrorCode::kChecksum: return "the file was damaged after it was made: copy or bake it again";
    case ErrorCode::kCorrupt:
    case ErrorCode::kNotMonotone: return "the tool that made the file broke the format's rules: bake it again with kelp-bake";
    case ErrorCode::kLimit: return "a pack this large is not opened; bake it with a lower resolution";
    case ErrorCode::kUnsupportedVersion:
    case ErrorCode::kUnsupportedFeature: return "use a newer version of kelp";
    case ErrorCode::kOutOfMemory: return "close other programs or use a machine with more memory";
    case ErrorCode::kMisuse:
    case ErrorCode::kGraphics: return "please report this as a fault of kelp-dump";
  }
  return "";
}

}  // namespace kelp::dump
