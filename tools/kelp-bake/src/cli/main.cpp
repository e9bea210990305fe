// SPDX-License-Identifier: MIT
// kelp-bake: a thin main over kelp::bake. Every exception ends here, as a line and an exit code.
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "cli/bake_one.h"
#include "cli/messages.h"
#include "kelp/common/console.h"

namespace {

using namespace kelp::bake_cli;
using kelp::Exit;

// Before parsing, so that usage errors are JSON too.
bool asksForJson(const std::vector<std::string>& words) {
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i] == "--progress=json" || (words[i] == "json" && words[i - 1] == "--progress")) return true;
  return false;
}

Exit run(const std::vector<std::string>& words) {
  try {
    if (asksForJson(words)) speakJson();
    if (const std::optional<Options> options = parseCommandLine(words)) bakeOne(*options);
    return Exit::kOk;
  } catch (const kelp::ToolError& error) {
    sayError(error.exit, error.what());
    return error.exit;
  } catch (const std::bad_alloc&) {
    sayError(Exit::kRuntime, "out of memory; lower --resolution");
  } catch (const std::exception& error) {
    sayError(Exit::kRuntime, std::string("unexpected: ") + error.what() + "; please report this as a defect");
  }
  return Exit::kRuntime;
}

}  // namespace

int main(int argc, char** argv) {
  kelp::console::prepareStreams();
  return static_cast<int>(run(kelp::console::arguments(argc, argv)));
}
