// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The one place where errors become exit codes.
#include <exception>
#include <new>
#include <string>

#include "commands/commands.h"
#include "kelp/common/console.h"
#include "kelp/common/output_file.h"
#include "text/text.h"

namespace {

int complain(kelp::Exit exit, const std::string& text) {
  kelp::dump::say("{}", text);
  return static_cast<int>(exit);
}

}  // namespace

int main(int argc, char** argv) {
  using kelp::Exit;
  kelp::console::prepareStreams();
  kelp::endOnInterrupt("kelp-dump");
  try {
    return static_cast<int>(kelp::dump::runCommandLine(kelp::console::arguments(argc, argv)));
  } catch (const kelp::ToolError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(Exit::kRuntime, "out of memory; close other programs or use a machine with more memory");
  } catch (const std::exception& error) {
    return complain(Exit::kRuntime, std::string("unexpected failure (") + error.what() +
                                        "); please report this as a fault of kelp-dump");
  }
}
