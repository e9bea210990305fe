// SPDX-License-Identifier: MIT
#include "text/checks.h"

#include <filesystem>

#include <fmt/format.h>

#include "kelp/common/console.h"
#include "kelp/common/error.h"
#include "kelp/common/memory.h"
#include "kelp/common/output_file.h"
#include "text/text.h"

namespace kelp::dump {

void checkBinaryOutput(const std::string& output, const std::string& input, const char* what) {
  if (output == "-") {
    if (!console::printsToTerminal()) return;
    throw ToolError(
        Exit::kUsage,
        fmt::format("-: a terminal cannot show {}; redirect it (> FILE, or | PROGRAM), or name a file",
                    what));
  }
  const std::filesystem::path path = console::pathOf(output);
  if (streamOf(path))
    throw ToolError(Exit::kIo,
                    fmt::format("{}: is an open stream; give - for standard output, or name a file", output));
  checkNotOverwritten(path, console::pathOf(input));
}

void requireMemory(std::uint64_t needed, const std::string& what, const std::string& remedy) {
  const std::uint64_t memory = physicalMemory();
  if (needed > memory)
    throw ToolError(Exit::kRuntime, fmt::format("{} needs {} of memory, this machine has {}; {}", what,
                                                bytesText(needed), bytesText(memory), remedy));
}

}  // namespace kelp::dump
