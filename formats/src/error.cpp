// SPDX-License-Identifier: MIT
#include "kelp/formats/error.h"

namespace kelp {

const char* toString(ErrorCode code) {
  switch (code) {
    case ErrorCode::kMisuse:
      return "misuse";
    case ErrorCode::kIo:
      return "input/output error";
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
    case ErrorCode::kGraphics:
      return "graphics error";
  }
  return "unknown error";
}

}  // namespace kelp
