// SPDX-License-Identifier: MIT
#pragma once

namespace kelp::bake_cli {

// From now on Ctrl-C, SIGTERM and SIGHUP ask for an orderly end, unless whoever started the program had them
// ignored; a second one ends the program at once. Writing to what no longer takes it is an error, not a
// signal.
void catchInterrupts();
bool interrupted();
// For a child process: the parent alone hears those signals, and tells by SIGUSR1.
void hearParentOnly();

}  // namespace kelp::bake_cli
