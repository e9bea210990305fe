// SPDX-License-Identifier: MIT
#include "errors.h"

#include <algorithm>
#include <cstring>

#include "structs.h"

namespace kelp::c {
namespace {

static_assert(KELP_ERROR_MISUSE == static_cast<int>(ErrorCode::kMisuse) &&
              KELP_ERROR_NOT_YET == static_cast<int>(ErrorCode::kNotYet));
static_assert(KELP_UNIT_NODE == static_cast<int>(Error::Unit::kNode));
static_assert(KELP_UNIT_JOINT == static_cast<int>(Error::Unit::kJoint));

thread_local kelp_error last_error = {sizeof(kelp_error), KELP_OK, 0, KELP_UNIT_NONE, ""};

// The start of the text, without half of a character at its end.
void copyText(const char* text, std::span<char> out) {
  std::size_t size = std::strlen(text);
  if (size >= out.size()) {
    size = out.size() - 1;
    while (size > 0 && (text[size] & 0xc0) == 0x80) --size;
  }
  std::copy_n(text, size, out.begin());
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(size), out.end(), '\0');
}

}  // namespace

kelp_result fail(kelp_result result, const char* text, std::uint64_t offset, kelp_unit unit) {
  last_error.result = result;
  last_error.offset = offset;
  last_error.unit = unit;
  copyText(text, last_error.text);
  return result;
}

kelp_result fail(const Error& error) {
  const bool placed = error.offset != Error::kNoOffset;
  return fail(static_cast<kelp_result>(error.code), error.detail, placed ? error.offset : 0,
              static_cast<kelp_unit>(placed ? static_cast<int>(error.unit) : KELP_UNIT_NONE));
}

}  // namespace kelp::c

using namespace kelp::c;

uint32_t kelp_version(void) { return KELP_VERSION_NUMBER; }

const char* kelp_result_text(kelp_result result) {
  switch (result) {
    case KELP_OK:
      return "no error";
    case KELP_ERROR_HANDLE:
      return "not a valid handle";
    case KELP_ERROR_NULL:
      return "null pointer";
    case KELP_ERROR_STRUCT_SIZE:
      return "wrong struct_size";
    case KELP_ERROR_WRONG_THREAD:
      return "wrong thread";
    case KELP_ERROR_BUSY:
      return "object in use";
    default:
      return result >= KELP_ERROR_MISUSE && result <= KELP_ERROR_NOT_YET
                 ? kelp::toString(static_cast<kelp::ErrorCode>(result))
                 : "unknown result";
  }
}

kelp_result kelp_last_error(kelp_error* error) {
  const kelp_error last = last_error;  // a refused struct_size replaces it
  if (const kelp_result bad = checkStruct(error)) return bad;
  return writeStruct(last, error);
}
