// SPDX-License-Identifier: MIT
#include "kelp/common/pack_error.h"

namespace kelp {

Exit exitOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo:
    case ErrorCode::kNotYet:
      return Exit::kIo;
    case ErrorCode::kNotAPack:
    case ErrorCode::kTruncated:
    case ErrorCode::kChecksum:
    case ErrorCode::kCorrupt:
    case ErrorCode::kLimit:
    case ErrorCode::kNotMonotone:
    case ErrorCode::kFolds:
      return Exit::kInvalid;
    case ErrorCode::kUnsupportedVersion:
    case ErrorCode::kUnsupportedFeature:
      return Exit::kUnsupported;
    case ErrorCode::kMisuse:
    case ErrorCode::kOutOfMemory:
    case ErrorCode::kGraphics:
      return Exit::kRuntime;
  }
  return Exit::kRuntime;
}

const char* remedyOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kIo:
    case ErrorCode::kNotYet:
      return "check the disk and the file's permissions";
    case ErrorCode::kNotAPack:
      return "packs are made by kelp-bake: check that this is the right file";
    case ErrorCode::kTruncated:
      return "the file is not complete: copy or bake it again";
    case ErrorCode::kChecksum:
      return "the file was damaged after it was made: copy or bake it again";
    case ErrorCode::kCorrupt:
    case ErrorCode::kNotMonotone:
    case ErrorCode::kFolds:
      return "the tool that made the file broke the format's rules: bake it again with kelp-bake";
    case ErrorCode::kLimit:
      return "a pack this large is not opened: bake it with a lower resolution";
    case ErrorCode::kUnsupportedVersion:
      return "bake it again, or use the version of kelp that made it";
    case ErrorCode::kUnsupportedFeature:
      return "use a newer version of kelp";
    case ErrorCode::kOutOfMemory:
      return "close other programs, use a machine with more memory, or bake with a lower resolution";
    case ErrorCode::kMisuse:
    case ErrorCode::kGraphics:
      return "please report this as a fault of kelp";
  }
  return "";
}

void failPack(const std::string& path, const Error& error, const std::string& place) {
  std::string message = path + ": ";
  if (!place.empty()) message += place + ": ";
  if (error.offset != Error::kNoOffset)
    message += std::string(toString(error.unit)) + " " + std::to_string(error.offset) + ": ";
  message += toString(error.code);
  if (*error.detail) message += std::string(" (") + error.detail + ")";
  throw ToolError(exitOf(error.code), message + "; " + remedyOf(error.code));
}

}  // namespace kelp
