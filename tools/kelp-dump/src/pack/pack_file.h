// SPDX-License-Identifier: MIT
// A pack on disk or from a pipe. Errors name the file and say what to do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "kelp/common/error.h"
#include "kelp/formats/pack.h"
#include "pack/piped_source.h"

namespace kelp::dump {

class PackFile {
 public:
  // Opens the file. "-" (standard input) and pipes are read to their end. ToolError kIo.
  explicit PackFile(const std::string& path);
  PackFile(const PackFile&) = delete;
  PackFile& operator=(const PackFile&) = delete;

  // As given; "standard input" for "-".
  const std::string& path() const { return path_; }
  Source source() { return piped_ ? piped_->source() : file_.source(); }
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
  // Closes the file. Nothing can be read any more.
  void close() {
    pack_.reset();
    file_ = FileSource();
  }

  // "0 'reed', 1 'leaf', ...".
  std::string partList();

  // Throws kelp::failPack with this file's path. `where` may name a part and level.
  [[noreturn]] void fail(const Error& error, const std::string& where = "") const;

 private:
  std::string path_;
  FileSource file_;
  std::optional<PipedSource> piped_;
  std::optional<Pack> pack_;
};

}  // namespace kelp::dump
