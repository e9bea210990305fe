// SPDX-License-Identifier: MIT
// How formats and runtime report errors: a numbered code, a place, and a short text. No exceptions, no
// allocation.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace kelp {

enum class ErrorCode : std::uint16_t {
  // The caller broke the function's contract: a bad index, a null callback, an object of another context.
  // Every build checks this and returns it; nothing is asserted.
  kMisuse = 1,
  kIo,                  // the source failed to read, or the sink failed to write
  kNotAPack,            // the file does not start with the identifier of a .kelp pack
  kUnsupportedVersion,  // of another major version of the format
  kUnsupportedFeature,  // a required chunk, a flag or a kind of part that this version does not know
  kTruncated,           // the file is shorter than its header says
  kChecksum,            // bytes differ from their checksum
  kCorrupt,             // the content breaks a rule of SPEC.md although the checksums match
  kLimit,               // larger than the given limits or memory budget allow
  kOutOfMemory,         // an allocation failed
  // A spline turns back along its axis. Section 3.1 of the paper needs monotone splines.
  kNotMonotone,
  kFolds,     // a swept part bends too sharply for its thickness (kelp/formats/sweep.h)
  kGraphics,  // OpenGL failed: a missing function, a shader that does not compile, a texture too large
  kNotYet,    // the source has not got the bytes yet: nothing is wrong, call again later
};

// The code in a few English words, such as "checksum mismatch". Static storage.
const char* toString(ErrorCode code);

struct Error {
  // The unit of `offset`.
  enum class Unit : std::uint8_t {
    kByte,      // of the pack
    kPart,      // index of a part
    kKnot,      // index of a knot in its part
    kInstance,  // index of an instance in the list that was given
    kNode,      // index of a node in the finest cage of its part
    kJoint,     // index of a joint
  };
  static constexpr std::uint64_t kNoOffset = ~std::uint64_t{0};

  ErrorCode code = ErrorCode::kMisuse;
  // The fault in a few words. Static storage, except where a function says that its asset or the
  // thread owns it.
  const char* detail = "";
  std::uint64_t offset = kNoOffset;  // where, if there is a place
  Unit unit = Unit::kByte;
};
const char* toString(Error::Unit unit);  // "byte", "part", "knot", "instance", "node", "joint"

// Writes the error to the standard error output and ends the program (std::abort).
[[noreturn]] void stop(const Error& error);

// A value or an Error. Test it before use: only read the value if the test is true, else only the error. Or
// call value(), if the program cannot go on without it.
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
  // The value; an error ends the program: stop().
  T& value() & {
    if (!value_) stop(error_);
    return *value_;
  }
  const T& value() const& { return const_cast<Result*>(this)->value(); }
  T&& value() && { return std::move(value()); }

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
  // An error ends the program: stop().
  void value() const {
    if (failed_) stop(error_);
  }

 private:
  bool failed_ = false;
  Error error_;
};

}  // namespace kelp
