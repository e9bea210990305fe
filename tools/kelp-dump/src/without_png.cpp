// SPDX-License-Identifier: MIT
// In place of slice.cpp and extract_slices.cpp where libpng is absent.
#include "commands.h"
#include "extract.h"

namespace kelp::dump {

int slice(const std::string&, const SliceOptions&, const std::string&) {
  throw DumpError(kUnsupported, "slice: this kelp-dump was built without libpng; build it where libpng is installed");
}

constinit const Writer kSlicesWriter{.name = "slices", .needs = "libpng"};

}  // namespace kelp::dump
