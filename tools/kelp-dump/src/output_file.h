// SPDX-License-Identifier: MIT
// Output that is either the old file or the new one, whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "system.h"

namespace kelp::dump {

// To be asked before the work. DumpError (kUsage) if writing `output` would replace `input`, which is read, by whatever names; or if it is "-" and standard output a
// terminal, which can not show `what` ("a PNG").
void checkOutput(const std::string& output, const std::string& input, const char* what);

// A new file in the folder of its final place, removed unless it is committed. DumpError (kIo) from everything that fails.
class OutputFile {
 public:
  // "-" is standard output, which is written as it comes.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  // Numbers as they are in memory: little-endian, as the formats written here.
  template <class T>
    requires std::is_arithmetic_v<T>
  void number(T value) {
    write(std::as_bytes(std::span(&value, 1)));
  }

  // For a library that writes to a stream and goes back in it: nothing else may be written then, and "-" is no such file.
  void writeBy(const std::function<void(std::ostream&)>& write);
  // Onto the disk, then into place.
  void commit();

 private:
  void check(const char* what, const std::string& problem) const;
  void flush();

  std::string path_;
  NewFile file_;
  std::vector<std::byte> buffer_;
};

}  // namespace kelp::dump
