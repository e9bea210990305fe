// SPDX-License-Identifier: MIT
// In place of write_slice.cpp and extract_slices.cpp where libpng is not installed.
#include "extract/extract.h"
#include "kelp/common/error.h"
#include "slice/write_slice.h"

namespace kelp::dump {

void checkSlices() {
  throw ToolError(Exit::kUnsupported,
                  "slice: this kelp-dump was built without libpng; build it where libpng is installed");
}

void writeSlice(PackFile&, std::uint32_t, const SliceOptions&, const std::string&) { checkSlices(); }

constinit const Writer kSlicesWriter{.needs = "libpng"};

}  // namespace kelp::dump
