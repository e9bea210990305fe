// SPDX-License-Identifier: MIT
#include "kelp/formats/error.h"

#include <cstdio>
#include <cstdlib>

namespace kelp {

const char* toString(ErrorCode code) {
  switch (code) {
    case ErrorCode::kMisuse:
      return "misuse";
    case ErrorCode::kIo:
      return "input/output error";
    case ErrorCode::kNotYet:
      return "not there yet";
    case ErrorCode::kNotAPack:
      return "not a .kelp pack";
    case ErrorCode::kUnsupportedVersion:
      return "unsupported version";
    case ErrorCode::kUnsupportedFeature:
      return "unsupported feature";
    case ErrorCode::kTruncated:
      return "truncated file";
    case ErrorCode::kChecksum:
      return "checksum mismatch";
    case ErrorCode::kCorrupt:
      return "corrupt structure";
    case ErrorCode::kLimit:
      return "limit exceeded";
    case ErrorCode::kOutOfMemory:
      return "out of memory";
    case ErrorCode::kNotMonotone:
      return "spline not monotone";
    case ErrorCode::kFolds:
      return "the part folds";
    case ErrorCode::kGraphics:
      return "graphics error";
  }
  return "unknown error";
}

const char* toString(Error::Unit unit) {
  switch (unit) {
    case Error::Unit::kByte:
      return "byte";
    case Error::Unit::kPart:
      return "part";
    case Error::Unit::kKnot:
      return "knot";
    case Error::Unit::kInstance:
      return "instance";
    case Error::Unit::kNode:
      return "node";
    case Error::Unit::kJoint:
      return "joint";
  }
  return "place";
}

void stop(const Error& error) {
  std::fprintf(stderr, "kelp: %s: %s", toString(error.code), error.detail);
  if (error.offset != Error::kNoOffset)
    std::fprintf(stderr, " (%s %llu)", toString(error.unit), static_cast<unsigned long long>(error.offset));
  std::fputc('\n', stderr);
  std::abort();
}

}  // namespace kelp
