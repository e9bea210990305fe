// SPDX-License-Identifier: MIT
#include "pack/pack_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/pack_error.h"
#include "text/text.h"

namespace kelp::dump {

PackFile::PackFile(const std::string& path) : path_(path) {
  if (path == "-" || console::isPipe(path))
    throw ToolError(Exit::kUsage,
                    path + ": a pack is not read from a pipe; write it to a file and name that");
  errno = 0;
  Result<FileSource> opened = FileSource::open(path.c_str());
  if (!opened) {
    const int reason = errno;
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(console::pathOf(path), ignored);
    if (std::filesystem::is_directory(status))
      throw ToolError(Exit::kIo, fmt::format("{}: is a folder; name a .kelp file", path));
    if (std::filesystem::is_other(status))
      throw ToolError(Exit::kIo, fmt::format("{}: is a device, not a file; name a .kelp file", path));
    throw ToolError(Exit::kIo, fmt::format("{}: cannot be opened: {}; check the path and its permissions",
                                           path, reason ? std::strerror(reason) : opened.error().detail));
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
  for (std::size_t i = 0; i < parts.size() && i < 12; ++i)
    names += fmt::format("{}{} '{}'", i ? ", " : "", i, nameText(parts[i].name, 40));
  return names + (parts.size() > 12 ? ", ..." : "");
}

std::uint32_t PackFile::findPart(const std::string& wanted) {
  const std::span<const Part> parts = pack().parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == wanted) return static_cast<std::uint32_t>(i);
  std::uint32_t index = 0;
  const auto [end, problem] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (problem == std::errc() && end == wanted.data() + wanted.size() && index < parts.size()) return index;
  throw ToolError(Exit::kUsage, fmt::format("{}: there is no part '{}'; parts are {}; choose one of them",
                                            path_, nameText(wanted), partList()));
}

std::uint32_t PackFile::partOrFirst(const std::string& wanted) {
  if (!wanted.empty()) return findPart(wanted);
  const std::span<const Part> parts = pack().parts();
  std::uint32_t first = 0;  // that has voxels; one has
  while (parts[first].kind == PartKind::kEmpty) ++first;
  if (parts.size() > 1)
    say("{}: has {} parts, this is part {} '{}'; choose another with --part", path_, parts.size(), first,
        nameText(parts[first].name));
  return first;
}

std::uint32_t PackFile::findVoxels(const std::string& wanted) {
  const std::uint32_t part = partOrFirst(wanted);
  if (pack().parts()[part].kind == PartKind::kEmpty)
    throw ToolError(Exit::kUsage, fmt::format("{}: part {} '{}' is empty; choose one that has voxels", path_,
                                              part, nameText(pack().parts()[part].name)));
  return part;
}

void PackFile::fail(const Error& error, const std::string& where) const { failPack(path_, error, where); }

}  // namespace kelp::dump
