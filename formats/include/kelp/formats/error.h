// SPDX-License-Identifier: MIT
// How formats and runtime report errors: a numbered code, the byte of the pack concerned, and a word. No exceptions, no allocation.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace kelp {

enum class ErrorCode : std::uint16_t {
  kMisuse = 1,          // the caller broke the contract of the function (bad index, null callback, object of another context)
  kIo,                  // the source could not read, or the sink could not write
  kNotAPack,            // the file does not begin with the identifier of a .kelp pack
  kUnsupportedVersion,  // written by a newer major version of the format
  kUnsupportedFeature,  // a required chunk or flag this version does not know
  kTruncated,           // the file ends before its header says it does
  kChecksum,            // bytes differ from their checksum
  kCorrupt,             // structure contradicts itself although the checksums hold
  kLimit,               // sound perhaps, but larger than the Limits given
  kOutOfMemory,         // an allocation failed
  kNotMonotone,         // a spline turns back along its axis (section 3.1 of the paper demands monotone splines)
  kGraphics,            // OpenGL refused: missing function, shader that does not compile, texture too large
};

// A short English word for the code, such as "checksum mismatch". Static storage.
const char* toString(ErrorCode code);

struct Error {
  static constexpr std::uint64_t kNoOffset = ~std::uint64_t{0};

  ErrorCode code = ErrorCode::kMisuse;
  const char* detail = "";          // static string: what is wrong, in a few words
  std::uint64_t offset = kNoOffset;  // byte in the pack, where that makes sense
};

// A value or an Error. Test it before use: reading the wrong one is the caller's mistake (asserted).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Error error) : error_(error) {}

  explicit operator bool() const { return value_.has_value(); }
  T& operator*() & { return *value_; }
  const T& operator*() const& { return *value_; }
  T&& operator*() && { return *std::move(value_); }
  T* operator->() { return &*value_; }
  const T* operator->() const { return &*value_; }
  const Error& error() const { return error_; }

 private:
  std::optional<T> value_;
  Error error_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : failed_(true), error_(error) {}

  explicit operator bool() const { return !failed_; }
  const Error& error() const { return error_; }

 private:
  bool failed_ = false;
  Error error_;
};

}  // namespace kelp
