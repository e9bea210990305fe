// SPDX-License-Identifier: MIT
// A pack on disk. Errors name the file and say what to do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "kelp/common/error.h"
#include "kelp/formats/pack.h"

namespace kelp::dump {

class PackFile {
 public:
  // Opens the file. ToolError kIo.
  explicit PackFile(const std::string& path);
  PackFile(const PackFile&) = delete;
  PackFile& operator=(const PackFile&) = delete;

  const std::string& path() const { return path_; }
  Source source() { return file_.source(); }
  // Opens the pack on first use. ToolError if the file is no pack or is damaged.
  const Pack& pack();
  // As pack(), but null if it does not open.
  const Pack* packIfSound();

  // The part with this name, or else with this index. If there is none, ToolError kUsage that lists the
  // parts.
  std::uint32_t findPart(const std::string& wanted);
  // As findPart. If `wanted` is empty: the first part that has voxels, with a note on stderr if there are
  // others.
  std::uint32_t partOrFirst(const std::string& wanted);
  // As partOrFirst. ToolError kUsage for an empty part.
  std::uint32_t findVoxels(const std::string& wanted);

  // "0 'reed', 1 'leaf', ...".
  std::string partList();

  // Throws kelp::failPack with this file's path. `where` may name a part and level.
  [[noreturn]] void fail(const Error& error, const std::string& where = "") const;

 private:
  std::string path_;
  FileSource file_;
  std::optional<Pack> pack_;
};

}  // namespace kelp::dump
