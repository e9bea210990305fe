// SPDX-License-Identifier: MIT
// In place of the sources that need libraries that are not installed.
#include "extract/extract.h"
#include "kelp/common/error.h"
#include "slice/write_slice.h"

namespace kelp::dump {

#ifndef KELP_DUMP_PNG
void checkSlices() {
  throw ToolError(Exit::kUnsupported,
                  "slice: this kelp-dump was built without libpng; build it where libpng is installed");
}

void writeSlice(PackFile&, std::uint32_t, const SliceOptions&, const std::string&) { checkSlices(); }
#endif

#ifndef KELP_DUMP_OPENMESH
constinit const Writer kProxyWriter{.needs = "OpenMesh"};
#endif

}  // namespace kelp::dump
