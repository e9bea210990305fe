// SPDX-License-Identifier: MIT
// A pack on disk or from a pipe, opened with errors a person can act on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "commands.h"
#include "kelp/formats/pack.h"
#include "piped_source.h"

namespace kelp::dump {

class PackFile {
 public:
  // Opens the file only; of "-", and of a pipe, reads to its end. DumpError (kIo) if it can not be read.
  explicit PackFile(const std::string& path);
  PackFile(const PackFile&) = delete;
  PackFile& operator=(const PackFile&) = delete;

  // As given; "standard input" for "-".
  const std::string& path() const { return path_; }
  Source source() { return piped_ ? piped_->source() : file_.source(); }
  // Opens the pack on first use. DumpError if it is none, or unsound.
  const Pack& pack();
  // The same, or null if it does not open.
  const Pack* packIfSound();

  // The part of this name, or else of this index. DumpError (kUsage) that lists the parts if there is none.
  std::uint32_t findPart(const std::string& wanted);
  // Nothing of the pack can be read any more.
  void close() { file_ = FileSource(); }

  // "0 'reed', 1 'leaf', ...".
  std::string partList();

  // What is wrong, where, and what to do: "reed.kelp: byte 4096: checksum mismatch: ...; ...". `where` may name a part and level.
  [[noreturn]] void fail(const Error& error, const std::string& where = "") const;

 private:
  std::string path_;
  FileSource file_;
  std::optional<PipedSource> piped_;
  std::optional<Pack> pack_;
};

// The exit code for an error of formats.
Exit exitCode(ErrorCode code);
// What to do about it, in a few words.
const char* remedy(ErrorCode code);

}  // namespace kelp::dump
