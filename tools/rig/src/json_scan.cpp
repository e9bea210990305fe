// SPDX-License-Identifier: MIT
#include "json_scan.h"

#include <algorithm>
#include <string>

#include "kelp/common/json_depth.h"
#include "kelp/rig/rig.h"

namespace kelp::rig {

void checkJsonBounds(std::string_view text) {
  if (text.size() > kMaxTextBytes)
    throw RigError("a rig may have at most " + std::to_string(kMaxTextBytes >> 20) +
                   " MiB of text, this has " + std::to_string(text.size()) + " bytes: is it the right file?");
  if (const auto deep = nestedDeeper(text, kMaxDepth)) {
    const LineColumn at = lineColumn(text, *deep);
    throw RigError("line " + std::to_string(at.line) + ", column " + std::to_string(at.column) +
                   ": nested more than " + std::to_string(kMaxDepth) +
                   " levels deep, which no rig is; is it the right file?");
  }
}

LineColumn lineColumn(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t last_break = before.rfind('\n');
  return {1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
          1 + before.size() - (last_break == std::string_view::npos ? 0 : last_break + 1)};
}

}  // namespace kelp::rig
