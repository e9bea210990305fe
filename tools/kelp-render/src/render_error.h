// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

#include "kelp/formats/error.h"

namespace kelp::render {

enum Exit : int { kOk = 0, kUsage = 1, kIo = 2, kInvalid = 3, kFailure = 4, kUnsupported = 5 };

// what() is the line for stderr, without the program's name: file, place, reason; remedy.
struct RenderError : std::runtime_error {
  RenderError(Exit code, const std::string& message) : std::runtime_error(message), exit(code) {}
  Exit exit;
};

// For an error of formats or runtime that concerns the pack `path`.
[[noreturn]] void failPack(const std::string& path, const Error& error);

template <class T>
T checkPack(const std::string& path, Result<T> result) {
  if (!result) failPack(path, result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace kelp::render
