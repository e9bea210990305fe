// SPDX-License-Identifier: MIT
// Errors of kelp::formats and kelp::runtime as a tool's errors. In kelp::common_pack.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "kelp/common/error.h"
#include "kelp/formats/error.h"

namespace kelp {

// The exit code for an error of a pack.
Exit exitOf(ErrorCode code);
// The remedy: a few words without a full stop. Static storage.
const char* remedyOf(ErrorCode code);

// Throws a ToolError for an error of the pack `path`: "reed.kelp: part 0 'reed': byte 4096: checksum
// mismatch; copy or bake it again". `place` may name a part and level.
[[noreturn]] void failPack(const std::string& path, const Error& error, const std::string& place = "");

// The value of a result, or failPack.
template <class T>
T checkPack(const std::string& path, Result<T> result, const std::string& place = "") {
  if (!result) failPack(path, result.error(), place);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace kelp
