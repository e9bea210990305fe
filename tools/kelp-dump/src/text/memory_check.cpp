// SPDX-License-Identifier: MIT
#include "text/memory_check.h"

#include <fmt/format.h>

#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "text/text.h"

namespace kelp::dump {

void requireMemory(std::uint64_t needed, const std::string& what, const std::string& remedy) {
  const std::uint64_t memory = physicalMemory();
  if (needed > memory)
    throw ToolError(Exit::kRuntime, fmt::format("{} needs {} of memory, this machine has {}; {}", what,
                                                bytesText(needed), bytesText(memory), remedy));
}

}  // namespace kelp::dump
