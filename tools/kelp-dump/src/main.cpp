// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The one place where errors become exit codes.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "kelp/console/console.h"
#include "options.h"
#include "system.h"

namespace {

// One line whatever the text holds: it may quote names of files.
int complain(int exit, std::string text) {
  std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  std::fprintf(stderr, "kelp-dump: %s\n", text.c_str());
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
