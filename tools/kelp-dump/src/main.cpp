// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The one place where errors become exit codes.
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "kelp/console/console.h"
#include "options.h"
#include "system.h"
#include "text.h"

namespace {

int complain(int exit, const std::string& text) {
  kelp::dump::say("{}", text);
  return exit;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace kelp::dump;
  kelp::console::prepareStreams();
  catchInterrupts();
  try {
    return runCommandLine(kelp::console::arguments(argc, argv));
  } catch (const DumpError& error) {
    return complain(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return complain(kFailure, "out of memory; close other programs or use a machine with more memory");
  } catch (const std::exception& error) {
    return complain(kFailure, std::string("unexpected failure (") + error.what() + "); please report this as a fault of kelp-dump");
  }
}
