// SPDX-License-Identifier: MIT
// The last error of each thread, and C++ results as C results.
#pragma once

#include "kelp/c/base.h"
#include "kelp/formats/error.h"

namespace kelp::c {

// Keep the error for kelp_last_error, and return its code.
kelp_result fail(kelp_result result, const char* text, std::uint64_t offset = 0,
                 kelp_unit unit = KELP_UNIT_NONE);
kelp_result fail(const Error& error);

inline kelp_result misuse(const char* text) { return fail(KELP_ERROR_MISUSE, text); }
inline kelp_result nullPointer() { return fail(KELP_ERROR_NULL, "a pointer is null that may not be"); }
inline kelp_result noMemory() { return fail(KELP_ERROR_OUT_OF_MEMORY, "no memory for the object"); }

// From the result of a C++ function to that of C. `out` gets the value.
inline kelp_result answer(const Result<void>& result) { return result ? KELP_OK : fail(result.error()); }
template <class T, class Out>
kelp_result answer(const Result<T>& result, Out* out) {
  if (!result) return fail(result.error());
  *out = static_cast<Out>(*result);
  return KELP_OK;
}

}  // namespace kelp::c
