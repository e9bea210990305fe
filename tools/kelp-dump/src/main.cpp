// SPDX-License-Identifier: MIT
// kelp-dump: what is in a pack, and whether it is sound. The one place where errors become exit codes.
#include <cstdio>
#include <exception>
#include <new>

#include "commands.h"
#include "kelp/console/console.h"
#include "options.h"
#include "system.h"

int main(int argc, char** argv) {
  using namespace kelp::dump;
  kelp::console::prepareStreams();
  catchInterrupts();
  try {
    return runCommandLine(kelp::console::arguments(argc, argv));
  } catch (const DumpError& error) {
    std::fprintf(stderr, "kelp-dump: %s\n", error.what());
    return error.exit;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "kelp-dump: out of memory; close other programs or use a machine with more memory\n");
    return kFailure;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kelp-dump: unexpected failure (%s); please report this as a fault of kelp-dump\n", error.what());
    return kFailure;
  }
}
