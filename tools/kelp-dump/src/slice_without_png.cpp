// SPDX-License-Identifier: MIT
#include "commands.h"

namespace kelp::dump {

int slice(const std::string&, const SliceOptions&, const std::string&) {
  throw DumpError(kUnsupported, "slice: this kelp-dump was built without libpng; build it where libpng is installed");
}

}  // namespace kelp::dump
